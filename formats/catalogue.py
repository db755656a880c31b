"""What every format can do, as a table: for `convert --list-formats` and for ``docs/formats.md``."""

from __future__ import annotations

from meshonet.formats.format import Format
from meshonet.formats.registry import formats

_PAGE = """# Formats

<!-- made by python docs/make_pages.py; a test keeps it current -->

`meshonet convert IN OUT` goes by the endings; `--from` and `--to` name a format where endings do not tell.
*Names*: patches of the boundary keep their names. *3D*: `--extrude H` (`--planes K`) repeats it in z.
*Many*: one file holds several. *Options* stand behind a colon, `--to gmsh:4.1,ascii`, one of each group; the
first of a group is the default, or what the ending says.

"""
_REST = """
**Boundaries out of meshes and drawings** (Gmsh, SU2, DXF): their lines are joined to closed curves. One
curve is a domain (its corners are those of the quadrilaterals, or the four places where names change) or a
body; two, one in the other, are a body in its far field; several beside each other are a shape each. Names
of physical groups, markers and layers become names of patches. A mesh of quadrilaterals that is structured
gives back its nodes bit for bit. Meshes of three dimensions are refused. DXF needs `pip install
'meshonet[dxf]'`. Of WKT and GeoJSON, a polygon with one hole is a body in its far field.

**Plot3D** is told apart by its length and its cells: count or none, two or three dimensions, iblank,
records, byte order, float32 or float64, planes along any index, `r*v`, commas and D exponents. Where two
readings fit, the one whose cells all turn one way counts; options (`--from plot3d:fortran,big`, `--plot3d
fortran,big`) say it, and choose what is written. `single` has no count of blocks, `planes` the coordinates of
one k after the other, `span-i` the planes of a grid repeated in z along its first index. iblank is told of
and not kept.

**Planes**: a file of three dimensions is read when it is one plane, or copies of one along any index; a
truly three-dimensional one is refused with its dims.

**Not read**: CGNS in ADF containers (`adf2hdf` turns them into HDF5), `.vts` compressed with LZ4 (write it
with zlib; LZMA is read), Gmsh meshes other than 2.2 and 4.1, binary DXF.

Worked cases of flow solvers: `examples/naca0012-openfoam`, `examples/naca0012-su2`.
"""
_HEAD = ("format", "endings", "reads", "writes", "names", "3D", "many", "what it is", "options")


def rows() -> list[dict[str, str]]:
    """Return a row for each format, by the table's headings."""
    return [dict(zip(_HEAD, _row(found), strict=True)) for found in formats()]


def markdown() -> str:
    """Return the table in Markdown."""
    lines = [_HEAD, ("---",) * len(_HEAD), *(_row(found) for found in formats())]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def plain() -> str:
    """Return the table in columns, for a terminal."""
    lines = [_HEAD, *(_row(found) for found in formats())]
    widths = [max(len(line[k]) for line in lines) for k in range(len(_HEAD))]
    return "\n".join(
        "  ".join(f"{word:<{n}}" for word, n in zip(line, widths, strict=True)).rstrip() for line in lines
    )


def page() -> str:
    """Return ``docs/formats.md``."""
    return f"{_PAGE}{markdown()}\n{_REST}"


def _row(found: Format) -> tuple[str, ...]:
    return (
        found.name,
        " ".join(found.suffixes),
        _what(found.read_grids is not None, found.read_shapes is not None),
        _what(found.write_grids is not None, found.write_boundaries is not None),
        "yes" if found.names_patches else "",
        "yes" if found.write_extruded is not None else "",
        "yes" if found.many else "",
        found.description,
        " ".join("/".join(row) for row in found.choices),
    )


def _what(grids: bool, boundaries: bool) -> str:
    return ", ".join(word for word, can in (("grids", grids), ("boundaries", boundaries)) if can)
