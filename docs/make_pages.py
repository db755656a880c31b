"""Make the generated pages of docs/: python docs/make_pages.py (make text); seconds.

In reference/: cli.md from the application, formats.md from the registry, models.md from the headers of the
shipped models, families.md from the families. In development/: blocking.md from the docstrings of modules.
Pictures: make_pictures.py.
"""

from __future__ import annotations

import ast
import csv
import json
from pathlib import Path
from typing import Any

from meshonet.formats.catalogue import markdown
from meshonet.geometry.families.family import FAMILIES, family
from meshonet.solvers.neural.registry import HEADS, described, shipped
from meshonet_cli.help.reference import reference

DOCS = Path(__file__).parent
REFERENCE = DOCS / "reference"
GRIDS = {"o": "O grids", "quad": "Grids of four-sided domains"}

MODELS_HEAD = """# Shipped models

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the training recipe of a model. When to use which model is said in
[operators](../theory/operators.md), how good they are in [held-out errors](../benchmarks/models.md).
`meshonet models` prints the same data.

Each model is a safetensors file in `solvers/neural/pretrained/` that carries its recipe and its figures.
`make train` trains them again.
"""
ERRORS_HEAD = """# Held-out errors of the shipped models

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for how far the answers of a shipped model are from the solver's, on shapes that it was not trained
on. The [recipes](../reference/models.md) are elsewhere; `meshonet models` prints both. The losses of every
epoch are in `docs/benchmarks/curves`; `quad-first` is the first of two runs for `quad-general`.
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
Several blocks, boundaries and variants of Plot3D are in [conventions of formats](format-details.md), volumes
and surfaces in [three dimensions](format-volumes.md), the layout of datasets in [HDF5](hdf5.md).

## Not read

- CGNS in ADF containers: convert it with `adf2hdf`.
- `.vts` compressed with LZ4: write it with zlib or LZMA.
- Gmsh meshes other than 2.2 and 4.1, and binary DXF.

Worked cases of flow solvers: `examples/naca0012-openfoam`, `examples/cylinder-openfoam`,
`examples/pipe-bend-openfoam`, `examples/naca0012-su2`.
"""

BLOCKING_HEAD = """# Files of blocking

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the file that you are after in `solvers/blocking`; in which order they work is said in
[stages](stages.md). Each line is the first one of the file.
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
    (DOCS / "benchmarks" / "models.md").write_text(errors_page(), encoding="utf-8")
    (REFERENCE / "cli.md").write_text(reference(), encoding="utf-8")
    (REFERENCE / "formats.md").write_text(formats_page(), encoding="utf-8")
    (REFERENCE / "families.md").write_text(families_page(), encoding="utf-8")
    (DOCS / "development" / "blocking.md").write_text(blocking_page(), encoding="utf-8")


def blocking_page() -> str:
    """Return development/blocking.md: files and the first lines of their docstrings, folder by folder."""
    room = DOCS.parent / "solvers" / "blocking"
    lines = [BLOCKING_HEAD]
    for folder in sorted({path.parent for path in room.rglob("*.py")}):
        name = folder.relative_to(room.parents[1]).as_posix()
        lines += [f"## `{name}/`\n", f"{said_of(folder / '__init__.py')}\n"]
        files = sorted(path for path in folder.glob("*.py") if path.name != "__init__.py")
        if files:
            lines += ["| file | is |", "| --- | --- |"]
            lines += [*(f"| `{path.name}` | {said_of(path)} |" for path in files), ""]
    return "\n".join(lines)


def said_of(path: Path) -> str:
    """Return the first paragraph of a module's docstring, on one line."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split())


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
        lines += [
            f"## {name}\n",
            f"{GRIDS[facts['topology']]}, {facts['parameters']:,} parameters.\n",
            "Recipe:\n",
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
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    some = [rows[k] for k in sorted({0, len(rows) // 4, len(rows) // 2, len(rows) - 1})]
    losses = ", ".join(f"{float(row['held_out_loss']):.3g} after {row['epoch']}" for row in some)
    return [f"\nHeld-out loss by epoch: {losses} ([every epoch](curves/{name}.csv))."]


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


if __name__ == "__main__":
    main()
