"""What every format can do, as a table: for `convert --list-formats` and for ``docs/formats.md``."""

from __future__ import annotations

from meshonet.formats.format import Format
from meshonet.formats.registry import formats

_PAGE = """# Formats

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the files that meshonet reads and writes. `meshonet convert IN OUT` chooses by the endings;
`--from` and `--to` name a format where the ending is ambiguous. `meshonet convert --list-formats` prints this
table.

*names*: names of patches are kept. *3D*: `--extrude H` (`--planes K`) repeats the grid in z. *many*: one file
can hold several grids or boundaries. *options* are written behind a colon, for example `--to gmsh:4.1,ascii`,
one of each group. The first of a group is the default unless the ending says otherwise.

"""
_REST = """
## Boundaries from meshes and drawings

Lines of Gmsh, SU2 and DXF files are joined to closed curves. Names of physical groups, markers and layers
become names of patches.

- One curve is a four-sided domain or a body. The corners of a domain are the corners of its quadrilaterals or
  the four places where names change.
- Two curves, one inside the other, are a body in its far field. So is a WKT or GeoJSON polygon with a hole.
- Curves beside each other are separate shapes.

A structured mesh of quadrilaterals keeps its nodes to the last bit. Three-dimensional meshes are refused. DXF
needs `pip install 'meshonet[dxf]'`.

## Plot3D

Plot3D files do not state their variant. It is found from the length of the file and the orientation of the
cells: count of blocks, dimensions, iblank, records, byte order, precision, the index that runs in z, and text
with repeats, commas or D exponents. `--from plot3d:fortran,big` or `--plot3d fortran,big` overrides this; the
same words choose the variant to write. `single` omits the count of blocks, `planes` writes the coordinates of
one k after the other, and `span-i` repeats the grid in z along its first index. iblank is reported but not
kept.

## HDF5

Datasets hold n samples of one size; h5py writes or reads one in ten lines. Layout version 1, of what
has one plane block:

| name | what it is |
| --- | --- |
| attributes | `format` (`meshonet-boundary` or `meshonet-grid`), `version` 1, `topology` (`quad`, `o`, `c`) |
| `south`, `north`, `west`, `east` | (n, ni, 2) and (n, nj, 2), the corners shared |
| `nodes` | (n, ni, nj, 2), of grids |
| `names`, `split`, `provenance` | (n,) texts, where there are any; `provenance` is JSON |
| `parts` | (n,) texts, JSON lists of `[name, side, start, stop]` |
| `parameters`, `sensors` | (n, p) with the attribute `names`; (n, m, 2) |

Version 2, of grids of several blocks or of blocks in space, has `blocks/0`, `blocks/1` ... in place of edges,
`nodes` and `topology`: (n, ni, nj, 2), (n, ni, nj, nk, 3), or (n, ni, nj, 3) on a surface. Rows of `parts` go
on with `block, across, kind`: `across` is the range along the second direction of a side, null for all of it.
The attribute `connections` is a JSON list of what all samples share: `[block, side, range, donor, donor_side,
donor_range, orientation, transform]`. A range has the first and last node along each direction of the side;
`orientation` the donor's direction that runs along each one, counted from 1, negative when reversed;
`transform` is null, or `{"shift": [...], "turn": [[...]]}` between periodic sides.

## Three-dimensional files

A file is read when it is a plane, or identical planes along any index. Other three-dimensional files are
refused.

## Not read

- CGNS in ADF containers: convert it with `adf2hdf`.
- `.vts` compressed with LZ4: write it with zlib or LZMA.
- Gmsh meshes other than 2.2 and 4.1, and binary DXF.

Worked cases of flow solvers: `examples/naca0012-openfoam`, `examples/naca0012-su2`.
"""
_HEAD = ("format", "endings", "reads", "writes", "names", "3D", "many", "what it is", "options")


def rows() -> list[dict[str, str]]:
    """Return a row for each format, by the table's headings."""
    return [dict(zip(_HEAD, _row(record), strict=True)) for record in formats()]


def markdown() -> str:
    """Return the table in Markdown."""
    lines = [_HEAD, ("---",) * len(_HEAD), *(_row(record) for record in formats())]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def plain() -> str:
    """Return the table in columns, for a terminal."""
    lines = [_HEAD, *(_row(record) for record in formats())]
    widths = [max(len(line[k]) for line in lines) for k in range(len(_HEAD))]
    return "\n".join(
        "  ".join(f"{word:<{n}}" for word, n in zip(line, widths, strict=True)).rstrip() for line in lines
    )


def page() -> str:
    """Return ``docs/formats.md``."""
    return f"{_PAGE}{markdown()}\n{_REST}"


def _row(record: Format) -> tuple[str, ...]:
    return (
        record.name,
        " ".join(record.suffixes),
        _what(record.read_grids is not None, record.read_shapes is not None),
        _what(record.write_grids is not None, record.write_boundaries is not None),
        "yes" if record.names_patches else "",
        "yes" if record.write_extruded is not None else "",
        "yes" if record.many else "",
        record.description,
        " ".join("/".join(row) for row in record.choices),
    )


def _what(grids: bool, boundaries: bool) -> str:
    return ", ".join(word for word, can in (("grids", grids), ("boundaries", boundaries)) if can)
