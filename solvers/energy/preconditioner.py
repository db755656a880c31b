"""Minimisation preconditioned by the inverse Hessian of the functional on a grid of equal squares.

The Hessian is diagonal in products of sines, or around a body of sines and cosines along xi.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import Modes, VariationalDescent
from meshonet.solvers.energy.functional import Weights, aspect_of

REACH_CELLS = 0.25  # how far a node moves at the most in the first iteration of a descent
MODES = 512  # modes along a direction that are kept; finer ones are all divided by the same


class Descent:
    """Minimisation of the variational functional over planar `nodes` (ni, nj, 2), in place.

    Boundary nodes are fixed. In a `periodic` grid, around a body, ``nodes[-1]`` repeats ``nodes[0]`` and both
    move. `aspect` is the result of `aspect_of` for the grid; None computes it from `nodes`.
    """

    def __init__(
        self, nodes: Floats, weights: Weights, periodic: bool = False, aspect: float | None = None
    ) -> None:
        self._z = np.moveaxis(nodes, -1, 0)
        aspect = aspect or aspect_of(nodes, periodic)
        self._terms = aspect, weights.shape, weights.smoothness
        self.minimiser = minimiser(nodes.shape[0], nodes.shape[1], periodic, aspect, weights)

    def run(
        self, still: float, most: int, *, epsilon: float = 0.0, relief: Floats | None = None,
        listener: Callable[[int, float, float], None] | None = None,
    ) -> tuple[float, float, int]:  # fmt: skip
        """Minimise; return the functional, the smallest corner Jacobian and the number of iterations.

        The iteration ends if nodes move by less than `still` cell sizes, or after `most` iterations. The area
        `epsilon` regularises Jacobians. `relief` (ni,), from `relief_of`, reduces the functional at walls.
        `listener` gets iteration number, value and gradient norm, before the first and after each iteration.
        """
        return self.minimiser.run(self._z, *self._terms, epsilon, relief, still, REACH_CELLS, most, listener)


def minimiser(ni: int, nj: int, periodic: bool, aspect: float, weights: Weights) -> VariationalDescent:
    """Return the compiled minimisation of the variational functional over ni x nj nodes, for `Descent`."""
    rows, along = _fourier(ni - 1) if periodic else _sines(ni - 1)
    columns, across = _sines(nj - 1)
    along, across = along[:, None] * aspect, across[None] / aspect
    bending = along * ((ni - 1) ** 2 / aspect) + across * ((nj - 1) ** 2 * aspect)
    w, bend = weights.shape, 2.0 * weights.smoothness
    symbol = [
        (1.0 - w) * (along + across) + 4.0 * w * other + bend * own * bending
        for own, other in ((along, across), (across, along))
    ]
    scale = (ni - 1) * (nj - 1) / np.stack(symbol)
    left_out = (ni - 1 if periodic else ni - 2) * (nj - 2) > scale[0].size
    rest = float(scale.min()) if left_out else 0.0
    return VariationalDescent(ni, nj, periodic, rows, columns, scale - rest, rest, threads_for(ni * nj))


Halves: TypeAlias = tuple[Modes, Modes]
"""Modes that are even and modes that are odd about the middle, on the first half of the nodes."""


@lru_cache(maxsize=16)
def _sines(n: int) -> tuple[Halves, Floats]:
    """Return sines that vanish at the ends of n cells, even ones first, and their eigenvalues."""
    waves, k = np.arange(1, n)[:MODES], np.arange(1, n)
    even, odd = (sin(np.pi / n * (np.outer(k, half) % (2 * n))) for half in (waves[::2], waves[1::2]))
    values = 4.0 * sin(np.pi * np.concatenate([waves[::2], waves[1::2]]) / (2 * n)) ** 2
    return (_folded(even, True), _folded(odd, False)), values


@lru_cache(maxsize=16)
def _fourier(n: int) -> tuple[Halves, Floats]:
    """Return the same as `_sines` for n periodic nodes: constant, cosines and sines about a cell's middle."""
    cosines, sines = np.arange((n + 1) // 2)[: MODES // 2], np.arange(1, n // 2 + 1)[: MODES // 2]
    phase = 2.0 * np.pi / n * (np.arange(n) + 0.5)
    even, odd = cos(np.outer(phase, cosines)), sin(np.outer(phase, sines))
    values = 4.0 * sin(np.pi * np.concatenate([cosines, sines]) / n) ** 2
    return (_folded(even, True), _folded(odd, False)), values


def _folded(modes: Floats, even: bool) -> Modes:
    """Return the first half of even or odd `modes` (n, m), normalised to length 1."""
    n = len(modes)
    half = modes[: (n + 1) // 2 if even else n // 2].copy()
    half[: n // 2] *= np.sqrt(2.0)
    return Modes(half / np.sqrt((half**2).sum(axis=0)))
