"""One descent of the functional: from given nodes, made valid first, to where they hardly move.

The iterations themselves are compiled: preconditioned L-BFGS and, for few nodes, Newton's method.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.measure import count_folded
from meshonet.kernels._native import Stiffness
from meshonet.kernels._native import newton as newton_steps
from meshonet.solvers.algebraic.resample.spline import spline_matrix
from meshonet.solvers.energy.functional import Weights, aspect_of, relief_of
from meshonet.solvers.energy.local_descent import descend_windows
from meshonet.solvers.energy.preconditioner import Descent
from meshonet.solvers.energy.repair import repair
from meshonet.solvers.energy.untangle import unfold
from meshonet.solvers.progress import cycle_ended, listened_to

HARD = 1.1  # value of the functional around a body above which descents go on
WON = 3e-2  # relative decrease of the functional below which Newton's method ends

UNFOLDED = 129
"""Nodes along a direction up to which a grid that local repair leaves folded is unfolded as a whole."""


def descend(
    nodes: Floats,
    weights: Weights,
    still: float,
    most: int,
    *,
    periodic: bool = False,
    first: int | None = None,
    stiffness: tuple[Stiffness, tuple[int, int]] | None = None,
) -> tuple[int, bool]:
    """Minimise from planar `nodes` (ni, nj, 2) in place; return the iterations and whether the grid is valid.

    Parameters
    ----------
    still : as `tol` of `solve`.
    most : iterations at the most.
    periodic : around a body: the last row of nodes is the first, and its nodes move like any others. Before
        all others those of windows around skewed cells do (`windowed`).
    first : end after so many iterations where the value is not `HARD` then.
    stiffness : the Hessian on a coarse copy and its counts, which leads smooth moves.
    """
    ni, nj = nodes.shape[:2]
    if min(ni, nj) < 3:
        return 0, count_folded(nodes) == 0
    aspect = aspect_of(nodes, periodic)
    relief = relief_of(nodes[:, 0]) if periodic else None
    descent = Descent(nodes, weights, periodic, aspect)
    if stiffness is not None:
        hessian, (m, n) = stiffness
        descent.minimiser.steer(hessian, spline_matrix(m, ni)[1:-1, 1:-1], spline_matrix(n, nj)[1:-1, 1:-1])
    if relief is not None:
        descend_windows(nodes, aspect, weights, relief)
    if count_folded(nodes) and not _made_valid(nodes, weights, periodic):
        return 0, False
    moves, listener = in_cells(still, nodes), listener_of(nodes)
    begin = most if first is None else min(first, most)
    value, _, done = descent.run(moves, begin, relief=relief, listener=listener)
    if begin <= done < most and value > HARD:
        done += descent.run(moves, most - done, relief=relief, listener=listener)[2]
    return done, True


def newton(nodes: Floats, weights: Weights, most: int) -> int:
    """Take steps of Newton's method from planar `nodes` (ni, nj, 2) of a quad, in place; return how many.

    A step goes much farther than one of `descend`; on 33 x 33 nodes it costs some six of these. From nodes
    that local repair leaves folded none is taken.

    `most`: steps at the most. They end after one that lowers the functional by less than `WON` of it.
    """
    if min(nodes.shape[:2]) < 3 or (count_folded(nodes) and repair(nodes, periodic=False)):
        return 0
    z = np.moveaxis(nodes, -1, 0)
    return newton_steps(z, aspect_of(nodes), weights.shape, weights.smoothness, most, WON)


def stiffness_of(nodes: Floats, weights: Weights) -> tuple[Stiffness, tuple[int, int]] | None:
    """Return the Hessian at planar `nodes` of few counts, and these, for `descend`; None if folded."""
    if count_folded(nodes):
        return None
    hessian = Stiffness(np.moveaxis(nodes, -1, 0), aspect_of(nodes), weights.shape, weights.smoothness)
    return (hessian, (nodes.shape[0], nodes.shape[1])) if hessian.usable else None


def listener_of(nodes: Floats) -> Callable[[int, float, float], None] | None:
    """Return what calls listeners after iterations that move `nodes` (ni, nj, 2), None without listeners."""
    if not listened_to():
        return None
    first = 0.0

    def listener(number: int, value: float, slope: float) -> None:
        nonlocal first
        first = slope if number == 0 else first
        cycle_ended("variational", nodes, number, slope / first if first else 0.0, functional=value)

    return listener


def in_cells(still: float, nodes: Floats) -> float:
    """Return `still` in cells of planar `nodes` (ni, nj, 2)."""
    return still * float(np.sqrt((nodes.shape[0] - 1) * (nodes.shape[1] - 1)))


def _made_valid(nodes: Floats, weights: Weights, periodic: bool) -> bool:
    """Unfold planar `nodes` in place, by local repair or else as a whole; return success."""
    if repair(nodes, periodic) == 0:
        return True
    small = not periodic and max(nodes.shape[:2]) <= UNFOLDED
    return small and unfold(nodes, weights)[0]
