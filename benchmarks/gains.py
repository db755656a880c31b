"""Tables of the quad network's benchmarks: what ways gain over Winslow's angles, how far off they are.

Folds are counted before the guard; times are processor seconds of one thread, in one run.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np
from clock import clocked
from kept import ROOT

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded, measure
from meshonet.solvers.neural.registry import load
from meshonet.solvers.solution import Solution

Way = Callable[[Boundary], Solution]

ANGLES = (
    "| method | valid, % | largest angle, degrees | mean angle, degrees | gain in mean angle, % "
    "| CPU time per grid, ms |",
    6 * "| --- " + "|",
)
DISTANCES = (
    "| method | distance, median | distance, 90th percentile | CPU time per grid, ms |",
    4 * "| --- " + "|",
)


def operate(model: str, polish: int, boundary: Boundary) -> Solution:
    """Return the solution of `boundary` alone by a quad model."""
    return load(model).solve([boundary], polish)[0]


def figures(way: Way, boundary: Boundary) -> tuple[float, float, float, float]:
    """Return folded cells, largest angle, mean angle and processor seconds."""
    spent, solution = clocked(partial(way, boundary))
    grid = solution.grid
    summary = measure(grid)["max_angle"]
    return count_folded(grid.nodes), summary.max, summary.mean, spent


def gains(title: str, boundaries: Sequence[Boundary], ways: Mapping[str, Way]) -> str:
    """Return the table of folds, angles and gains of `ways`, ``Winslow`` and ``variational`` among them."""
    table = {name: np.array([figures(way, one) for one in boundaries]) for name, way in ways.items()}
    before, best = table["Winslow"], table["variational"]
    valid = before[:, 0] == 0
    lines = [f"\n## {title}\n", *ANGLES]
    for name, rows in table.items():
        folds, largest, mean, spent = rows.T
        gain = (before - rows)[valid, 2].sum() / (before - best)[valid, 2].sum()
        lines.append(
            f"| {name} | {percent(folds == 0)} | {largest.mean():.1f} | {mean.mean():.2f} "
            f"| {100 * gain:.0f} | {1e3 * np.median(spent):.1f} |"
        )
    return "\n".join(lines)


def distances(
    title: str, boundaries: Sequence[Boundary], goals: Sequence[Grid], ways: Mapping[str, Way]
) -> str:
    """Return the table of distances to the converged Winslow grids `goals`."""
    lines = [f"\n## Distance to Winslow's solution, {title}\n", *DISTANCES]
    for name, way in ways.items():
        errors, spent = [], []
        for boundary, goal in zip(boundaries, goals, strict=True):
            seconds, solution = clocked(partial(way, boundary))
            spent.append(seconds)
            errors.append(compare(solution.grid, goal).relative_l2)
        median, high = np.quantile(errors, (0.5, 0.9))
        lines.append(f"| {name} | {median:.1e} | {high:.1e} | {1e3 * np.median(spent):.1f} |")
    return "\n".join(lines)


def percent(where: Floats) -> str:
    """Return the share of a mask in percent."""
    return f"{100 * where.mean():.1f}"


def published(name: str) -> str:
    """Return the median error of a paper model by docs/benchmarks/paper/results, and how many grids fold."""
    path = ROOT / "docs" / "benchmarks" / "paper" / "results" / f"{name}.json"
    if not path.exists():
        return "not run"
    report = json.loads(path.read_text())["summary"]
    return f"{report['relative_l2']['median']:.1e} ({report['folded']['members']})"
