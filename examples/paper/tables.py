"""The pages of docs/benchmarks/paper from the JSON and CSV that meshonet wrote: python tables.py PAGES.

PAGES/results holds one file a case, split and way; what is missing is left out of the tables, so that a run
can be looked at while it goes on.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from pathlib import Path
from statistics import mean, pstdev
from typing import Any

import words
from claims import lowest, quality_claims, speed_claims
from results import (
    FAMILIES,
    RACERS,
    SPLITS,
    finished,
    one,
    raced,
    read_log,
    summary,
    table,
)

WAYS = (
    ("tfi", "TFI"),
    ("pde", "PDE (Winslow)"),
    ("meshonet.raw", "MeshONet, network output"),
    ("meshonet.pasted", "MeshONet, boundary pasted"),
    ("meshonet.valid", "MeshONet, repaired (`infer`)"),
    ("meshonet-hard.raw", "MeshONet-hard, network output"),
    ("meshonet-hard.valid", "MeshONet-hard, repaired (`infer`)"),
)
DELIVERED = ("meshonet.valid", "meshonet-hard.valid")
PHYSICS = (
    ("mgnet", "Winslow's equations and the boundary (`mgnet`)"),
    ("mgnet-finite", "Winslow's equations (central differences, `finite=0.01`) and the boundary"),
    ("mgnet-lines", "Winslow's equations, the boundary, and nodes of 3 grid lines per direction (`lines=3`)"),
    ("meshnet", "Winslow's equations, the boundary, and the nodes of a solved 11 x 11 grid (`meshnet`)"),
)
TIMED = (("tfi", "TFI"), ("pde", "PDE"), ("meshonet", "MeshONet"), ("coarse", None), ("meshonet-hard", None))


def main() -> None:
    """Write every page for which there are results."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pages", type=Path)
    parser.add_argument("--machine", default="this machine")
    parser.add_argument("--note", default="", help="what a reader should know of this run")
    options = parser.parse_args()
    pages: Path = options.pages
    results = pages / "results"
    parts = [
        words.HEAD,
        words.STANDS,
        lowest(results),
        quality_claims(results),
        speed_claims(results),
    ]
    parts += [words.QUALITY, *quality(results), words.RACE, race(results, pages)]
    parts += [shelf(results), words.PHYSICS, physics(results)]
    parts += [words.TIME.format(machine=options.machine), times(results), words.MAPS, maps(pages)]
    parts += [words.SETTINGS, options.note]
    text = "\n\n".join(part.strip() for part in parts if part)
    (pages / "index.md").write_text(text + "\n", encoding="utf-8")


def quality(results: Path) -> Iterable[str]:
    """Yield a table for each family: every way on the grids that nobody trained on."""
    for family in FAMILIES:
        rows = []
        for split in SPLITS:
            for way, name in WAYS:
                report = summary(results / f"{family}.{split}.{way}.json")
                if report:
                    rows.append([split, name, *figures(report)])
        if rows:
            head = [
                "split",
                "method",
                "relative L2, median / maximum",
                "boundary error",
                "largest angle, mean / maximum",
            ]
            head += ["mean angle", "folded cells (grids)"]
            yield f"### {family}\n\n{table(head, rows)}"


def figures(report: dict[str, Any]) -> list[str]:
    """Return a row's figures of a summary."""
    folded = report["folded"]
    return [
        f"{report['relative_l2']['median']:.1e} / {report['relative_l2']['max']:.1e}",
        f"{report['boundary']['max']:.0e}",
        f"{report['max_angle']['mean']:.1f} / {report['max_angle']['max']:.1f}",
        f"{report['mean_angle']['mean']:.1f}",
        f"{folded['sum']:.0f} ({folded['members']} of {report['members']})",
    ]


def race(results: Path, pages: Path) -> str:
    """Return the table of losses on one budget, and draw them over the shapes seen."""
    rows, curves = [], {}
    for case in raced(results):
        of_meshonet = 0.0
        for model in RACERS:
            runs = [read_log(path) for path in finished(results, case, model)]
            reports = [summary(path) for path in sorted(results.glob(f"{case}.{model}.race*.json"))]
            errors = [one["relative_l2"]["median"] for one in reports if one]
            if not runs or not errors:
                continue
            last = [run[-1]["mean_square"] for run in runs]
            curves[model] = runs
            if model == "meshonet":
                of_meshonet = mean(last)
            compared = of_meshonet and model != "meshonet-hard"
            ratio = f"{mean(last) / of_meshonet:.2g}" if compared else "-"
            spread = f"{mean(errors):.1e} ± {pstdev(errors):.0e}"
            seen = f"{runs[0][-1]['seen']:,.0f}"
            final = f"{mean(last):.1e} ± {pstdev(last):.0e}"
            rows.append([case, model, seen, str(len(runs)), final, ratio, spread])
    if not rows:
        return ""
    draw(curves, pages / "loss.png")
    head = [
        "case",
        "network",
        "shapes seen",
        "seeds",
        "loss",
        "loss / MeshONet's loss",
        "relative L2, median",
    ]
    return f"![loss](loss.png)\n\n{table(head, rows)}"


