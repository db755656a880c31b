"""Deforms a grid to new walls and measures the result."""

from collections.abc import Mapping

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.threads import limited_to
from meshonet.solvers.deformation.deform import deform
from meshonet.solvers.deformation.request import DeformRequest
from meshonet.solvers.deformation.targets import NewWall
from meshonet.solvers.pipeline.result import Result, judged
from meshonet.solvers.stages import reached

_REMEDY = "go part of the way first, or make the grid of the new shape anew"  # where cells fold


def make_deformed(
    grid: Grid, walls: Mapping[str, NewWall] | NewWall, request: DeformRequest | None = None
) -> Result:
    """Return `grid` deformed to the new walls `walls`, with its quality.

    Raises InputError: see `meshonet.solvers.deformation.deform.deform`. Raises NoValidGridError: cells are
    folded, and the request does not allow that.
    """
    request = request or DeformRequest()
    with limited_to(request.threads):
        reached("grid")
        solution = deform(grid, walls)
        return judged(solution, dict(solution.seconds), request, remedy=_REMEDY)
