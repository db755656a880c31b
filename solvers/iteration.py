"""Checks and initial grids that iterative solvers share."""

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError


def check_settings(boundary: Boundary, tol: float | None, max_cycles: int, initial: Grid | None) -> None:
    """Raise InputError if settings of an iterative solver are invalid, or do not fit `boundary`."""
    check_tolerances(tol, max_cycles)
    if initial is not None and initial.nodes.shape[:2] != (boundary.ni, boundary.nj):
        problem = f"the initial grid has {initial.ni}x{initial.nj} nodes, not {boundary.ni}x{boundary.nj}"
        raise InputError(problem, "give equal counts", parameter="initial")


def check_tolerances(tol: float | None, max_cycles: int | None) -> None:
    """Raise InputError unless `tol` is None or between 0 and 1, and `max_cycles` None or positive."""
    if tol is not None and not 0 < tol < 1:
        raise InputError(f"tolerance {tol:g} is not between 0 and 1", "use e.g. 1e-5", parameter="tol")
    if max_cycles is not None and max_cycles < 1:
        raise InputError(f"{max_cycles} cycles are too few", "allow at least 1", parameter="max_cycles")


def initial_nodes(boundary: Boundary, initial: Grid) -> Floats:
    """Return a planar copy of the nodes of `initial`, with the edges of `boundary`."""
    nodes = initial.nodes.copy(order="K")
    put_edges(nodes, boundary)
    return nodes


def put_edges(nodes: Floats, boundary: Boundary) -> None:
    """Copy the edges of `boundary` into `nodes` (ni, nj, 2), and close the seam of an O grid, in place."""
    nodes[:, 0], nodes[:, -1] = boundary.south, boundary.north
    if boundary.periodic:
        nodes[-1] = nodes[0]
    else:
        nodes[0], nodes[-1] = boundary.west, boundary.east
