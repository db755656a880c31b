"""A strip solution at the nodes of a grid of any resolution."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Self, TypeAlias

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.conformal.lift import Lift
from meshonet.geometry.elementary import exp, modulus, product
from meshonet.geometry.polygon.mirror import Axis
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import strip_rows
from meshonet.solvers.conformal.chebyshev import panels
from meshonet.solvers.conformal.fourier_sums import SHARPNESS, columns
from meshonet.solvers.conformal.strip import MODES, interpolation, wavenumbers

FAINT = 1e-12  # a wall's high modes are followed until their sum is below this (radians in the strip)

Shift: TypeAlias = tuple[Floats, Callable[[Floats], Floats]]
"""A shift of phi: its amount (n,) along the wall, and a function from eta to the fraction of this amount."""


class StripGrid:
    """Nodes of a grid in the periodic strip onto which the domain around a body is mapped conformally.

    They are complex numbers F + i theta. F depends on theta, which goes around the body, and on `eta` (nj,),
    which ascends from 0 on the wall to 1. `c` (2 MODES + 1, LEVELS) are the Fourier modes of F at Chebyshev
    points of eta, `wall` and `far` (n,) the values of F at the nodes of wall and far field.
    """

    def __init__(self, c: Complexes, wall: Complexes, far: Complexes, eta: Floats) -> None:
        n, nj = len(wall), len(eta)
        self.theta = 2.0 * np.pi * np.arange(n) / n
        self.eta = eta
        self._c = c
        psi = wall.real
        height, spread = float(far.real.mean() - psi.mean()), float(psi.max() - psi.min())
        self._near, self._away = _HighModes.of(wall, height), _HighModes.of(far, height)
        outer, _ = max([(1, 0), *self._away.felt(1.0 - eta[::-1])])
        self._panels = panels(eta, height, spread, 1, nj - outer)

    def at(self, rows: Sequence[int], j: int) -> Complexes:
        """Return complex points in the strip: nodes with indices `rows` along the wall, on level `j`."""
        theta = self.theta[list(rows)]
        low = product(self._c, interpolation(self.eta[j : j + 1].tobytes())[:, 0])
        k, high = self._near.at(float(self.eta[j]))
        F = product(exp(1j * np.outer(theta, wavenumbers())), low) + product(
            exp(1j * np.outer(theta, k)), high
        )
        return np.asarray(F + 1j * theta)

    def fill(self, lift: Lift, out: Floats, axis: Axis | None = None, shift: Shift | None = None) -> bool:
        """Write the nodes between both walls to ``out[:, 1:-1]``; return whether all are finite.

        `out` is (n + 1, nj, 2), and its last row repeats the first. `lift` maps the strip of this grid to the
        plane. With a mirror `axis`, rows i and n - i are mirror images. `shift` moves nodes along the strip.
        """
        n, (ends, points, matrix) = len(self.theta), self._panels
        begin, far = ends[0], self.eta[ends[-1] : -1]
        eta = np.concatenate([self.eta[1:begin], points, far])
        along, across = (shift[0][None], shift[1](eta)[None]) if shift else (np.empty((0, n)), eta[None][:0])
        cuts = np.array(ends) - begin
        order = np.arange(n)
        if axis is not None:
            half = np.arange(n // 2 + 1)
            order = np.stack([half, -half % n], axis=1).ravel()
        sums = list(self._columns(eta, len(eta) - len(far)))
        x, y = out[..., 0], out[..., 1]
        finite = strip_rows(
            x, y, order, lift, sums, SHARPNESS, along, across, matrix, cuts, begin, axis, threads_for(x.size)
        )
        out[-1, 1:-1] = out[0, 1:-1]
        return finite

    def _columns(self, eta: Floats, last: int) -> Iterator[tuple[int, int, Floats]]:
        """Yield the points at `eta` in slices: first index, number, and the columns of their modes."""
        base = np.ascontiguousarray(self._c.T)
        low = product(interpolation(eta.tobytes()).T, base.view(np.float64)).view(np.complex128)
        first = 0
        for where, ahead, behind in self._near.bands(eta[:last]):
            yield where.start, len(ahead), columns(_widened(low[where], ahead, behind))
            first = where.stop
        depth, beyond = 1.0 - eta[last:][::-1], len(eta)
        for where, ahead, behind in self._away.bands(depth):
            start, stop = len(eta) - where.stop, len(eta) - where.start
            yield start, len(ahead), columns(_widened(low[start:stop], ahead[::-1], behind[::-1]))
            beyond = start
        yield first, beyond - first, columns(low[first:beyond])


def _widened(low: Complexes, ahead: Complexes, behind: Complexes) -> Complexes:
    """Return modes k = 0 .. K, -K .. -1 from those up to `MODES` and those beyond."""
    return np.hstack([low[:, : MODES + 1], ahead, behind, low[:, MODES + 1 :]])


@dataclass(frozen=True)
class _HighModes:
    """A wall's modes beyond `MODES`: `ahead` for k = MODES + 1 .. K, `behind` for -K .. -MODES - 1."""

    ahead: Complexes
    behind: Complexes
    height: float

    @classmethod
    def of(cls, F: Complexes, height: float) -> Self:
        n = len(F)
        c, highest = np.fft.fft(F, norm="forward"), max(n // 2, MODES)
        ahead, behind = c[MODES + 1 : highest + 1], c[max(n - highest, 0) : max(n - MODES, 0)].copy()
        if n % 2 == 0 and len(behind):
            behind[0] = 0.0  # n samples hold k = n/2 once
        return cls(ahead, behind, height)

    def at(self, depth: float) -> tuple[Floats, Complexes]:
        """Return wave numbers (2 m,) and the amplitudes of the modes at one depth."""
        k = np.arange(MODES + 1.0, MODES + 1.0 + len(self.ahead))
        fade = exp(-self.height * depth * k)
        modes = np.concatenate([self.ahead * fade, self.behind[::-1] * fade])
        return np.concatenate([k, -k]), modes

    def bands(self, depth: Floats) -> Iterator[tuple[slice, Complexes, Complexes]]:
        """Yield slices of `depth`, from the wall outwards, and the modes (levels, m) that are felt there."""
        start = 0
        for count, some in self.felt(depth):
            if count > start:
                levels = slice(start, count)
                k = np.arange(MODES + 1, MODES + 1 + some)
                fade = exp(np.outer(depth[levels], -self.height * k))
                yield levels, self.ahead[:some] * fade, self.behind[-some:] * fade[:, ::-1]
                start = count

    def felt(self, depth: Floats) -> list[tuple[int, int]]:
        """Return how many levels each octave of modes reaches, and its last mode; the highest comes first."""
        octaves: list[tuple[int, int]] = []
        strength = modulus(self.ahead) + modulus(self.behind[::-1])
        begin = 0
        while begin < len(strength):
            low = MODES + 1 + begin
            end = min(begin + low, len(strength))
            total = float(strength[begin:end].sum())
            felt = math.log(max(total / FAINT, 1.0)) / (low * self.height)
            octaves.append((int(np.searchsorted(depth, felt)), end))
            begin = end
        return octaves[::-1]
