"""A grid at any resolution from a strip solution, at the speed of memory.

The strip solution is separable: (cosines and sines along theta) x (Chebyshev points across), so a block of
rows costs two matrix products and one pass of the compiled maps. What the first `MODES` modes leave out of
the walls dies within a few rows of them and is added there exactly.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Complexes, Floats
from geometry.lift import Lift
from solvers.neural._maps import to_plane
from solvers.neural.strip import MODES, interpolation

BLOCK = 1 << 16  # nodes a block: both coordinates stay in the second-level cache
FAINT = 1e-10  # a wall's high modes are followed until their sum is below this (radians in the strip)
REACH = float(np.log(2.2))  # the Laurent series takes over this far (in psi) from the wall's outermost point
LAURENT_SAMPLES = 256


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
        columns = _at_nodes(c, n)
        self._columns = np.concatenate([columns.real, columns.imag], axis=1)
        self._across = interpolation(eta)
        self._near = _high_modes(wall, wall, far, eta)
        self._away = _high_modes(far, wall, far, 1.0 - eta[::-1])[:, ::-1]
        self._nudges: list[tuple[slice, Floats, Floats]] = []

    def at(self, i: int, j: int) -> complex:
        """Return w at node (i, j), nudges left out."""
        psi = self._columns[i, : self._levels] @ self._across[:, j]
        phi = self._columns[i, self._levels :] @ self._across[:, j] + self.theta[i]
        high = self._near[i, j] if j < self._near.shape[1] else 0.0
        return complex(psi + 1j * phi + high)

    def nudge(self, rows: slice, along: Floats, across: Floats) -> None:
        """Add along x across, (rows) x (nj,), to phi."""
        self._nudges.append((rows, along, across))

    def fill(self, lift: Lift, wall_psi: float, out: Floats) -> None:
        """Write the grid in the plane to `out` (n + 1, nj, 2) planar; the last row repeats the first bitwise.

        `wall_psi` is the largest psi of the wall. The walls are as exact as the maps are: the caller puts
        the given nodes there.
        """
        n, nj = len(self.theta), len(self.eta)
        psi_far, laurent = _laurent(lift, wall_psi)
        x, y = out[..., 0], out[..., 1]
        rows = max(1, BLOCK // nj)
        for start in range(0, n, rows):
            stop = min(start + rows, n)
            psi, phi = x[start:stop], y[start:stop]
            np.matmul(self._columns[start:stop, : self._levels], self._across, out=psi)
            np.matmul(self._columns[start:stop, self._levels :], self._across, out=phi)
            phi += self.theta[start:stop, None]
            self._add_bands(start, stop, psi, phi)
            to_plane(psi, phi, lift, psi_far, REACH, laurent)
        out[-1] = out[0]

    def _add_bands(self, start: int, stop: int, psi: Floats, phi: Floats) -> None:
        nj = len(self.eta)
        near, away = self._near, self._away
        for band, where in ((near, slice(0, near.shape[1])), (away, slice(nj - away.shape[1], nj))):
            if band.shape[1]:
                psi[:, where] += band[start:stop].real
                phi[:, where] += band[start:stop].imag
        for rows, along, across in self._nudges:
            a, b = max(rows.start, start), min(rows.stop, stop)
            if a < b:
                phi[a - start : b - start] += np.outer(along[a - rows.start : b - rows.start], across)


def _at_nodes(c: Complexes, n: int) -> Complexes:
    """Return samples (n, ...) at equal steps of theta of the function with modes c (2 MODES + 1, ...)."""
    full = np.zeros((n, *c.shape[1:]), complex)
    for row, k in enumerate((*range(MODES + 1), *range(-MODES, 0))):
        full[k % n] += c[row]  # few nodes cannot tell high modes from low ones
    samples: Complexes = np.fft.ifft(full, axis=0)
    samples *= n
    return samples


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
    levels = 0
    while levels < len(depth) and (strength[high] * np.exp(-k[high] * T * depth[levels])).sum() > FAINT:
        levels = max(levels + 1, int(levels * 1.25))
    band = np.zeros((min(levels, len(depth)), n), complex)
    band[:, high] = rest[high] * np.exp(np.outer(-depth[: len(band)] * T, k[high]))
    return np.asarray(np.fft.ifft(band, axis=1).T)


def _laurent(lift: Lift, wall_psi: float) -> tuple[float, Complexes]:
    """Return psi_far and coefficients c_n of z = quarter v + sum c_n v^-n, for |v| > exp(psi_far).

    Sampled on the circle of that radius; terms below round-off there are dropped.
    """
    psi_far = wall_psi + REACH
    angle = 2.0 * np.pi * np.arange(LAURENT_SAMPLES) / LAURENT_SAMPLES
    radius = np.exp(psi_far)
    z = lift.to_plane(np.asarray(psi_far + 1j * (angle - lift.phase), dtype=np.complex128))
    z -= lift.quarter * radius * np.exp(1j * angle)
    series = np.fft.ifft(z)[: LAURENT_SAMPLES // 2]  # the part in exp(-i n angle)
    kept = np.flatnonzero(np.abs(series) > 1e-15 * np.abs(lift.quarter))
    count = min(int(np.log(1e16) / REACH), int(kept[-1]) + 1 if kept.size else 1)
    return psi_far, np.ascontiguousarray(series[:count] * radius ** np.arange(count))
