"""Coarsening of boundaries, and interpolation of coarse grids (`quad`, `o_grid`)."""

import numpy as np

from meshonet.geometry.arrays import Floats, Topology, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.solvers.algebraic.resample import corner_damping, quad
from meshonet.solvers.algebraic.resample.o_grid import refine_around
from meshonet.solvers.algebraic.resample.spline import between
from meshonet.solvers.iteration import put_edges

LEAST_NODES = 9  # fewest coarse nodes along a direction that describe anything


def check_coarse(n: int) -> None:
    """Raise InputError if a coarse grid with `n` nodes along a direction is too coarse."""
    if n < LEAST_NODES:
        raise InputError(f"{n} coarse nodes along a direction are too few", f"use at least {LEAST_NODES}")


def thinned(boundary: Boundary, ni: int, nj: int) -> Boundary:
    """Return `boundary` with ni x nj nodes, interpolated linearly at equal steps of the node index.

    A C boundary becomes a quad boundary, since its trailing edge need not be one of the new nodes.
    """
    topology: Topology = "quad" if boundary.topology == "c" else boundary.topology
    south, north = _thinned(boundary.south, ni), _thinned(boundary.north, ni)
    west, east = _thinned(boundary.west, nj), _thinned(boundary.east, nj)
    return Boundary(south, north, west, east, topology, name=boundary.name)


def refine_grid(coarse: Floats, boundary: Boundary) -> Floats:
    """Return nodes (ni, nj, 2) inside `boundary`, interpolated by splines from a `coarse` grid (m, n, 2).

    The coarse grid must have the boundary that `thinned` returns.
    """
    if boundary.periodic:
        return refine_around(coarse, boundary)
    names = ("south", "north", "west", "east")
    south, north, west, east = (np.ascontiguousarray(getattr(boundary, side).T)[None] for side in names)
    planes = np.ascontiguousarray(np.moveaxis(coarse, -1, 0))[None]
    return np.moveaxis(quad.refine_quad(planes, (south, north, west, east))[0], 0, -1)


def divided(coarse: Floats, boundary: Boundary) -> Floats:
    """Return nodes (ni, nj, 2) inside `boundary`, interpolated linearly from a `coarse` grid (m, n, 2)."""
    nodes = planar_nodes(boundary.ni, boundary.nj)
    along, across = (
        corner_damping.linear(len(coarse), boundary.ni),
        corner_damping.linear(coarse.shape[1], boundary.nj),
    )
    for c in (0, 1):
        nodes[..., c] = product(product(along, coarse[..., c]), across.T)
    put_edges(nodes, boundary)
    return nodes


def _thinned(edge: Floats, n: int) -> Floats:
    return np.asarray(between(edge.T, n).T)
