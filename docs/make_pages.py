"""Make the generated pages of docs/: python docs/make_pages.py (make text); seconds.

In reference/: commands from the application, formats.md from the registry, models.md from the headers of the
shipped models, families.md from the families. In development/: blocking.md from the docstrings of modules.
Pictures: make_pictures.py.
"""

import ast
import json
from pathlib import Path
from typing import Any

from command_pages import reference

from meshonet.api.models import models
from meshonet.formats.catalogue import rows
from meshonet.geometry.families.family import FAMILIES, family
from meshonet.solvers.neural.registry import HEADS, described, shipped

DOCS = Path(__file__).parent
REFERENCE = DOCS / "reference"

MODELS_HEAD = """# Shipped models

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the training parameters of meshonet's models, the neural networks that generate grids.
[Neural operators](../theory/operators.md) helps to choose a model, and [held-out
errors](../benchmarks/models.md) gives the accuracy of each. `meshonet models NAME` prints the same data.

Each model is a safetensors file in `solvers/neural/pretrained/`. Its metadata contain these parameters.
`make train` repeats the training.

| training parameter | meaning |
| --- | --- |
| `datasets` | files with the training grids, which a solver made |
| `strips`, `domains` | number of samples (airfoils or domains) in the datasets, held-out ones included |
| `held_out` | number of samples used to measure errors, not for training |
| `epochs`, `batch`, `seed` | passes over the training samples, samples per step, seed of the random numbers |
| `rate`, `warm_up` | largest learning rate, reached after `warm_up` steps; then the rate falls as a cosine |
| `weight_decay`, `clip` | weight decay of AdamW, and the largest norm of the gradient |
| `initial` | model whose weights the training starts from; `quad-first`, an earlier model, is not shipped |
| `weights` | coefficients of the terms of the loss ([training](../theory/operators.md#training)) |
| `widths` | U-Net: channels on each level, in units of eight, the finest level first |
| `blocks` | U-Net: residual blocks on each level, on the way down and again on the way up |
| `layers`, `width`, `modes` | Fourier neural operator: layers, channels, Fourier modes in a layer |
| `basis` | Fourier neural operator: it sums this many functions of the coordinate away from the wall |
"""
ERRORS_HEAD = """# Held-out errors of the shipped models

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the accuracy of the neural networks (models) in meshonet. The errors are distances
between grids of a model and grids of a solver, on *held-out* shapes (not used in training).
`meshonet models NAME` prints these errors. The training parameters are in [shipped
models](../reference/models.md).

In the tables, the *initial grid* or *base* is the grid that a network corrects. *Valid*: no folded cells.
"""
C_GRIDS = """## C grids: no model

meshonet has no model for C grids, because marching gives better C grids than every network that was tested
([measurements](../benchmarks/body-operator.md#c-grids-no-model)). The C grids that `quad-general` predicts
are worse than those of transfinite interpolation. `airfoil-o` assumes that the grid is periodic along the
wall, which a C grid is not.

`meshonet infer` generates C grids by [marching](../theory/marching.md) from the wall and the wake, or by the
variational method if marching fails. For C grids the options `--model`, `--polish` and `--device` are errors.
"""

FORMATS_HEAD = """# Formats

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the file formats that meshonet reads and writes. `meshonet convert IN OUT` selects the formats
by the file extensions. If an extension belongs to several formats, name the format with `--from` or `--to`.
`meshonet convert --list-formats` prints this table.

- *names*: whether the format stores names of boundary patches.
- *3D*: the kinds of three-dimensional grids that the format stores. If it stores *volumes*, `--extrude H`
  writes a two-dimensional grid as a volume of thickness H.
- *blocks*: whether the blocks of a multi-block grid are *kept* in the file or *merged* into one unstructured
  mesh. A format without an entry cannot store a multi-block grid.
- *many*: whether one file can contain several grids or boundaries.
- *options*: variants of the format. Write them after a colon, for example `--to gmsh:4.1,ascii`. Of words
  separated by slashes, choose at most one. The first word is the default, unless the extension implies
  another.

"""
FORMATS_REST = """
Details are on three other pages: [conventions of formats](format-details.md) (multi-block grids, boundaries,
variants of Plot3D), [files in three dimensions](format-volumes.md) and [HDF5](hdf5.md) (datasets).

These folders contain complete examples with flow solvers: `examples/naca0012-openfoam`,
`examples/cylinder-openfoam`, `examples/pipe-bend-openfoam`, `examples/aircraft`, `examples/blade-row` and
`examples/naca0012-su2`.

## Files that meshonet cannot read

- CGNS files in ADF containers: convert them with `adf2hdf`.
- `.vts` files compressed with LZ4: write them with zlib or LZMA.
- `.msh` files of Fluent, which are not Gmsh files. meshonet cannot write them either.
- Gmsh meshes of other versions than 2.2 and 4.1, and binary DXF files.
"""

