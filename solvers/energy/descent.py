"""Minimisation of the variational functional from given nodes, which are made valid first."""

from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import modulus, times
from meshonet.geometry.quality.measure import count_folded
from meshonet.kernels._native import Stiffness
from meshonet.kernels._native import newton as newton_steps
from meshonet.solvers.algebraic.resample.spline import spline_matrix
from meshonet.solvers.energy.clusters import windows
from meshonet.solvers.energy.functional import Weights, aspect_of, relief_of
from meshonet.solvers.energy.preconditioner import Descent
from meshonet.solvers.energy.repair import repair
from meshonet.solvers.energy.untangle import STILL, unfold
from meshonet.solvers.progress import cycle_ended, listened_to

HARD = 1.1  # value of the functional around a body above which descents go on
WON = 3e-2  # relative decrease of the functional below which Newton's method ends

UNFOLDED = 129
"""Largest node count along a direction for which a grid is untangled as a whole if local repair fails."""
SKEWED = 1.5  # 1/sin⁴ of an angle, here 65 or 115 degrees, from which on a cell has a window around it
MARGIN_CELLS = 6  # cells around a group of skewed ones that move with them
LARGEST_CELLS = 1500  # cells of a window at the most
ITERATIONS = 30  # in a window at the most


def descend(
    nodes: Floats, weights: Weights, still: float, most: int, *, periodic: bool = False,
    first: int | None = None, stiffness: tuple[Stiffness, tuple[int, int]] | None = None,
) -> tuple[int, bool]:  # fmt: skip
    """Minimise the variational functional from planar `nodes` (ni, nj, 2), in place; unfold cells first.

    Returns the number of iterations, and whether no cell is folded. `still` is the tolerance `tol` of
    `variational.solve`. The minimisation ends after `most` iterations at the latest. It goes on after `first`
    iterations only if the functional is then above `HARD`, 1.1. If `periodic`, the grid is around a body, and
    ``nodes[-1]`` repeats ``nodes[0]``. `stiffness`, a result of `stiffness_of`, is used as a preconditioner.
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
    """Take up to `most` Newton steps from planar `nodes` (ni, nj, 2) of a four-sided grid; return how many.

    The iteration ends after a step that lowers the functional by less than the fraction `WON`. If folded
    cells cannot be repaired, no step is taken.
    """
    if min(nodes.shape[:2]) < 3 or (count_folded(nodes) and repair(nodes, periodic=False)):
        return 0
    z = np.moveaxis(nodes, -1, 0)
    return newton_steps(z, aspect_of(nodes), weights.shape, weights.smoothness, most, WON)


def stiffness_of(nodes: Floats, weights: Weights) -> tuple[Stiffness, tuple[int, int]] | None:
    """Return (the variational functional's Hessian at `nodes`, node counts), or None if cells are folded."""
    if count_folded(nodes):
        return None
    hessian = Stiffness(np.moveaxis(nodes, -1, 0), aspect_of(nodes), weights.shape, weights.smoothness)
    return (hessian, (nodes.shape[0], nodes.shape[1])) if hessian.usable else None


def listener_of(nodes: Floats) -> Callable[[int, float, float], None] | None:
    """Return a function that reports each iteration on `nodes` to listeners; None without listeners."""
    if not listened_to():
        return None
    first = 0.0

    def listener(number: int, value: float, slope: float) -> None:
        nonlocal first
        first = slope if number == 0 else first
        cycle_ended("variational", nodes, number, slope / first if first else 0.0, functional=value)

    return listener


def in_cells(tolerance: float, nodes: Floats) -> float:
    """Return `tolerance`, a fraction of the domain's size, in cell sizes: multiplied by √N for N cells."""
    return tolerance * float(np.sqrt((nodes.shape[0] - 1) * (nodes.shape[1] - 1)))


def _made_valid(nodes: Floats, weights: Weights, periodic: bool) -> bool:
    """Repair planar `nodes` in place, locally or else as a whole; return whether they are valid."""
    if repair(nodes, periodic) == 0:
        return True
    small = not periodic and max(nodes.shape[:2]) <= UNFOLDED
    return small and unfold(nodes, weights)[0]


def descend_windows(nodes: Floats, aspect: float, weights: Weights, relief: Floats) -> None:
    """In an O grid `nodes` (ni, nj, 2), unfold and optimise skewed cells and the cells near them, in place.

    `aspect` and `relief` are the results of `aspect_of` and `relief_of` for the grid.
    """
    skewed = corner_distortion(nodes)
    poor = np.argwhere(skewed > SKEWED)
    if 2 * len(poor) > skewed.size:
        poor = np.argwhere(skewed == np.inf)
    if len(poor) == 0:
        return
    for window in windows(poor, MARGIN_CELLS, nodes.shape[:2], True, LARGEST_CELLS):
        patch = window.cut(nodes, True)
        m, n = patch.shape[:2]
        if min(m, n) < 3:
            continue
        if count_folded(patch) and not unfold(patch, weights, aspect=aspect)[0]:
            continue
        eased = relief[window.rows(len(nodes), True)] if window.first[1] == 0 else None
        still = STILL * float(np.sqrt((m - 1) * (n - 1)))
        Descent(patch, weights, aspect=aspect).run(still, ITERATIONS, relief=eased)
        window.put(nodes, True, patch)


def corner_distortion(nodes: Floats) -> Floats:
    """Return for each cell of `nodes` (ni, nj, 2) the greatest 1/sin⁴ of its angles; infinite if folded."""
    z = nodes[..., 0] + 1j * nodes[..., 1]
    along, across = np.diff(z, axis=0), np.diff(z, axis=1)
    g, h = modulus(along), modulus(across)
    least = np.full((len(z) - 1, z.shape[1] - 1), np.inf)
    for south in (slice(None, -1), slice(1, None)):
        for west in (slice(None, -1), slice(1, None)):
            area = times(np.conj(along[:, south]), across[west]).imag
            np.minimum(least, area / np.maximum(g[:, south] * h[west], 1e-300), out=least)
    with np.errstate(divide="ignore"):
        return np.asarray((1.0 / np.where(least > 0.0, least, 0.0) ** 2) ** 2)
