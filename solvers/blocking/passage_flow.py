r"""Flow through a cascade at no circulation: its potential is a conformal map to flat plates at no stagger.

With ζ = π z / (p n), n along the axis and p the pitch, the complex potential is

    G = ζ + ∫ γ(s) log sinh(ζ - s) ds,   Im G = const along the blade,   ∫ γ ds = 0.

The blade becomes a slit of length l that repeats every iπ. The slit's outside is the disc |u| < 1 by

    u + 1/u = (c + 1/c) tanh G,   c = tanh(l / 4);   -c and c are the ends of the passage.

The vortex sheet γ is found with panels. Martensen, Arch. Rat. Mech. Anal. 3 (1959) 235-270.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.polygon.corners import Indices

_GAUSS = np.polynomial.legendre.leggauss(2)
_TINY = 1e-12
_LEAST = 1e-9  # of the slit: by how much the potential rises from point to point


@dataclass(frozen=True, eq=False)
class PassageFlow:
    """A blade as a slit, and as the unit circle.

    Parameters
    ----------
    half : half the length of the slit.
    circle : (n,) places on the unit circle of the blade's points, counter-clockwise.
    """

    half: float
    circle: Complexes

    @classmethod
    def around(cls, points: Complexes) -> PassageFlow:
        """Return the flow around a clockwise polygon (n,) in the plane of ζ, which repeats every iπ."""
        sheet = _sheet(points)
        step = np.roll(points, -1) - points
        gain = 2.0 * np.pi * sheet * np.abs(step)
        potential = np.concatenate([[0.0], np.cumsum(gain)[:-1]])
        first, last = int(np.argmin(potential)), int(np.argmax(potential))
        half = 0.5 * (potential[last] - potential[first])
        c = np.tanh(0.5 * half)
        phi = potential - 0.5 * (potential[last] + potential[first])
        angle = np.empty(len(points))
        for start, stop, turn, sign in ((first, last, 0.0, -1.0), (last, first, 0.0, 1.0)):
            side = _range(start, stop, len(points))
            rising = np.maximum.accumulate(phi[side] * -sign)
            rising = rising + _LEAST * half * np.arange(len(side))
            rising = np.interp(rising, rising[[0, -1]], [-half, half])
            cosine = (0.5 * (c + 1.0 / c)) * np.tanh(-sign * rising)
            angle[side] = turn + sign * np.arccos(np.clip(cosine, -1.0, 1.0))
        return cls(float(half), np.exp(1j * angle))

    @property
    def end(self) -> float:
        """Place c in the disc of the passage's end far behind the blades; -c is that before them."""
        return float(np.tanh(0.5 * self.half))

    def distance(self, values: Complexes, radius: float, behind: bool) -> float:
        """Return |Re G| of a circle around an end of the passage.

        `radius` is that in the plane of the function whose `values` (n,) at the blade's points are given.
        """
        c, small = self.end, 1e-3 * (1.0 - self.end)
        at = (c if behind else -c) + small * np.array([-1.0, 1.0])
        low, high = self.inside(values, at.astype(complex))
        inner = radius * 2.0 * small / abs(high - low)
        return float(-0.5 * np.log(inner * (1.0 / c**2 - 1.0) / (2.0 * (c + 1.0 / c))))

    def disc(self, places: Complexes) -> Complexes:
        """Return the places u of places G, those between the slits."""
        c = self.end
        m = 0.5 * (c + 1.0 / c) * np.tanh(places)
        root = np.sqrt(m - 1.0) * np.sqrt(m + 1.0)
        one = m - root
        with np.errstate(divide="ignore", invalid="ignore"):
            other = 1.0 / one
        return np.asarray(np.where(np.abs(one) <= 1.0, one, other))

    def inside(self, values: Complexes, places: Complexes) -> Complexes:
        """Return at places u (m,) the analytic function whose `values` (n,) at the blade's points are given.

        Cauchy's integral by the trapezoidal rule, over that of 1 (Helsing, Ojala, J. Comput. Phys. 227 (2008)
        2899-2921).
        """
        weight = np.roll(self.circle, -1) - np.roll(self.circle, 1)
        away = self.circle - places[:, None]
        near = np.argmin(np.abs(away), axis=1)
        rows = np.arange(len(places))
        exact = np.abs(away[rows, near]) < 1e-14
        away[rows[exact], near[exact]] = 1.0
        kernel = weight / away
        result = (kernel * values).sum(axis=1) / kernel.sum(axis=1)
        result[exact] = values[near[exact]]
        return np.asarray(result)


def _range(start: int, stop: int, count: int) -> Indices:
    return np.arange(start, stop + (count if stop < start else 0) + 1) % count


def _sheet(points: Complexes) -> Floats:
    """Return the strength (n,) of the vortex sheet along each side of a polygon (n,)."""
    n = len(points)
    step = np.roll(points, -1) - points
    length = np.abs(step)
    middle = points + 0.5 * step
    kernel = np.zeros((n + 1, n + 1))
    kernel[:n, :n] = _log_integrals(points, step, middle)
    for place, weight in zip(*_GAUSS, strict=True):
        away = middle[:, None] - (middle + 0.5 * place * step)
        away[away == 0.0] = _TINY
        kernel[:n, :n] += 0.5 * weight * length * np.log(np.abs(np.sinh(away) / away))
    kernel[:n, n] = -1.0
    kernel[n, :n] = length
    return np.linalg.solve(kernel, np.append(-middle.imag, 0.0))[:n]


def _log_integrals(points: Complexes, step: Complexes, middle: Complexes) -> Floats:
    """Return the integrals (n, n) of log |middle - s| along the sides of a polygon."""
    local = (middle[:, None] - points) * np.conj(step / np.abs(step))
    high = np.abs(local.imag)

    def primitive(x: Floats) -> Floats:
        distance = np.maximum(np.hypot(x, high), 1e-300)
        return np.asarray(x * np.log(distance) - x + high * np.arctan2(x, high))

    return primitive(local.real) - primitive(local.real - np.abs(step))
