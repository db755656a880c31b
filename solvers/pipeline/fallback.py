"""No folded grid leaves here unseen: repair it, or make another, or say that it cannot be done."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import BadCell, NoValidGridError, SolverError
from meshonet.geometry.quality.measure import count_folded, worst_cells

REMEDY = "use more nodes, another topology or corners, or allow an invalid grid"

Stage = tuple[str, Callable[[], Floats]]


def guard(
    grid: Grid, boundary: Boundary, *, allow_invalid: bool = False, margin: int | None = None
) -> tuple[Grid, tuple[str, ...]]:
    """Return a valid grid inside `boundary`: `grid` when it is one, else the first way out that works.

    Tried in turn: local repair of `grid`; Winslow's solution from that start; transfinite interpolation;
    each of the latter repaired where it is folded.

    Parameters
    ----------
    grid : what a solver made.
    boundary : what it was made for.
    allow_invalid : return `grid` as it is when nothing works.
    margin : of `meshonet.solvers.energy.repair.repair`, or None for its own.

    Returns
    -------
    tuple
        the grid, and the stages that made it from what came in: ``()``, ``("repair",)``,
        ``("winslow", "repair")``, ``("tfi",)`` ...

    Raises
    ------
    NoValidGridError
        every way ends in folded cells; carries the count and the ten worst of the best try.
    """
    if count_folded(grid.nodes) == 0:
        return grid, ()
    failure = _open_corner(grid)
    if failure is None:
        least = grid.nodes
        for path, nodes in _ways(grid, boundary, margin):
            if count_folded(nodes) == 0:
                facts = {**grid.provenance, "path": path}
                return Grid.from_nodes(nodes, grid.topology, grid.patches, grid.name, facts), path
            least = min(least, nodes, key=count_folded)
        left, cells = count_folded(least), (grid.ni - 1) * (grid.nj - 1)
        told = f"{left} of {cells} cells stay folded after repair, winslow and tfi; {REMEDY}"
        failure = NoValidGridError(told, worst_cells(least))
    if allow_invalid:
        return grid, ()
    raise failure


def _ways(grid: Grid, boundary: Boundary, margin: int | None) -> Iterator[tuple[tuple[str, ...], Floats]]:
    """Yield the stages and nodes of one try after another; a valid one ends the search."""
    from meshonet.solvers.energy.repair import MARGIN, repair

    margin = margin or MARGIN
    periodic = grid.topology == "o"
    repaired = grid.nodes.copy(order="K")
    repair(repaired, periodic, margin)
    yield ("repair",), repaired
    starts: list[Stage] = [("tfi", partial(_interpolated, boundary))]
    if grid.provenance.get("method") != "winslow":
        starts.insert(0, ("winslow", partial(_solved, boundary, repaired)))
    for name, make in starts:
        try:
            nodes = make()
        except SolverError:
            continue
        yield (name,), nodes
        nodes = nodes.copy(order="K")
        repair(nodes, periodic, margin)
        yield (name, "repair"), nodes


def _solved(boundary: Boundary, start: Floats) -> Floats:
    from meshonet.solvers.elliptic.solve import solve

    return solve(boundary, initial=boundary.grid(start)).grid.nodes


def _interpolated(boundary: Boundary) -> Floats:
    from meshonet.solvers.algebraic.tfi import tfi

    return tfi(boundary).nodes


def _open_corner(grid: Grid) -> NoValidGridError | None:
    """Return the failure when a corner of a quad opens by 180 degrees or more: no grid is valid then."""
    if grid.topology != "quad":
        return None
    for i, di in ((0, 1), (grid.ni - 1, -1)):
        for j, dj in ((0, 1), (grid.nj - 1, -1)):
            at = grid.nodes[i, j]
            (ux, uy), (vx, vy) = grid.nodes[i + di, j] - at, grid.nodes[i, j + dj] - at
            if di * dj * (ux * vy - uy * vx) <= 0:
                x, y = (float(value) for value in at)
                told = f"the boundary's corner at ({x:.6g}, {y:.6g}) opens by 180 degrees or more"
                cell = BadCell(min(i, grid.ni - 2), min(j, grid.nj - 2), x, y)
                return NoValidGridError(f"{told}; choose other corners", [cell])
    return None
