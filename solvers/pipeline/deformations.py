"""Deforms a grid to new walls and measures the result."""

from collections.abc import Mapping
from dataclasses import dataclass

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.threads import limited_to
from meshonet.solvers.deformation.deform import deform
from meshonet.solvers.deformation.targets import NewWall
from meshonet.solvers.pipeline.result import Result, judged
from meshonet.solvers.stages import reached

_REMEDY = "go part of the way first, or make the grid of the new shape anew"  # where cells fold


@dataclass(frozen=True)
class DeformRequest:
    """Options of `meshonet.deform`."""

    allow_invalid: bool = False  # return the grid even if cells are folded
    percentiles: bool = False  # compute percentiles of the quality measures too
    threads: int | None = None  # number of threads of the kernels; None stands for one per core


def make_deformed(
    grid: Grid, walls: Mapping[str, NewWall] | NewWall, request: DeformRequest | None = None
) -> Result:
    """Return `grid`, deformed so that its walls take the new positions `walls`, with its quality.

    Raises InputError as `meshonet.solvers.deformation.deform.deform`. Raises NoValidGridError if cells are
    folded and the request does not allow that.
    """
    request = request or DeformRequest()
    with limited_to(request.threads):
        reached("grid")
        solution = deform(grid, walls)
        return judged(solution, dict(solution.seconds), request, remedy=_REMEDY)