BLOCKING_HEAD = """# Files of blocking

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here to find a file in `solvers/blocking` or `solvers/cascade`. Each row is the first paragraph of the
file's docstring. [Theory](../theory/blocks.md) explains the terms, and [stages](stages.md) the order in which
the functions are called. A *loop* is a closed boundary curve; a *front* is the outer edge of layers.
"""

FAMILIES_HEAD = """# The six test families

<!-- made by python docs/make_pages.py -->

Use these families of shapes to train and compare neural operators. They are the test cases of the MeshONet
paper ([results](../benchmarks/paper/index.md)). The shapes of each family depend on one parameter.

- *arch*: a square of side 1 whose top edge is half a sine wave
- *hexagon*: a square of side 1 with a kink in the middle of the top edge and of the bottom edge
- *wrench*: a square of side 1 with a notch in the top edge
- *semicircle*: a channel, 2 long and 1 high, with a semicircle on its floor
- *airfoil*: a NACA 00xx airfoil with a sharp trailing edge in a circular far field
- *hole*: a square of side 2 around the origin with a round hole

`meshonet sample-boundary --family NAME --count N` makes N shapes with parameters in the ranges below;
`--range A:B` gives another range. `meshonet solve-pde` makes their grids. The topology quad is a four-sided
grid, the topology O a grid around a body or hole.
"""


def main() -> None:
    """Write everything."""
    (REFERENCE / "models.md").write_text(models_page(), encoding="utf-8")
    (DOCS / "benchmarks" / "models.md").write_text(errors_page(), encoding="utf-8")
    (REFERENCE / "commands").mkdir(exist_ok=True)
    for name, page in reference().items():
        (REFERENCE / "commands" / name).write_text(page, encoding="utf-8")
    (REFERENCE / "formats.md").write_text(formats_page(), encoding="utf-8")
    (REFERENCE / "families.md").write_text(families_page(), encoding="utf-8")
    (DOCS / "development" / "blocking.md").write_text(blocking_page(), encoding="utf-8")


def blocking_page() -> str:
    """Return development/blocking.md: files and the first lines of their docstrings, folder by folder."""
    rooms = [DOCS.parent / "solvers" / name for name in ("blocking", "cascade")]
    lines = [BLOCKING_HEAD]
    for folder in sorted({path.parent for room in rooms for path in room.rglob("*.py")}):
        name = folder.relative_to(DOCS.parent).as_posix()
        lines += [f"## `{name}/`\n", f"{said_of(folder / '__init__.py')}\n"]
        files = sorted(path for path in folder.glob("*.py") if path.name != "__init__.py")
        if files:
            lines += ["| file | purpose |", "| --- | --- |"]
            lines += [*(f"| `{path.name}` | {said_of(path)} |" for path in files), ""]
    return "\n".join(lines)


