"""Make the generated pages and pictures of docs/: python docs/make_pages.py (make docs).

In reference/: cli.md from the application, formats.md from the registry, models.md from the headers of the
shipped models, families.md and the pictures from the commands a user would type.
"""

from __future__ import annotations

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from PIL import Image

from meshonet.formats.catalogue import markdown
from meshonet.geometry.families.family import FAMILIES, family
from meshonet.solvers.neural.registry import HEADS, described, shipped
from meshonet_cli.reference import reference

DOCS = Path(__file__).parent
REFERENCE = DOCS / "reference"
GRIDS = {"o": "O grids", "quad": "Grids of four-sided domains"}

MODELS_HEAD = """# Shipped models

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the training recipe and the held-out error of a model. When to use which model is said in
[operators](../theory/operators.md). `meshonet models` prints the same data.

Each model is a safetensors file in `solvers/neural/pretrained/` that carries its recipe and its figures.
`make train` trains them again. The losses of every epoch are in `docs/benchmarks/curves`; `quad-first` is the
first of two runs for `quad-general`.
"""
C_GRIDS = """## C grids: no model

No model for C grids is shipped, because none is as good as marching. The network for four-sided domains is
worse there than transfinite interpolation; after five iterations it is still behind the variational grid
([figures](../benchmarks/body-operator.md#c-grids-no-model)). The strip of `airfoil-o` is periodic, which a
wake does not allow. `infer` therefore [marches](../theory/marching.md) C grids from wall and wake and uses
the variational method where marching does not suit. The report says which. `--model`, `--polish` and
`--device` are refused.
"""

