"""The guard: repairs a folded grid, makes it by another method, or rejects it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import NoValidGridError, SolverError
from meshonet.geometry.quality.measure import count_folded, worst_cells
from meshonet.solvers.pipeline.named import method_named
from meshonet.solvers.solution import Outcome, Solution

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.methods import Method

ORDER = ("winslow", "tfi")  # methods that follow where a grid cannot be repaired

REMEDY = "use more nodes, another topology or corners, or allow an invalid grid"  # where all ways fold


def guard(
    solution: Solution, boundary: Boundary, *, allow_invalid: bool = False, margin: int | None = None
) -> Solution:
    """Return `solution` if its grid has no folded cells, otherwise the first valid grid of these stages.

    First, regions of `margin` cells around folded cells are repaired. Then each method of `ORDER` makes a
    grid, which is repaired too. The field `path` of the result ends with the stages that made the grid, such
    as ``("winslow", "repair")``. `boundary` is used if `solution` has none. If all stages leave folded cells,
    raises NoValidGridError with the ten worst cells; with `allow_invalid`, returns `solution` instead.
    """
    grid, boundary = solution.grid, solution.boundary or boundary
    if count_folded(grid.nodes) == 0:
        return solution
    failure = _open_corner(grid)
    if failure is None:
        least = grid.nodes
        # Winslow's equations are not solved again for their own grid
        others = [method_named(name) for name in ORDER if name != solution.method or name == "tfi"]
        for path, nodes in _ways(grid, boundary, others, margin):
            if count_folded(nodes) == 0:
                facts = {**grid.provenance, "path": path}
                mended = Grid.from_nodes(nodes, grid.topology, grid.patches, grid.name, facts)
                return replace(solution, grid=mended, path=(*solution.path, *path))
            least = min(least, nodes, key=count_folded)
        left, cells = count_folded(least), (grid.ni - 1) * (grid.nj - 1)
        tried = ", then ".join(["repair", *(method.name for method in others)])
        problem = f"{left} of {cells} cells stay folded after {tried}; {REMEDY}"
        failure = NoValidGridError(problem, worst_cells(least))
    if allow_invalid:
        return replace(solution, outcome=Outcome.FOLDED)
    raise failure


def _ways(
    grid: Grid, boundary: Boundary, others: Sequence[Method], margin: int | None
) -> Iterator[tuple[tuple[str, ...], Floats]]:
    from meshonet.solvers.energy.repair import MARGIN, repair

    margin = margin or MARGIN
    periodic = grid.periodic
    repaired = grid.nodes.copy(order="K")
    repair(repaired, periodic, margin)
    yield ("repair",), repaired
    start = boundary.grid(repaired)
    for method in others:
        try:
            nodes = method.solve([boundary], [start])[0].grid.nodes
        except SolverError:
            continue
        yield (method.name,), nodes
        nodes = nodes.copy(order="K")
        repair(nodes, periodic, margin)
        yield (method.name, "repair"), nodes


def _open_corner(grid: Grid) -> NoValidGridError | None:
    """Return the error for a quad domain with a corner of 180 degrees or more, which has no valid grid."""
    if grid.around_body:
        return None
    for i, di in ((0, 1), (grid.ni - 1, -1)):
        for j, dj in ((0, 1), (grid.nj - 1, -1)):
            at = grid.nodes[i, j]
            (ux, uy), (vx, vy) = grid.nodes[i + di, j] - at, grid.nodes[i, j + dj] - at
            if di * dj * (ux * vy - uy * vx) <= 0:
                from meshonet.geometry.quality.bad_cell import BadCell

                x, y = (float(value) for value in at)
                problem = f"the boundary's corner at ({x:.6g}, {y:.6g}) opens by 180 degrees or more"
                cell = BadCell(min(i, grid.ni - 2), min(j, grid.nj - 2), x, y)
                return NoValidGridError(f"{problem}; choose other corners", [cell])
    return None
