"""Grids that follow their walls: deformed and measured."""

from __future__ import annotations

from collections.abc import Mapping

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.threads import limited_to
from meshonet.solvers.deformation.deform import deform
from meshonet.solvers.deformation.targets import NewWall
from meshonet.solvers.pipeline.make_grid import Result, judged

_REMEDY = "go part of the way first, or make the grid of the new shape anew"


def make_deformed(
    grid: Grid, walls: Mapping[str, NewWall] | NewWall, *, allow_invalid: bool = False,
    percentiles: bool = False, threads: int | None = None,
) -> Result:  # fmt: skip
    """Return `grid` with its walls in their new places, measured.

    Raises InputError: see `meshonet.solvers.deformation.deform.deform`; NoValidGridError: cells are folded,
    which is not allowed.
    """
    with limited_to(threads):
        solution = deform(grid, walls)
        seconds = dict(solution.seconds)
        return judged(solution, seconds, percentiles=percentiles, allow_invalid=allow_invalid, remedy=_REMEDY)