FORMATS_HEAD = """# Formats

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the files that meshonet reads and writes. `meshonet convert IN OUT` chooses by the endings;
`--from` and `--to` name a format where the ending is ambiguous. `meshonet convert --list-formats` prints this
table.

*names*: names of patches are kept. *3D*: which grids in space it holds; where these are volumes, `--extrude
H` (`--planes K`) makes them of plane grids. *blocks*: a grid of several blocks is written with its blocks
kept, or merged to one mesh; other formats refuse it. *many*: one file can hold several grids or boundaries.
*options* are written behind a colon, one of each group, for example `--to gmsh:4.1,ascii`. The first of a
group is the default unless the ending says otherwise.

"""
FORMATS_REST = """
## Grids of several blocks

`meshonet convert blocks.cgns mesh.su2` makes one mesh of a file of blocks: nodes on interfaces stand once, no
inner face is left, the names of the outer ones are kept.

Where blocks join stands in CGNS (one-to-one interfaces) and in the `.nmf` beside a Plot3D file. Where a file
does not say, sides and parts of sides whose nodes coincide are joined, to a millionth of a cell or to the
digits that the file has. Sides that are boundaries by name or condition, both sides of a thin plate for
example, are not. Joined nodes are made equal to the last bit. Left-handed blocks get i reversed. Outer edges
without a name are called by the line they are part of: `outer`, `body`, `body2`.

Blocks of one file that touch are one grid, others are grids by themselves; so a file of a batch stays a
batch. Files of this program say which block belongs to which grid. In a `.vtm` a grid of several blocks is a
`Block`, a grid of one block stands by itself.

Periodic sides are joined by a shift or a rotation about z, which is taken from the nodes, since conventions
of files differ. They become periodic interfaces in CGNS, `cyclic` patches in OpenFOAM, `$Periodic` in Gmsh;
of an SU2 mesh the first lines have the `MARKER_PERIODIC` to copy into the configuration. Rows of type
PERIODIC in a `.nmf` are this program's own.

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

Plot3D files do not state their variant. From the length of the file and the orientation of the cells, these
are found: count of blocks, dimensions, iblank, records, byte order, precision, the index that runs in z. Text
may have repeats, commas or D exponents. `--from plot3d:fortran,big` or `--plot3d fortran,big` overrides this;
the same words choose the variant to write. A grid of several blocks gets a neutral map beside the file,
`NAME.nmf`, and a map of that name is read with any file: its types, or the names in its comments, become
names of patches. `single` omits the count of blocks, `planes` writes the coordinates of one k after the
other, and `span-i` has the third direction of volumes as the first index of the file. iblank is reported
but not kept. Of a block of 2 GiB or more there is no Fortran record: write `plot3d:binary`.

## HDF5

Datasets hold n samples of one size; ten lines with h5py write or read a dataset. Layout version 1, for grids
and boundaries of one plane block:

| name | what it is |
| --- | --- |
| attributes | `format` (`meshonet-boundary` or `meshonet-grid`), `version` 1, `topology` (`quad`, `o`, `c`) |
| `south`, `north`, `west`, `east` | (n, ni, 2) and (n, nj, 2), the corners shared |
| `nodes` | (n, ni, nj, 2), of grids |
| `names`, `split`, `provenance` | (n,) texts, where there are any; `provenance` is JSON |
| `parts` | (n,) texts, JSON lists of `[name, side, start, stop]` |
| `parameters`, `sensors` | (n, p) with the attribute `names`; (n, m, 2) |

Version 2, for grids with several blocks or with blocks in space, has `blocks/0`, `blocks/1` ... in place of
edges, `nodes` and `topology`: (n, ni, nj, 2), (n, ni, nj, nk, 3), or (n, ni, nj, 3) on a surface. Rows of
`parts` have three more entries, `block, across, kind`: `across` is the range along the second direction of a
side, null for all of it. The attribute `connections` is a JSON list of the connections of sides, the same for
all samples: `[block, side, range, donor, donor_side, donor_range, orientation, transform]`. A range has the
first and last node along each direction of the side; for each of these directions, `orientation` has the
donor's direction that runs along it, counted from 1, negative when reversed; `transform` is null, or
`{"shift": [...], "turn": [[...]]}` between periodic sides.

A dataset may be in parts: `out/part-00000.h5` and on are datasets, and in `out.h5` each column is a virtual
dataset of their rows, by paths relative to it. The layout and its version are the same. A part also has the
attributes `request` (a digest of the options) and `size`, and texts `inputs` (digests of its inputs) and
`failed` (JSON lists `[input, member, error, again]`). Parts lie in one folder beside the index; an index that
shows files elsewhere is refused. [Large datasets](../guide/datasets.md) says how they are made.

`FILE.h5#7` is a sample of a dataset, counted from 0, `#5:9` and `#::2` are ranges, `#train` and `#test`
splits, `#test,0:9` both.

## Three-dimensional files

What a file of structured blocks holds, its blocks decide together:

1. Files of this program say it themselves (`.vts`, `.vtm`, `.vtk`, CGNS, HDF5).
2. A block is a *slice* if it is one plane of nodes in which a coordinate is constant, or a layer one cell
   thick: two planes that are copies of each other, shifted along one coordinate. Where all blocks are slices
   across the same coordinate at the same places, the file holds a grid in the plane. That coordinate and the
   index across are left out.
3. Else a block with one plane of nodes, along any index, is a patch of a surface, any other one a volume.

Left-handed volumes get i reversed, and so do the ranges that the file has for them. Surface patches stay
as they are. Volumes that touch are one grid; all patches of surface of a file are one grid, whether they
touch or not, so that gaps can be told of. Where a file does not say what is joined, parts of faces of volumes
and of edges of patches whose nodes coincide are, as in the plane.

`--extrude` repeats blocks, patches and interfaces in z, between symmetry planes `back` and `front`.
The same grid goes into every format, with its blocks where the format keeps blocks. It is read as plane again
from files that hold names; Plot3D files of more than one layer of cells are volumes.

**CGNS.** Zones of three indices, or of two for a surface (cell dimension 2, physical 3), each kind of grid
in a base of its own; interfaces with `Transform` and, for periodic sides, centre, angles about x, y, z in
turn, and shift; a family for each name. Conditions of others may be ranges or lists of points, of nodes or
faces; a list becomes the rectangles that it fills. Cartesian coordinates only.

**OpenFOAM.** One mesh of all blocks, in upper-triangular order as it is written, 129 x 129 x 129 nodes in
half a second. Meshes of more than 65,536 nodes are binary, smaller ones text; `--to openfoam:ascii` or
`openfoam:binary` chooses. A plane grid, or one that is one cell thick between symmetry planes, has them as
a patch `frontAndBack` of type `empty`. Symmetry patches that are flat are `symmetryPlane`, walls `wall`,
periodic sides `cyclic`, all others `patch`. Where the nodes of a side lie on each other, at an axis, cells
are prisms or pyramids.

**SU2, Gmsh, `.vtu`.** Hexahedra, and quadrilaterals by the names of patches. SU2 and Gmsh refuse a side whose
nodes lie on each other.

## Not read

- CGNS in ADF containers: convert it with `adf2hdf`.
- `.vts` compressed with LZ4: write it with zlib or LZMA.
- Gmsh meshes other than 2.2 and 4.1, and binary DXF.

Worked cases of flow solvers: `examples/naca0012-openfoam`, `examples/cylinder-openfoam`,
`examples/pipe-bend-openfoam`, `examples/naca0012-su2`.
"""

