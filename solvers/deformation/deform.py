"""Grids that follow a changed boundary, layers as they were.

The displacement of the boundary is carried inside by `meshonet.solvers.deformation.follow`. Where cells fold
the way is gone in steps, each a smooth map of the last one's grid; where that does not suffice, folded cells
are repaired, and then all nodes but those of layers optimised.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.geometry.quality.measure import count_folded, worst_cells_of
from meshonet.solvers.deformation.follow import Follow, sliding_notes
from meshonet.solvers.deformation.outer import NodeTable
from meshonet.solvers.deformation.targets import NewWall, Targets, first_heights, targets_of
from meshonet.solvers.solution import Outcome, Solution

METHOD = "deformation"
STEPS = 1, 2, 4, 8
"""In how many steps the way is gone, tried in turn while cells are folded."""


def deform(grid: Grid, walls: Mapping[str, NewWall] | NewWall) -> Solution:
    """Return `grid` with `walls` in their new places, and notes of what was done.

    Raises InputError: a surface, a starting grid with folded cells, a wall that the grid does not have or
    what cannot be its new shape.
    """
    begun = time.perf_counter()
    table = NodeTable.of(grid)
    folded = _folded(grid)
    if folded:
        where = worst_cells_of(grid, 1)[0]
        raise InputError(f"{folded} cells of the starting grid are folded, ({where})", "give a valid grid")
    targets = targets_of(table, walls)
    made, path = _made(table, targets)
    outcome = Outcome.FOLDED if _folded(made) else Outcome.DONE
    notes = (*targets.notes, *sliding_notes(table, targets), _layers(grid, made, targets))
    made = made.with_provenance(method=METHOD, walls=",".join(targets.names))
    seconds = {"grid": time.perf_counter() - begun}
    return Solution(made, METHOD, path=path, notes=notes, outcome=outcome, seconds=seconds)


def _folded(grid: Grid) -> int:
    return sum(count_folded(block.nodes) for block in grid.blocks)


def _made(table: NodeTable, targets: Targets) -> tuple[Grid, tuple[str, ...]]:
    """Return the first grid without folded cells, or that with the fewest, and the stages it took."""
    best: tuple[int, Grid, tuple[str, ...]] | None = None
    for made, path in _ways(table, targets):
        left = _folded(made)
        if best is None or left < best[0]:
            best = left, made, path
        if not left:
            break
    assert best is not None
    return best[1:]


def _ways(table: NodeTable, targets: Targets) -> Iterator[tuple[Grid, tuple[str, ...]]]:
    made = table.grid
    for steps in STEPS:
        made = _in_steps(table, targets, steps)
        yield made, (f"{steps} steps",) if steps > 1 else ()
    yield from _mended(made)


def _in_steps(table: NodeTable, targets: Targets, steps: int) -> Grid:
    """Return the grid after so many equal steps."""
    way, now = targets.nodes - table.nodes, table
    for number in range(1, steps + 1):
        to = targets.nodes if number == steps else table.nodes + way * (number / steps)
        nodes = Follow.of(now, targets.moved).nodes_to(to)
        now = replace(now, nodes=nodes, grid=replace(table.grid, blocks=now.with_nodes(nodes)))
    return now.grid


def _mended(grid: Grid) -> Iterator[tuple[Grid, tuple[str, ...]]]:
    """Yield `grid`, which has folded cells, repaired around them, and with all but layers optimised."""
    if grid.form == "plane" and len(grid.blocks) == 1:
        from meshonet.solvers.energy.repair import repair

        nodes = grid.nodes.copy(order="K")
        repair(nodes, grid.periodic)
        yield grid.with_nodes(nodes, finite=True), ("repair",)
    with contextlib.suppress(MeshonetError):
        if grid.form == "plane":
            from meshonet.solvers.smoothing.smooth import smooth

            yield smooth(grid).grid, ("smoothing",)
        else:
            from meshonet.solvers.smoothing.volumes import smooth as smooth_volumes

            yield smooth_volumes(grid).grid, ("smoothing",)


def _layers(before: Grid, after: Grid, targets: Targets) -> str:
    """Return a note of the largest change of a first cell's height at the moved walls."""
    old, new = (first_heights(grid, targets.names) for grid in (before, after))
    change = float(np.abs(new / old - 1.0).max())
    return f"first cells at {', '.join(targets.names)}: heights changed by at most {100 * change:.2g} %"
