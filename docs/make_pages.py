"""Make the generated pages and pictures of docs/: python docs/make_pages.py (make docs).

cli.md from the application, formats.md from the registry, models.md from the headers of the shipped models,
families.md and the pictures from the commands a user would type.
"""

from __future__ import annotations

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from meshonet.formats.catalogue import page as formats_page
from meshonet.geometry.families.family import FAMILIES, family
from meshonet.solvers.neural.registry import HEADS, described, shipped
from meshonet_cli.reference import reference

DOCS = Path(__file__).parent
GRIDS = {"o": "O-grids", "quad": "Grids of four-sided domains"}

C_GRIDS = """## C grids: no model

No network serves C grids, since none measures as good as what needs none. The network for four-sided
domains alone is worse there than transfinite interpolation, and after five steps of descent still behind the
variational grid ([figures](body-operator.md#c-grids-no-model)). The strip of `airfoil-o` is periodic, and a
wake cuts it open. `infer` marches C grids from wall and wake ([how](viscous.md)), minimises where the march
does not suit, and its report says which; `--model`, `--polish` and `--device` are refused.
"""


def main() -> None:
    """Write everything."""
    (DOCS / "models.md").write_text(models_page(), encoding="utf-8")
    (DOCS / "cli.md").write_text(reference(), encoding="utf-8")
    (DOCS / "formats.md").write_text(formats_page(), encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        pictures(Path(folder))
    (DOCS / "families.md").write_text(families_page(), encoding="utf-8")


def models_page() -> str:
    """Return docs/models.md."""
    lines = [
        "# Shipped models\n",
        "<!-- made by python docs/make_pages.py; a test keeps it current -->\n",
        "`meshonet models` lists them. Each is a safetensors file in `solvers/neural/pretrained/` that",
        "carries its recipe and held-out figures; `make train` makes it again, and its curve of losses\n"
        "(`docs/curves`; quad-first is the first of two runs for `quad-general`).\n",
    ]
    for name in shipped():
        if name in HEADS:
            lines += [f"## {name}\n", f"The Winslow grid of the network of {HEADS[name][0]}.\n"]
            continue
        facts = described(name)
        held_out = strip_figures if "strips" in facts["figures"] else quad_figures
        lines += [
            f"## {name}\n",
            f"{GRIDS[facts['topology']]}, {facts['parameters']:,} parameters.\n",
            "Recipe:\n",
            "```json",
            json.dumps(facts["recipe"], indent=1),
            "```\n",
            *held_out(facts["figures"], facts["topology"]),
            *curve(name),
            "",
        ]
    lines.append(C_GRIDS)
    lines.append("What that means for grids is on [the benchmark page](benchmarks.md).\n")
    return "\n".join(lines)


def curve(name: str) -> list[str]:
    """Return what the log of a model's training tells, where it was kept: docs/curves/NAME.csv."""
    path = DOCS / "curves" / f"{name}.csv"
    if not path.exists():
        return []
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    told = [rows[k] for k in sorted({0, len(rows) // 4, len(rows) // 2, len(rows) - 1})]
    losses = ", ".join(f"{float(row['held_out_loss']):.3g} after {row['epoch']}" for row in told)
    return [f"\nHeld-out loss by epoch: {losses} ([every epoch](curves/{name}.csv))."]


def strip_figures(figures: dict[str, Any], _: str) -> list[str]:
    """Return what an airfoil operator's file says of strips it was not trained on."""
    lines = [
        f"Held out: {figures['strips']} procedural airfoils, never trained on. Stored in float16.",
        f"Error: {figures['error']}.\n",
        "| way | median | 90 % | worst |",
        "| --- | --- | --- | --- |",
    ]
    for way, q in figures.items():
        if isinstance(q, dict):
            lines.append(f"| {way} | {q['median']:.1e} | {q['p90']:.1e} | {q['worst']:.1e} |")
    return lines


def quad_figures(figures: dict[str, Any], topology: str) -> list[str]:
    """Return what a quad network's file says of domains it was not trained on."""
    counts = "33 x 33" if topology == "quad" else "65 x 33"
    lines = [
        f"Held out: {figures['domains']} random domains, never trained on. One network has both answers.",
        f"Relative L2 to the grid it was taught, and grids without folds, on {counts} nodes, no polish.\n",
        "| answer | median | 90 % | what it starts from | without folds |",
        "| --- | --- | --- | --- | --- |",
    ]
    for answer, q in figures.items():
        if isinstance(q, dict):
            error = q["relative_l2"]
            lines.append(
                f"| {answer} | {error['median']:.1e} | {error['p90']:.1e} | {q['base']:.1e} "
                f"| {100 * q['fold_free']:.1f} % |"
            )
    told = figures["variational"]
    lines += [
        "",
        f"Of what the variational grid improves on Winslow's: {100 * told['mean_gain']:.0f} % in the mean, "
        f"{100 * told['max_gain']:.0f} % in the largest angle.",
    ]
    return lines


def families_page() -> str:
    """Return docs/families.md."""
    lines = [
        "# The six families\n",
        "<!-- made by python docs/make_pages.py -->\n",
        "The test cases of the MeshONet paper, each a shape that one number varies.",
        "`sample-boundary --family NAME --count N` spreads N members over the range; `--range A:B`",
        "chooses another. Grids: `solve-pde`.\n",
    ]
    for name in FAMILIES:
        one = family(name)
        lines += [
            f"## {name}\n",
            f"{one.parameter}, {one.low:g} to {one.high:g}; topology {one.topology}.\n",
            f"![{name}](img/{name}.png)\n",
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


def meshonet(*words: object) -> None:
    """Run the command line quietly."""
    run(sys.executable, "-m", "meshonet_cli", *(str(word) for word in words), "--quiet")


def run(*words: str) -> None:
    """Run a program; stop when it fails."""
    subprocess.run(words, check=True)  # noqa: S603 - our own program


if __name__ == "__main__":
    main()