def said_of(path: Path) -> str:
    """Return the first paragraph of a module's docstring, on one line."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split())


def formats_page() -> str:
    """Return reference/formats.md."""
    table = rows()
    lines = [list(table[0]), ["---"] * len(table[0]), *(list(row.values()) for row in table)]
    return FORMATS_HEAD + "".join(f"| {' | '.join(line)} |\n" for line in lines) + FORMATS_REST


def models_page() -> str:
    """Return reference/models.md."""
    lines = [MODELS_HEAD]
    for name in shipped():
        use = models(name)[0]["use"]
        use = f"{use[0].upper()}{use[1:]}."
        if name in HEADS:
            lines += [f"## {name}\n", f"{use} A second output of the network `{HEADS[name][0]}`.\n"]
            continue
        facts = described(name)
        kind = "A Fourier neural operator" if "strips" in facts["recipe"] else "A U-Net"
        lines += [
            f"## {name}\n",
            f"{use} {kind} with {facts['parameters']:,} parameters.\n",
            "Training parameters:\n",
            "```json",
            json.dumps(facts["recipe"], indent=1),
            "```\n",
        ]
    return "\n".join([*lines, C_GRIDS])


def errors_page() -> str:
    """Return benchmarks/models.md."""
    lines = [ERRORS_HEAD]
    for name in shipped():
        if name not in HEADS:
            facts = described(name)
            errors = strip_figures if "strips" in facts["figures"] else quad_figures
            lines += [f"## {name}\n", *errors(facts["figures"], facts["topology"]), *curve(name), ""]
    return "\n".join(lines)


def curve(name: str) -> list[str]:
    """Return a line about the losses of a model's training, where benchmarks/curves/NAME.csv exists."""
    path = DOCS / "benchmarks" / "curves" / f"{name}.csv"
    if not path.exists():
        return []
    text = f"\n[Losses](../theory/operators.md#training) of every epoch are in a [table](curves/{name}.csv)."
    initial = described(name)["recipe"]["initial"]
    if initial not in shipped():
        text += f" The training continues an [earlier one](curves/{initial}.csv)."
    return [text]


def strip_figures(figures: dict[str, Any], _: str) -> list[str]:
    """Return the held-out errors of the airfoil operator."""
    lines = [
        f"The held-out samples are {figures['strips']} random airfoils. A",
        "[conformal map](../theory/o-grids.md) takes each domain to a strip. Errors are root mean square",
        "distances from Winslow's solution in the strip, in radians. *+ n Picard*: n fixed-point iterations",
        "for Winslow's equations follow.\n",
        "| method | error, median | error, 90th percentile | error, maximum |",
        "| --- | --- | --- | --- |",
    ]
    for way, q in figures.items():
        if isinstance(q, dict):
            lines.append(f"| {way} | {q['median']:.1e} | {q['p90']:.1e} | {q['worst']:.1e} |")
    return lines


def quad_figures(figures: dict[str, Any], topology: str) -> list[str]:
    """Return the held-out errors of a network for four-sided domains or bodies."""
    bodies = topology != "quad"
    counts, domains = ("65 x 33", "domains around bodies") if bodies else ("33 x 33", "four-sided domains")
    middle = "the middle of the body" if bodies else "the mean of the boundary nodes"
    lines = [
        f"The held-out samples are {figures['domains']} random {domains}. One network predicts the",
        f"[variational grid](../theory/variational.md) and Winslow's grid, on {counts} nodes, without solver",
        "iterations. The *error* is the RMS distance of the nodes from those of the solver's grid, divided",
        f"by the RMS distance of the solver's nodes from {middle}.\n",
        "| predicted grid | error, median | error, 90th percentile | initial grid: error, median | valid |",
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
        "Two measures of a grid are the mean and the maximum of its cells' largest angles. Both are smaller\n"
        "for the solver's variational grid than for Winslow's grid. The network achieves "
        f"{100 * gain['mean_gain']:.0f} % of the\ndifference of the means, and "
        f"{100 * gain['max_gain']:.0f} % of the difference of the maxima.",
    ]
    return lines


def families_page() -> str:
    """Return reference/families.md."""
    lines = [FAMILIES_HEAD]
    for name in FAMILIES:
        member = family(name)
        lines += [
            f"## {name}\n",
            f"The parameter is the {member.parameter}, from {member.low:g} to {member.high:g}. "
            f"The topology is {member.topology if member.topology == 'quad' else member.topology.upper()}.\n",
            f"![{name}](../img/{name}.png)\n",
        ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
