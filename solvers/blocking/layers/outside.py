"""The blocks of the domain outside of layers: decomposed, or transferred from a similar domain."""

from collections.abc import Collection
from dataclasses import replace

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.decomposition.decompose import decompose
from meshonet.solvers.blocking.decomposition.reuse import carried_over
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import mirrors_of
from meshonet.solvers.blocking.sizes.feature_sizes import feature_sizes
from meshonet.solvers.stages import Timings

PRICE = 0.08
"""Price of a block in degrees of mean deviation. With 0.03 to 0.08 a tube bank gets 70 blocks, with 0 it gets
91.
"""
CLOSE = "use a larger {growth} or a larger first cell, or open the gap there"
"""Remedy for walls, or fronts of layers, that nearly touch."""


def found_outside(
    rest: Domain, fronts: Collection[int], timings: Timings | None = None, symmetric: bool = True
) -> Layout:
    """Return the blocks of a domain; the loops with indices `fronts` are fronts (outer edges) of layers.

    If `symmetric`, a symmetric domain gets symmetric blocks.

    Raises SolverError: no blocks are found; InputError: walls or fronts nearly touch.
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

    A layout of a domain without layers can be used if its blocks have no vertex at a corner of a wall behind
    a front.

    Raises InputError: as `carried_over`; or the layout has layers around other loops.
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
    """Return a loop without the corners at which the field is not to turn: nodes are put there later."""
    corners = tuple(k for k, cells in zip(loop.corners, loop.corner_cells, strict=True) if cells != 2)
    return loop if corners == loop.corners else Loop(loop.curve, corners, loop.names[:1])
