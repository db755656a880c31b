"""Variational grids by nested iteration from Winslow's solution on the coarsest level."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import SolverError
from meshonet.geometry.quality.measure import angles, count_folded, widest_cell
from meshonet.solvers.algebraic.resample.grids import divided, refine_grid, thinned
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.kinks import sweep_kinks
from meshonet.solvers.elliptic.multigrid import relax
from meshonet.solvers.energy.descent import descend, in_cells, listener_of, stiffness_of
from meshonet.solvers.energy.functional import AROUND, WAKE, Weights, value
from meshonet.solvers.energy.preconditioner import Descent
from meshonet.solvers.energy.untangle import unfold
from meshonet.solvers.iteration import check_settings, initial_nodes
from meshonet.solvers.solution import Solution, timed

COARSEST = 17  # a copy with this many nodes or fewer along a direction is the first one solved
COARSEST_AROUND = 65  # the same around a body

NEXT = 129  # largest node count along a direction of the finest coarse copy

STILL = 1e-4  # displacement that ends the iteration on the finest level, over √cells times the mean cell size

FEW = 4  # iterations on a finest level with more nodes, for quads without a tolerance

FEW_AROUND = 20, 10
"""The same for O grids, with up to `NEXT` nodes and with more, unless the value exceeds `descent.HARD`."""

FIRST_AROUND = 100  # the same on a coarser level

ROUGH = 3.0  # factor of the tolerance on intermediate levels

MOST = 1000  # iterations on a coarser level at the most
WEAKER = 3  # how often the edge length term may be made weaker, to a fourth each time
SPARE_DEGREES = 0.5  # by which a weaker term has to better Winslow's angles: finer levels take some back
EASY = 1.7  # value of the functional, 1 on squares, up to which a minimum is the only one
WEIGHTS = {"quad": Weights(), "o": AROUND, "c": WAKE}  # of the functional, by topology

RELAXED = 400  # cells up to which line relaxation alone is the quickest way to Winslow's solution
SWEEPS = 30  # sweeps there; they leave some thousandths of the change from the transfinite interpolation


@timed
def solve(
    boundary: Boundary, *, tol: float | None = None, max_cycles: int = 200, initial: Grid | None = None,
    weights: Weights | None = None,
) -> Solution:  # fmt: skip
    """Minimise the functional of `meshonet.solvers.energy.functional` over the nodes inside `boundary`.

    Nodes on the seam of an O grid move; nodes on the wake of a C grid do not. If no initial grid can be
    untangled, the result has folded cells and a note.

    Parameters
    ----------
    tol : the iteration ends if no node moves by more than `tol` times √N times the mean cell size, for N
        cells. None: 1e-4, with at most `FEW` iterations, or `FEW_AROUND` for O grids.
    max_cycles : greatest number of iterations on the finest level.
    initial : a grid with the same node counts to start from, in place of coarser grids.

    Raises InputError if `initial` has other node counts, or if `tol` or `max_cycles` is not positive.
    """
    check_settings(boundary, tol, max_cycles, initial)
    weights = weights or WEIGHTS[boundary.topology]
    still = tol if tol is not None else STILL
    if initial is None:
        full = tol is not None or boundary.around_body
        limits = max_cycles, max_cycles if full else min(max_cycles, FEW)
        few = FEW_AROUND if tol is None and boundary.periodic else None
        solved = _nested(boundary, weights, still, limits, few=few)
        if not solved[-1] and not boundary.around_body:  # the other minimum of the coarsest level
            solved = _nested(boundary, weights, still, limits, np.inf)
        nodes, weights, iterations, valid = solved
    else:
        nodes = initial_nodes(boundary, initial)
        iterations, valid = descend(nodes, weights, still, max_cycles, periodic=boundary.periodic)
    notes = () if valid else ("no valid start was found; the grid is not the minimum",)
    facts = {"method": "variational", "shape": weights.shape, "smoothness": weights.smoothness}
    grid = boundary.grid(nodes, {**facts, "cycles": iterations})
    return Solution(grid, "variational", cycles=iterations, notes=notes)


def _nested(
    boundary: Boundary, weights: Weights, still: float, limits: tuple[int, int], easy: float = EASY,
    few: tuple[int, int] | None = None,
) -> tuple[Floats, Weights, int, bool]:  # fmt: skip
    """Return nodes, their weights, iterations on the finest level, and whether the grid is valid.

    `limits` are the largest numbers of iterations on the finest level: in general, and for more than `NEXT`
    nodes; `few` are those for values below `HARD`; `easy` as in `_descended`.
    """
    periodic = boundary.periodic
    coarsest = (COARSEST if not boundary.around_body else COARSEST_AROUND), COARSEST
    levels = [thinned(boundary, boundary.ni, boundary.nj) if boundary.topology == "c" else boundary]
    while any(n > least for n, least in zip((levels[-1].ni, levels[-1].nj), coarsest, strict=True)):
        now = levels[-1].ni, levels[-1].nj
        halves = (n // 2 + 1 if n > least else n for n, least in zip(now, coarsest, strict=True))
        levels.append(thinned(levels[-1], *halves))
    levels = levels[:1] + [level for level in levels[1:] if max(level.ni, level.nj) <= NEXT]
    last = len(levels) - 1
    most, moves = (limits[0], still) if last == 0 else (MOST, ROUGH * still if periodic else still)
    first = FIRST_AROUND if last > 0 and periodic else None
    nodes, weights, iterations, valid = _coarsest(levels[-1], weights, moves, most, easy, first)
    stiffness = stiffness_of(nodes, weights) if valid and last > 0 and not periodic else None
    counts = nodes.shape[0], nodes.shape[1]
    for k in range(last - 1, -1, -1):
        coarse, nodes = nodes, refine_grid(nodes, levels[k])
        below, large = counts, max(nodes.shape) > NEXT
        counts = nodes.shape[0], nodes.shape[1]
        limit = limits[large] if k == 0 else MOST
        first = first if k > 0 else few[large] if few else None
        moves = still if k == 0 or boundary.topology == "c" else ROUGH * still
        iterations, valid = descend(
            nodes, weights, moves, limit, periodic=periodic, first=first, stiffness=stiffness
        )
        if not valid and not periodic:  # walls that nearly meet: splines swing by more than the gap
            nodes = divided(coarse, levels[k])
            iterations, valid = descend(nodes, weights, moves, limit, stiffness=stiffness)
        if valid and (large or (k == 0 and _worst_at_kink(nodes))):
            sweep_kinks(nodes, levels[k], below, only_better=True)
    return nodes, weights, iterations, valid


def _coarsest(
    boundary: Boundary, weights: Weights, still: float, most: int, easy: float, first: int | None
) -> tuple[Floats, Weights, int, bool]:
    """Return the result of `_nested` on the coarsest level, from Winslow's solution."""
    start = winslow_start(boundary)
    limits = [value + 1e-9 for value in angles(start)]
    periodic = boundary.periodic
    nodes, iterations, valid = _descended(start, weights, still, most, periodic, easy, first)
    best = nodes, weights, iterations, valid
    for k in range(WEAKER):
        if not valid or all(value <= limit for value, limit in zip(angles(nodes), limits, strict=True)):
            return nodes, weights, iterations, valid
        if k == 0:
            limits[0] -= SPARE_DEGREES
        weights = replace(weights, smoothness=0.25 * weights.smoothness)
        nodes = nodes.copy(order="K")
        more, valid = descend(nodes, weights, still, most, periodic=periodic, first=first)
        iterations += more
    return best