FAMILIES_HEAD = """# The six test families

<!-- made by python docs/make_pages.py -->

Use these families to train and compare operators. They are the test cases of the MeshONet paper; each shape
depends on one number. `sample-boundary --family NAME --count N` draws N members over the range, `--range A:B`
chooses another range, and `solve-pde` makes their grids.
"""


def main() -> None:
    """Write everything."""
    (REFERENCE / "models.md").write_text(models_page(), encoding="utf-8")
    (REFERENCE / "cli.md").write_text(reference(), encoding="utf-8")
    (REFERENCE / "formats.md").write_text(formats_page(), encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        pictures(Path(folder))
    (REFERENCE / "families.md").write_text(families_page(), encoding="utf-8")


def formats_page() -> str:
    """Return reference/formats.md."""
    return f"{FORMATS_HEAD}{markdown()}\n{FORMATS_REST}"


def models_page() -> str:
    """Return reference/models.md."""
    lines = [MODELS_HEAD]
    for name in shipped():
        if name in HEADS:
            lines += [f"## {name}\n", f"Winslow's grid, predicted by the network of `{HEADS[name][0]}`.\n"]
            continue
        facts = described(name)
        errors = strip_figures if "strips" in facts["figures"] else quad_figures
        lines += [
            f"## {name}\n",
            f"{GRIDS[facts['topology']]}, {facts['parameters']:,} parameters.\n",
            "Recipe:\n",
            "```json",
            json.dumps(facts["recipe"], indent=1),
            "```\n",
            *errors(facts["figures"], facts["topology"]),
            *curve(name),
            "",
        ]
    lines += [C_GRIDS, "The quality of the grids is on [the benchmark pages](../benchmarks/index.md).\n"]
    return "\n".join(lines)


def curve(name: str) -> list[str]:
    """Return a line about the losses of a model's training, where benchmarks/curves/NAME.csv exists."""
    path = DOCS / "benchmarks" / "curves" / f"{name}.csv"
    if not path.exists():
        return []
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    some = [rows[k] for k in sorted({0, len(rows) // 4, len(rows) // 2, len(rows) - 1})]
    losses = ", ".join(f"{float(row['held_out_loss']):.3g} after {row['epoch']}" for row in some)
    return [f"\nHeld-out loss by epoch: {losses} ([every epoch](../benchmarks/curves/{name}.csv))."]


def strip_figures(figures: dict[str, Any], _: str) -> list[str]:
    """Return the held-out errors of the airfoil operator."""
    lines = [
        f"Held out: {figures['strips']} procedural airfoils, not used in training. Weights are in float16.",
        f"Error: {figures['error']}.\n",
        "| method | median | 90 % | worst |",
        "| --- | --- | --- | --- |",
    ]
    for way, q in figures.items():
        if isinstance(q, dict):
            lines.append(f"| {way} | {q['median']:.1e} | {q['p90']:.1e} | {q['worst']:.1e} |")
    return lines


def quad_figures(figures: dict[str, Any], topology: str) -> list[str]:
    """Return the held-out errors of a network for four-sided domains or bodies."""
    counts = "33 x 33" if topology == "quad" else "65 x 33"
    lines = [
        f"Held out: {figures['domains']} random domains, not used in training. One network predicts both",
        f"grids. Errors are relative L2 distances to the solver's grid on {counts} nodes, without polish.",
        "*start* is the grid that the network corrects, *valid* the share of grids without folded cells.\n",
        "| predicted grid | median | 90 % | start | valid |",
        "| --- | --- | --- | --- | --- |",
    ]
    for answer, q in figures.items():
        if isinstance(q, dict):
            error = q["relative_l2"]
            lines.append(
                f"| {answer} | {error['median']:.1e} | {error['p90']:.1e} | {q['base']:.1e} "
                f"| {100 * q['fold_free']:.1f} % |"
            )
    gain = figures["variational"]
    lines += [
        "",
        "The network has this share of the improvement of the variational grid over Winslow's:\n"
        f"{100 * gain['mean_gain']:.0f} % in the mean angle, {100 * gain['max_gain']:.0f} % in the largest.",
    ]
    return lines


def families_page() -> str:
    """Return reference/families.md."""
    lines = [FAMILIES_HEAD]
    for name in FAMILIES:
        member = family(name)
        lines += [
            f"## {name}\n",
            f"{member.parameter}, {member.low:g} to {member.high:g}; topology {member.topology}.\n",
            f"![{name}](../img/{name}.png)\n",
        ]
    return "\n".join(lines)


def pictures(folder: Path) -> None:
    """Write docs/img/*.png."""
    grid = folder / "grid.vts"
    meshonet("infer", "naca:2412", "--res", "161x81", "-o", grid)
    meshonet("plot", grid, "--zoom=-0.35,1.35,-0.5,0.5", "-o", DOCS / "img" / "naca2412.png")
    meshonet("infer", "naca:2412", "--te", "wedge", "--wall-spacing", "1e-5", "--res", "250x100", "-o", grid)
    meshonet("plot", grid, "--zoom=0.96,1.06,-0.03,0.03", "-o", DOCS / "img" / "c-grid-edge.png")
    run(sys.executable, str(DOCS.parent / "examples" / "shape-optimisation" / "throat.py"), "-o", str(grid))
    meshonet("plot", grid, "-o", DOCS / "img" / "throat.png")
    for name in FAMILIES:
        boundary = folder / f"{name}.h5"
        zoom = ["--zoom=-0.6,1.6,-0.8,0.8"] if name == "airfoil" else []
        meshonet("sample-boundary", "--family", name, "--count", "1", "--res", "61x41", "-o", boundary)
        meshonet("solve-pde", boundary, "-o", grid)
        meshonet("plot", grid, *zoom, "-o", DOCS / "img" / f"{name}.png")
    for path in (DOCS / "img").glob("*.png"):
        reduce(path)


def reduce(path: Path) -> None:
    """Rewrite a picture with at most 1320 pixels a row and 96 colours: a fifth of the bytes."""
    picture = Image.open(path).convert("RGB")
    picture.thumbnail((1320, 1320), Image.Resampling.LANCZOS)
    picture.quantize(96, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(path, optimize=True)


def meshonet(*words: object) -> None:
    """Run the command line quietly."""
    run(sys.executable, "-m", "meshonet_cli", *(str(word) for word in words), "--quiet")


def run(*words: str) -> None:
    """Run a program; stop when it fails."""
    subprocess.run(words, check=True)  # noqa: S603 - our own program


if __name__ == "__main__":
    main()
