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

from command_pages import reference

from meshonet.api.models import models
from meshonet.formats.catalogue import rows
from meshonet.geometry.families.family import FAMILIES, family
from meshonet.solvers.neural.registry import HEADS, described, shipped

DOCS = Path(__file__).parent
REFERENCE = DOCS / "reference"

MODELS_HEAD = """# Shipped models

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the training parameters of the shipped models. For the choice of a model see
[neural operators](../theory/operators.md), for the accuracy of each see
[held-out errors](../benchmarks/models.md). `meshonet models` prints the same data.

Each model is a safetensors file in `solvers/neural/pretrained/`; its metadata hold the training parameters
and the held-out errors. `make train` repeats the training.

| training parameter | meaning |
| --- | --- |
| `datasets` | training grids; the target grids come from a solver |
| `strips`, `domains` | samples in the datasets, those held out included |
| `held_out` | samples that are not used in training, only to measure errors |
| `epochs`, `batch`, `seed` | passes over the training samples, samples per step, seed of the random numbers |
| `rate`, `warm_up` | largest learning rate, reached after `warm_up` steps and reduced to zero by a cosine |
| `weight_decay`, `clip` | weight decay of AdamW, and the largest norm of the gradient |
| `initial` | model with the initial weights; `quad-first` is an earlier run and not shipped |
| `weights` | coefficients of the terms of the loss ([training](../theory/operators.md#training)) |
| `widths` | U-Net: channels on each level, in units of eight, the finest level first |
| `blocks` | U-Net: residual blocks on each level, on the way down and again on the way up |
| `layers`, `width`, `modes` | Fourier neural operator: layers, channels, Fourier modes in a layer |
| `basis` | Fourier neural operator: basis functions of its output, from wall to far field |
"""
ERRORS_HEAD = """# Held-out errors of the shipped models

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the distance between the grids that a shipped model predicts and those of the solver, on shapes
that were not used in training. The training parameters are in [shipped models](../reference/models.md);
`meshonet models` prints both. The loss after every epoch is in `docs/benchmarks/curves`; `quad-first` is the
first of the two training runs of `quad-general`.
"""
C_GRIDS = """## C grids: no model

No model for C grids is shipped, because none is as good as hyperbolic marching. For C grids the predictions
of `quad-general` are worse than transfinite interpolation; after five further iterations of the variational
method their mean angle is still worse than that of the variational grid
([figures](../benchmarks/body-operator.md#c-grids-no-model)). `airfoil-o` assumes that the grid is periodic in
ξ; a C grid is not, because of its wake. `infer` therefore generates C grids by
[marching](../theory/marching.md) from the wall and the wake, or by the variational method if marching fails.
The report names the method used. For C grids the options `--model`, `--polish` and `--device` are rejected.
"""

FORMATS_HEAD = """# Formats

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for the file formats that meshonet reads and writes. `meshonet convert IN OUT` selects the formats
by the file extensions; `--from` and `--to` name a format if the extension is ambiguous. `meshonet convert
--list-formats` prints this table.

- *names*: the format stores names of boundary patches.
- *3D*: the three-dimensional grids that the format stores. With *volumes*, `--extrude H` (`--planes K`)
  writes a two-dimensional grid as a volume.
- *blocks*: a multi-block grid is written with its blocks *kept*, or *merged* into one unstructured mesh. A
  format without an entry cannot store a multi-block grid.
- *many*: one file can hold several grids or boundaries.
- *options*: variants of the format, written after a colon, at most one from each group, for example `--to
  gmsh:4.1,ascii`. The first of a group is the default unless the extension implies another one.

"""
FORMATS_REST = """
For multi-block grids, boundaries and the variants of Plot3D see
[conventions of formats](format-details.md), for volumes and surfaces
[files in three dimensions](format-volumes.md), for the layout of datasets [HDF5](hdf5.md).

## Not read

- CGNS in ADF containers: convert it with `adf2hdf`.
- `.vts` compressed with LZ4: write it with zlib or LZMA.
- Fluent's `.msh`, another format than Gmsh's, which is not written either.
- Gmsh meshes other than 2.2 and 4.1, and binary DXF.

Worked examples with flow solvers: `examples/naca0012-openfoam`, `examples/cylinder-openfoam`,
`examples/pipe-bend-openfoam`, `examples/aircraft`, `examples/blade-row`, `examples/naca0012-su2`.
"""

BLOCKING_HEAD = """# Files of blocking

<!-- made by python docs/make_pages.py; a test keeps it current -->

Look here for a file in `solvers/blocking`. Each row quotes the first paragraph of the file's docstring. The
order in which the files work is described in [stages](stages.md).
"""

FAMILIES_HEAD = """# The six test families

<!-- made by python docs/make_pages.py -->

Use these families to train and compare neural operators. They are the test cases of the MeshONet paper;
each shape depends on one parameter. `sample-boundary --family NAME --count N` samples N members over the
range of the parameter, `--range A:B` selects another range, and `solve-pde` generates the grids.
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
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    some = [rows[k] for k in sorted({0, len(rows) // 4, len(rows) // 2, len(rows) - 1})]
    losses = ", ".join(f"{float(row['held_out_loss']):.3g} after {row['epoch']}" for row in some)
    return [f"\nLoss on the held-out samples: {losses} epochs ([every epoch](curves/{name}.csv))."]


def strip_figures(figures: dict[str, Any], _: str) -> list[str]:
    """Return the held-out errors of the airfoil operator."""
    lines = [
        f"Held-out samples: {figures['strips']} procedural airfoils, not used in training. Weights are in",
        "float16. The error is the root mean square distance, in radians, to Winslow's solution in the",
        "[strip](../reference/glossary.md) to which the conformal map takes the domain. *base* is the",
        "initial grid, the harmonic extension of the boundary, which the network corrects; *n Picard* adds n",
        "Picard steps towards Winslow's solution.\n",
        "| method | median | 90th percentile | maximum |",
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
        f"Held-out samples: {figures['domains']} random domains, not used in training. One network predicts",
        f"both grids. Errors are relative L2 distances to the solver's grid on {counts} nodes, without",
        "polish (solver iterations after the network). *initial* is the median error of the grid that the",
        "network corrects, *valid* the share of grids without folded cells.\n",
        "| predicted grid | median error | 90th percentile | initial | valid |",
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
        "Variational grids have smaller cell corner angles than Winslow's grids. The network\n"
        f"achieves {100 * gain['mean_gain']:.0f} % of this reduction for the mean over all cells (of the\n"
        f"largest angle of a cell), and {100 * gain['max_gain']:.0f} % for the largest angle of the grid.",
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