def shelf(results: Path) -> str:
    """Return the errors of every model on every case, and how MeshONet's compare, in words."""
    values: dict[tuple[str, str], dict[str, list[float]]] = {}
    for family, split in ((f, s) for f in FAMILIES for s in SPLITS):
        own = {}
        for model in RACERS:
            reports = [one(path) for path in sorted(results.glob(f"{family}.{split}.{model}.shelf*.json"))]
            if reports:
                own[model] = [run["figures"]["test"]["median"] for run in reports]
        if own:
            values[family, split] = own
    models = [model for model in RACERS if any(model in own for own in values.values())]
    if not models:
        return ""
    rows = []
    for (family, split), own in values.items():
        least = min(mean(errors) for errors in own.values())
        cells = []
        for model in models:
            errors = own.get(model, [])
            text = f"{mean(errors):.1e} ± {pstdev(errors):.0e}" if errors else "-"
            cells.append(f"**{text}**" if errors and mean(errors) == least else text)
        rows.append([family, split, *cells])
    counts = [
        _compared(model, [own for own in values.values() if model in own and "meshonet" in own])
        for model in models
    ]
    head = ["network", "cases with a smaller error of MeshONet", "error / MeshONet's error, range"]
    compared = table(head, [row for row in counts if row])
    return f"{words.SHELF}\n{compared}\n\n{table(['case', 'split', *models], rows)}"


def _compared(model: str, cases: Sequence[dict[str, list[float]]]) -> list[str]:
    """Return in how many cases MeshONet's error is below that of `model`; nothing for itself."""
    if model == "meshonet" or not cases:
        return []
    ratios = [mean(own[model]) / mean(own["meshonet"]) for own in cases]
    below = sum(ratio > 1.0 for ratio in ratios)
    return [f"`{model}`", f"{below} of {len(cases)}", f"{min(ratios):.2g} to {max(ratios):.2g}"]


def physics(results: Path) -> str:
    """Return the table of networks for one geometry."""
    rows = []
    for name, learns in PHYSICS:
        report, log = summary(results / f"one.{name}.json"), results / f"one.{name}.csv"
        if report:
            last = read_log(log)[-1] if log.exists() else None
            spent = [f"{last['epoch']:,.0f}", f"{last['seconds']:.0f}"] if last else ["-", "-"]
            error, away = report["relative_l2"]["median"], report["boundary"]["max"]
            folded, angle = report["folded"]["sum"], report["max_angle"]["max"]
            rows.append([learns, f"{error:.1e}", f"{away:.0e}", f"{angle:.1f}", f"{folded:.0f}", *spent])
    head = [
        "learns from",
        "relative L2",
        "boundary error",
        "largest angle",
        "folded cells",
        "steps",
        "time, s",
    ]
    return table(head, rows) if rows else ""


def draw(curves: dict[str, list[list[dict[str, float]]]], path: Path) -> None:
    """Draw the mean square error of every model and seed over the shapes seen."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 4.2), layout="constrained")
    for k, (model, runs) in enumerate(curves.items()):
        if model == "meshonet-hard":  # its loss is relative to the difference from the base
            continue
        for m, run in enumerate(runs):
            x, y = [row["seen"] for row in run], [row["mean_square"] for row in run]
            axes.semilogy(x, y, color=f"C{k}", alpha=0.9 if m == 0 else 0.4, label=model if m == 0 else None)
    axes.set(xlabel="shapes seen", ylabel="mean square error (interior + boundary)")
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=110, metadata={"Software": None})
    plt.close(figure)


def times(results: Path) -> str:
    """Return the refinement table: seconds from boundary to grid, the paper's beside ours."""
    sizes = sorted({int(path.name.split(".")[2]) for path in results.glob("time.*.json")})
    rows = []
    for way, paper in TIMED:
        reports = {n: one(results / f"time.{way}.{n}.json") for n in sizes}
        cells = [f"{result['seconds']['grid']:.4f}" if (result := reports[n]) else "-" for n in sizes]
        rows.append([words.TIMED[way], *cells])
        if paper:
            rows.append([f"{paper}, the paper's", *(words.SECONDS[paper].get(n, "-") for n in sizes)])
    return table(["method", *(f"{n}² nodes" for n in sizes)], rows) if sizes else ""


def maps(pages: Path) -> str:
    """Return a table of pictures."""
    ways = ("tfi", "pde", "meshonet", "meshonet-hard")
    rows = []
    for family in FAMILIES:
        pictures = [
            f"![{family}]({family}.{way}.png)" if (pages / f"{family}.{way}.png").exists() else "-"
            for way in ways
        ]
        if any(cell != "-" for cell in pictures):
            rows.append([family, *pictures])
    return table(["", "TFI", "PDE", "MeshONet, boundary pasted", "MeshONet-hard"], rows) if rows else ""


if __name__ == "__main__":
    main()