def winslow_start(boundary: Boundary) -> Floats:
    """Return nodes (ni, nj, 2) that are approximately Winslow's solution inside `boundary`.

    If the discrete equations have no solution, return the transfinite interpolation, which may be folded.
    """
    if not boundary.around_body and (boundary.ni - 1) * (boundary.nj - 1) <= RELAXED:
        nodes = tfi(boundary).nodes
        relax(nodes, SWEEPS)
        if np.isfinite(nodes).all():
            return nodes
    from meshonet.solvers.elliptic.solve import solve as winslow

    try:
        return winslow(boundary, tol=1e-3, initial=tfi(boundary)).grid.nodes
    except SolverError:
        return tfi(boundary).nodes


def _descended(
    start: Floats, weights: Weights, still: float, most: int, periodic: bool, easy: float, first: int | None
) -> tuple[Floats, int, bool]:
    """Return the minimum from `start` on the coarsest level, the iterations, and whether it is valid.

    A folded start is untangled as a whole; if its value is then above `easy`, also locally, and the lower of
    both minima is returned.
    """
    nodes = start.copy(order="K")
    if periodic or count_folded(start) == 0:
        return nodes, *descend(nodes, weights, still, most, periodic=periodic, first=first)
    least, low, iterations = np.inf, 0.0, 0
    if unfold(nodes, weights)[0]:
        descent, moves = Descent(nodes, weights), in_cells(still, start)
        least, low, iterations = descent.run(moves, most, listener=listener_of(nodes))
    if least <= easy:
        return nodes, iterations, low > 0
    repaired = start.copy(order="K")
    more, valid = descend(repaired, weights, still, most)
    if valid and value(repaired, weights) < least:
        return repaired, more, True
    return nodes, iterations, low > 0


def _worst_at_kink(nodes: Floats) -> bool:
    """Return whether the cell with the largest angle is at the boundary but not in a corner of it."""
    at = widest_cell(nodes)
    ends = [at[axis] in {0, nodes.shape[axis] - 2} for axis in (0, 1)]
    return ends[0] != ends[1]
