"""The blocks of the domain outside of layers: decomposed, or transferred from a similar domain."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import turned_left
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import wall_gaps
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.wall_turning import sizes_by_bend
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.spacing.gradual_sizes import graded
from meshonet.solvers.blocking.decomposition.decompose import decompose
from meshonet.solvers.blocking.decomposition.reuse import carried_over
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import mirrors_of
from meshonet.solvers.refinement.size_metric import SizeMetric
from meshonet.solvers.stages import Timings

PRICE = 0.08  # price of a block in degrees of mean deviation; a tube bank gets 70 blocks, without a price 91
TURN = np.radians(20.0)  # largest angle by which a wall turns along one cell of the quad mesh
CELLS_IN_GAP = 2.5  # so that at least two quads cross every gap
CELLS_AROUND, CELLS_ACROSS = 24.0, 30.0  # smallest, around a loop, and across a domain far from features
GRADING = 0.2  # growth of sizes along walls, and with the distance from walls, per length
CLOSE = "use a larger {growth}, a first cell half or twice as high, or open the gap there"
"""Remedy for walls, or fronts of layers, that nearly touch."""


def feature_sizes(domain: Domain) -> SizeMetric:
    """Return isotropic cell sizes that resolve curvature, corners and gaps of a domain's walls."""
    points, normals, sizes = [], [], []
    for loop in domain.loops:
        arcs, size = sizes_by_bend(loop, loop.length / CELLS_AROUND, TURN)
        size = np.minimum(size, wall_gaps(domain, loop, arcs) / CELLS_IN_GAP)
        points.append(loop.at(arcs))
        normals.append(turned_left(loop.tangent(arcs)))
        sizes.append(graded(size, arcs, loop.length, GRADING))
    size = np.concatenate(sizes)
    largest = domain.extent / CELLS_ACROSS
    return SizeMetric(np.concatenate(points), np.concatenate(normals), size, size, largest, GRADING)


def found_outside(
    rest: Domain, fronts: Collection[int], timings: Timings | None = None, symmetric: bool = True
) -> Layout:
    """Return the blocks of `rest`, a domain without its layers; loops `fronts` are outer edges of layers.

    If `symmetric`, a symmetric domain gets symmetric blocks. Raises SolverError if no blocks are found;
    InputError if two loops nearly touch.
    """
    plain = rest if symmetric and mirrors_of(rest) else replace(rest, loops=tuple(map(_smooth, rest.loops)))
    sizes = feature_sizes(plain)
    try:
        layout = decompose(plain, timings=timings, sizes=sizes, price=PRICE, symmetric=symmetric)
    except InputError as error:
        error.remedy = CLOSE
        raise
    mesh = replace(layout.mesh, domain=rest)
    return replace(layout, mesh=mesh, fronts=tuple(sorted(fronts)))


def taken_outside(layout: Layout, rest: Domain, fronts: Collection[int]) -> Layout:
    """Return `layout` transferred to the domain `rest`; its loops `fronts` are the outer edges of layers.

    Raises InputError if `layout` has layers around a loop that is not in `fronts`, or if a loop in `fronts`
    has sharp corners but no layers in `layout`. See `carried_over` for other reasons.
    """
    taken = carried_over(layout, rest)
    places = taken.mesh.places
    for number in sorted({*fronts} ^ {*taken.fronts}):
        name = ", ".join(dict.fromkeys(rest.loops[number].names))
        if number not in fronts:
            remedy = "name the same walls with {walls}, or make the layout again"
            raise InputError(f"the layout has layers around {name}", remedy, parameter="layout")
        if (places.cells[places.loop == number] > 2).any():
            remedy = "give meshonet layout the first cell too"
            problem = f"the layout has no layers around {name}, which has sharp corners"
            raise InputError(problem, remedy, parameter="layout")
    return replace(taken, fronts=tuple(sorted(fronts)))


def _smooth(loop: Loop) -> Loop:
    """Return a loop without its corners of two cells, at which nodes are placed later."""
    corners = tuple(k for k, cells in zip(loop.corners, loop.corner_cells, strict=True) if cells != 2)
    return loop if corners == loop.corners else Loop(loop.curve, corners, loop.names[:1])
