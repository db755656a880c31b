"""Boundaries thinned to few nodes, and the grids inside them evaluated at many.

In four-sided domains, splines through the coarse nodes are evaluated (`quad`). Around a body each line keeps
its own shape instead (`o_grid`).
"""

import numpy as np

from meshonet.geometry.arrays import Floats, Topology, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import product
from meshonet.solvers.algebraic.resample import corner_damping, quad
from meshonet.solvers.algebraic.resample.o_grid import refine_around
from meshonet.solvers.algebraic.resample.spline import between
from meshonet.solvers.iteration import put_edges


def thinned(boundary: Boundary, ni: int, nj: int) -> Boundary:
    """Return `boundary` with ni x nj nodes, at equal steps of the index of the given ones.

    A C becomes a quad: thinned, its trailing edge need not be a node.
    """
    topology: Topology = "quad" if boundary.topology == "c" else boundary.topology
    south, north = _thinned(boundary.south, ni), _thinned(boundary.north, ni)
    west, east = _thinned(boundary.west, nj), _thinned(boundary.east, nj)
    return Boundary(south, north, west, east, topology, name=boundary.name)


def refine_grid(coarse: Floats, boundary: Boundary) -> Floats:
    """Return planar nodes inside `boundary`, from a coarse grid (m, n, 2) inside its thinned edges."""
    if boundary.periodic:
        return refine_around(coarse, boundary)
    names = ("south", "north", "west", "east")
    south, north, west, east = (np.ascontiguousarray(getattr(boundary, side).T)[None] for side in names)
    planes = np.ascontiguousarray(np.moveaxis(coarse, -1, 0))[None]
    return np.moveaxis(quad.refine_quad(planes, (south, north, west, east))[0], 0, -1)


def divided(coarse: Floats, boundary: Boundary) -> Floats:
    """Return what `refine_grid` does for a quad by straight lines between coarse nodes.

    They bend at these, but cells inside a valid coarse cell are valid: folds are left only beside edges that
    bend between coarse nodes.
    """
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
