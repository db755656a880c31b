"""Sections carried along paths: the planar grid is made, swept and measured."""

from __future__ import annotations

import time

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.curves.path import Path
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.threads import limited_to
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.result import Result, judged
from meshonet.solvers.pipeline.sections import section_grid
from meshonet.solvers.solution import Solution
from meshonet.solvers.stages import reached
from meshonet.solvers.sweeping.sweep import Sweep, reach_of, self_crossing, sweep

_REMEDY = "use a wider bend, a smaller section or more {planes}"  # where cells fold


def make_sweep(
    shape: Shape | Grid, path: Path, request: GridRequest, settings: Sweep | None = None,
    around: int | None = None,
) -> Result:  # fmt: skip
    """Return the volume of a cross-section carried along a path, measured.

    `request` and `around` say how the planar grid of the section is made (`section_grid`).

    Raises InputError: parameters, section and path do not go together; NoValidGridError: cells are
    folded, and that was not allowed.
    """
    seconds: dict[str, float] = {}
    with limited_to(request.threads):
        begun = time.perf_counter()
        section, notes = section_grid(shape, request, around)
        seconds["boundary"] = time.perf_counter() - begun
        reached("grid")
        begun = time.perf_counter()
        grid = sweep(section, path, settings)
        crossing = self_crossing(path, reach_of(section))
        if crossing is not None:
            where = "({:.4g}, {:.4g}, {:.4g})".format(*crossing)
            notes = (
                *notes,
                f"the path comes back near itself: the volume may run through itself near {where}",
            )
        seconds["grid"] = time.perf_counter() - begun
        solution = Solution(grid, "sweep", notes=notes)
        return judged(solution, seconds, request, remedy=_REMEDY)
