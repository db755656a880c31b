"""Descents, preconditioned by the inverse of the functional's Hessian on a grid of equal squares.

There the harmonic term is a Laplacian and the edge length term a biharmonic operator, both diagonal in
products of sines (along eta, and along xi between fixed nodes) or of sines and cosines (around a body). The
compiled descent applies them in the frame of each node, by products of matrices.
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
    """Descents of the functional from planar nodes (ni, nj, 2), moved in place; those of the rim are fixed.

    Around a body (`periodic`) the last row is the first and moves. `aspect` is a of the functional, None that
    of `nodes`.
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
        """Descend; return the value of the functional, the smallest corner Jacobian and the iterations.

        It stops when nodes move by less than `still` of their own cells, or after `most` iterations.
        `epsilon` is an area by which Jacobians are regularised, `relief` that of `relief_of`; `listener` gets
        number, value and norm of the gradient at the start and after each iteration.
        """
        return self.minimiser.run(self._z, *self._terms, epsilon, relief, still, REACH_CELLS, most, listener)


def minimiser(ni: int, nj: int, periodic: bool, aspect: float, weights: Weights) -> VariationalDescent:
    """Return the descent for ni x nj nodes, the last row of which is the first when `periodic`.

    On squares of steps 1, with a move (p, q) along (xi, eta) and a = 1, the second variation is about (1-w)
    (‖∇p‖² + ‖∇q‖²) + 4 w (p_η² + q_ξ²) + 2 β (‖∇p_ξ‖² + ‖∇q_η‖²), with ∇ in units of the whole square in the
    last term. The coupling p_η q_ξ is left to the descent.
    """
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
"""Even and odd modes about the middle, over the first half of the nodes."""


@lru_cache(maxsize=16)
def _sines(n: int) -> tuple[Halves, Floats]:
    """Return sines that vanish at the ends of n cells; minus their second differences; even ones first."""
    waves, k = np.arange(1, n)[:MODES], np.arange(1, n)
    even, odd = (sin(np.pi / n * (np.outer(k, half) % (2 * n))) for half in (waves[::2], waves[1::2]))
    values = 4.0 * sin(np.pi * np.concatenate([waves[::2], waves[1::2]]) / (2 * n)) ** 2
    return (_folded(even, True), _folded(odd, False)), values


@lru_cache(maxsize=16)
def _fourier(n: int) -> tuple[Halves, Floats]:
    """Return `_sines` for n periodic nodes: a constant and cosines, and sines, about the middle of a cell."""
    cosines, sines = np.arange((n + 1) // 2)[: MODES // 2], np.arange(1, n // 2 + 1)[: MODES // 2]
    phase = 2.0 * np.pi / n * (np.arange(n) + 0.5)
    even, odd = cos(np.outer(phase, cosines)), sin(np.outer(phase, sines))
    values = 4.0 * sin(np.pi * np.concatenate([cosines, sines]) / n) ** 2
    return (_folded(even, True), _folded(odd, False)), values


def _folded(modes: Floats, even: bool) -> Modes:
    """Return the first half of even or odd `modes` (n, m), of length 1 as they are when folded."""
    n = len(modes)
    half = modes[: (n + 1) // 2 if even else n // 2].copy()
    half[: n // 2] *= np.sqrt(2.0)
    return Modes(half / np.sqrt((half**2).sum(axis=0)))
