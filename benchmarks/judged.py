"""What a benchmark asks of a grid: folds, distance to a converged solution, angles beside the PDE's, time."""

import hashlib
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from kept import Kept
from numpy.typing import NDArray
from shapes import Shape

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.quality.measure import count_folded, per_cell
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.solution import Solution

Way = Callable[[Boundary], Solution]
NEAR = 1.5
"""Chords from the middle of an airfoil that count as near it."""
RIM = 0.1
"""Part of the rows along a side of a four-sided domain that counts as near it."""


def rows(kept: Kept, table: str, shapes: list[Shape], k: int, ways: Mapping[str, Way]) -> dict[str, Floats]:
    """Return for each way the figures of every shape: (shapes, 6), what `judged` returns.

    Shapes without a converged solution are left out. `k`: how many times the cells the finer of the two
    grids of the converged solution has.
    """
    results: dict[str, list[Any]] = {way: [] for way in ways}
    for shape in shapes:
        row = kept.row((table, shape.name), lambda shape=shape: _row(kept, shape, k, ways))
        for way in ways if row else ():
            results[way].append(row[way])
    return {way: np.array(figures, dtype=float) for way, figures in results.items()}


def _row(kept: Kept, shape: Shape, k: int, ways: Mapping[str, Way]) -> dict[str, list[float]] | None:
    fine = shape.make(k)
    edges = every(fine, k)
    given = hashlib.sha256(np.concatenate([fine.south, fine.north, fine.west, fine.east]).tobytes())
    goals = kept.arrays((given.hexdigest(), str(k)), lambda: converged(fine, k))
    if goals is None:
        return None
    goal, pde = goals
    best = None
    if any(way.startswith("variational") or way.startswith("**quad-general") for way in ways):
        best = variational(edges).grid.nodes
    return {way: judged(way, make, edges, best if _varied(way) else goal, pde) for way, make in ways.items()}


def every(boundary: Boundary, k: int) -> Boundary:
    """Return every k-th node of a boundary, which may cut its corners."""
    sides = {side: getattr(boundary, side)[::k] for side in ("south", "north", "west", "east")}
    return replace(boundary, **sides, patches=(), sensors=None)


def _varied(way: str) -> bool:
    return way.startswith("variational") or "quad-general" in way


def converged(fine: Boundary, k: int) -> tuple[Floats, Floats] | None:
    """Return Winslow's solution at every k-th node of `fine`, the error of second order extrapolated away.

    And the largest and the mean angle of the solver's own grid on these nodes. None where the solver fails.
    """
    try:
        one = winslow(fine, tol=1e-8).grid.nodes
        half = winslow(every(fine, 2), tol=1e-8).grid
        same = half if k == 2 else winslow(every(fine, k), tol=1e-8).grid
    except MeshonetError:
        return None
    goal = (4.0 * one[::k, ::k] - half.nodes[:: k // 2, :: k // 2]) / 3.0
    angles = per_cell(same, "max_angle")
    return goal, np.array([angles.max(), angles.mean()])


def judged(way: str, make: Way, edges: Boundary, goal: Floats | None, pde: Floats) -> list[float]:
    """Return folded cells, relative L2 to `goal` near the wall and over all, angle ratios, milliseconds."""
    begun = time.process_time()
    try:
        grid = make(edges).grid
    except MeshonetError:
        return [np.inf] * 6
    spent = time.process_time() - begun
    if goal is None:
        raise ValueError(way)
    off, near = around(edges, goal)
    miss = ((grid.nodes - goal) ** 2).sum(axis=-1)
    size = (off**2).sum(axis=-1)
    close, whole = (float(np.sqrt(miss[at].sum() / size[at].sum())) for at in (near, np.ones_like(near)))
    angles = per_cell(grid, "max_angle")
    ratios = float(angles.max() / pde[0]), float(angles.mean() / pde[1])
    return [float(count_folded(grid.nodes)), close, whole, *ratios, 1e3 * spent]


def around(edges: Boundary, goal: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Return `goal` from the middle of the shape, and which of its nodes count as near the wall."""
    if edges.periodic:
        reach = np.hypot(*(edges.south - edges.south[0]).T)
        off = goal - 0.5 * (edges.south[0] + edges.south[np.argmax(reach)])
        return off, np.hypot(off[..., 0], off[..., 1]) < NEAR * reach.max()
    near = np.ones(goal.shape[:2], bool)
    i, j = (max(1, int(RIM * count)) for count in near.shape)
    near[i:-i, j:-j] = False
    return goal - goal.mean(axis=(0, 1)), near


TABLE = (
    "| method | grids without folded cells, % | distance near the wall, median / worst "
    "| distance of all nodes, median | largest angle relative to Winslow, median / worst "
    "| mean angle relative to Winslow, median | CPU time, ms |",
    "| --- | --- | --- | --- | --- | --- | --- |",
)


def table(title: str, result: Mapping[str, Floats], message: str = "") -> str:
    """Return a table of what `rows` returned."""
    lines = [f"\n## {title}\n", *([message + "\n"] if message else []), *TABLE]
    for way, figures in result.items():
        folds, near, whole, largest, mean, spent = figures.T
        cells = (
            way,
            f"{100 * (folds == 0).mean():.1f}",
            f"{np.median(near):.1e} / {near.max():.1e}",
            f"{np.median(whole):.1e}",
            f"{np.median(largest):.4f} / {largest.max():.3f}",
            f"{np.median(mean):.4f}",
            f"{np.median(spent):.1f}",
        )
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"
