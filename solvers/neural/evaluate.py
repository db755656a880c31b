"""A grid at any resolution from a strip solution, at the speed of memory.

The strip solution is separable: (cosines and sines along theta) x (Chebyshev points across). What the first
`MODES` modes leave out of the walls dies within a few levels of them and is added there exactly. Levels near
the walls go through the compiled maps one by one; all others are interpolated along eta in the plane, from
the few Chebyshev points of each panel.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from geometry.arrays import Complexes, Floats
from geometry.lift import Lift
from solvers.neural._maps import to_plane
from solvers.neural.panels import panels
from solvers.neural.strip import MODES, interpolation

BLOCK = 1 << 16  # nodes a block: both coordinates stay in the second-level cache
FAINT = 1e-9  # a wall's high modes are followed until their sum is below this (radians in the strip)


class StripGrid:
    """A strip solution sampled at the nodes of one grid.

    Parameters
    ----------
    c : (2 MODES + 1, LEVELS) modes of F = w - i theta at the Chebyshev points.
    wall, far : (n,) F at the nodes of the two walls.
    eta : (nj,) rising from 0 to 1.
    """

    def __init__(self, c: Complexes, wall: Complexes, far: Complexes, eta: Floats) -> None:
        n = len(wall)
        self.theta = 2.0 * np.pi * np.arange(n) / n
        self.eta = eta
        self._levels = c.shape[1]
        self._columns = _at_nodes(c, n)
        self._near = _high_modes(wall, wall, far, eta)
        self._away = _high_modes(far, wall, far, 1.0 - eta[::-1])[:, ::-1]
        self._nudges: list[tuple[slice, Floats, Callable[[Floats], Floats]]] = []
        psi = wall.real
        inner, outer = self._near.shape[1], len(eta) - self._away.shape[1]
        height, spread = float(far.real.mean() - psi.mean()), float(psi.max() - psi.min())
        self._panels = panels(eta, height, spread, inner, outer)

    def at(self, i: int, j: int) -> complex:
        """Return w at node (i, j), nudges left out."""
        F = complex((self._columns[:, :, i] @ interpolation(self.eta[j : j + 1])[:, 0]) @ (1.0, 1j))
        return F + 1j * self.theta[i] + (self._near[i, j] if j < self._near.shape[1] else 0.0)

    def nudge(self, rows: slice, along: Floats, across: Callable[[Floats], Floats]) -> None:
        """Add `along` (rows) times ``across(eta)`` to phi."""
        self._nudges.append((rows, along, across))

    def fill(self, lift: Lift, out: Floats) -> None:
        """Write the grid in the plane to `out` (n + 1, nj, 2) planar; the last row repeats the first bitwise.

        The walls are as exact as the maps are: the caller puts the given nodes there.
        """
        n, nj = len(self.theta), len(self.eta)
        begin, end = (self._panels[0].start, self._panels[-1].stop) if self._panels else (nj, nj)
        directly = np.r_[0:begin, end:nj]
        eta = np.concatenate([self.eta[directly], *(panel.eta for panel in self._panels)])
        across = interpolation(eta)
        nudges = [(rows, along, profile(eta)) for rows, along, profile in self._nudges]
        step = max(1, BLOCK // nj)
        for start in range(0, n, step):
            rows = slice(start, min(start + step, n))
            psi, phi = (np.ascontiguousarray(part[:, rows].T) @ across for part in self._columns)
            phi += self.theta[rows, None]
            self._add_bands(rows, psi, phi, len(directly))
            for where, along, profile in nudges:
                a, b = max(where.start, rows.start), min(where.stop, rows.stop)
                if a < b:
                    phi[a - start : b - start] += np.outer(along[a - where.start : b - where.start], profile)
            to_plane(psi, phi, lift)
            for values, target in ((psi, out[rows, :, 0]), (phi, out[rows, :, 1])):
                target[:, :begin], target[:, end:] = values[:, :begin], values[:, begin : len(directly)]
                taken = len(directly)
                for panel in self._panels:
                    points = values[:, taken : taken + len(panel.eta)]
                    np.matmul(points, panel.matrix, out=target[:, panel.start : panel.stop])
                    taken += len(panel.eta)
        out[-1] = out[0]

    def _add_bands(self, rows: slice, psi: Floats, phi: Floats, direct: int) -> None:
        near, away = self._near[rows], self._away[rows]
        for band, where in (
            (near, slice(0, near.shape[1])),
            (away, slice(direct - away.shape[1], direct)),
        ):
            if band.shape[1]:
                psi[:, where] += band.real
                phi[:, where] += band.imag


def _at_nodes(c: Complexes, n: int) -> Floats:
    """Return samples (2, LEVELS, n), real and imaginary, at equal steps of theta of the modes c."""
    full = np.zeros((c.shape[1], n), complex)
    for row, k in enumerate((*range(MODES + 1), *range(-MODES, 0))):
        full[:, k % n] += c[row]  # few nodes cannot tell high modes from low ones
    samples = np.fft.ifft(full, norm="forward")
    return np.stack([samples.real, samples.imag])


def _high_modes(F: Complexes, wall: Complexes, far: Complexes, depth: Floats) -> Complexes:
    """Return what `MODES` modes leave out of F on one wall, (n, as many levels of `depth` as it reaches).

    `depth` rises from 0 at that wall. Such modes never see the opposite wall: to round-off, exp(-kT depth) is
    their sinh ratio.
    """
    n, T = len(F), float((far.mean() - wall.mean()).real)
    k = np.minimum(np.arange(n), n - np.arange(n))
    rest = np.fft.fft(F)
    rest[k <= min(MODES, (n - 1) // 2)] = 0.0
    strength = np.abs(rest) / n
    high = np.flatnonzero(strength > 1e-3 * FAINT / n)
    some = [0]
    while some[-1] < len(depth) - 1:
        some.append(min(some[-1] + 1 + some[-1] // 4, len(depth) - 1))
    felt = np.exp(np.outer(-depth[some] * T, k[high])) @ strength[high] > FAINT
    levels = 0 if not felt[0] else len(depth) if felt.all() else int(some[np.argmin(felt)])
    band = np.zeros((levels, n), complex)
    band[:, high] = rest[high] * np.exp(np.outer(-depth[:levels] * T, k[high]))
    return np.asarray(np.fft.ifft(band, axis=1).T) if levels else band.T
