r"""Conformal map of a cascade's passage to a plane domain with two holes and without periodic sides.

With p the pitch and z₀ a point inside the blade, the map

    ζ = iπ (z - z₀) / p,   w = coth ζ

has the same value at z and z + p. The blade becomes the outer loop, because it surrounds the pole z₀. A line
across the flow, Re ζ = ±a, becomes the circle around ±coth 2a with radius 1/sinh 2a: inlet and outlet. Angles
are preserved.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, complex_of, pairs_of
from meshonet.geometry.elementary import log, modulus, tanh, times

_SMALL = 1e-12  # width of a blade below which a chord of it is no inside


@dataclass(frozen=True)
class PassageMap:
    """The map of a cascade with the period `pitch`, as a complex number, and the pole `centre`."""

    pitch: complex
    centre: complex

    @property
    def axis(self) -> complex:
        """Unit vector from inlet to outlet, perpendicular to the pitch."""
        return self.pitch / (1j * abs(self.pitch))

    def axial(self, points: Floats) -> Floats:
        """Return the axial distances (n,) of points (n, 2) from the centre."""
        return np.asarray(times(complex_of(points) - self.centre, np.conj(self.axis)).real)

    def along(self, points: Floats) -> Floats:
        """Return the distances (n,) of points (n, 2) from the centre along the pitch, in pitches."""
        return np.asarray(((complex_of(points) - self.centre) / self.pitch).real)

    def zeta(self, points: Floats) -> Complexes:
        """Return ζ (n,) of points z (n, 2)."""
        return np.asarray(times(1j * np.pi, (complex_of(points) - self.centre)) / self.pitch)

    def forward(self, points: Floats) -> Floats:
        """Return the images w (n, 2) of points z (n, 2)."""
        return of_zeta(self.zeta(points))

    def back(self, places: Floats) -> Floats:
        """Return the points z (n, 2) with images w (n, 2), within half a pitch of the axis of the centre."""
        w = complex_of(places)
        zeta = 0.5 * log((w + 1.0) / (w - 1.0))
        return pairs_of(self.centre + times(zeta, self.pitch) / (1j * np.pi))

    def derivative(self, places: Floats) -> Complexes:
        """Return dw/dz (n,) at w (n, 2)."""
        w = complex_of(places)
        return np.asarray(times(1j * np.pi / self.pitch, (1.0 - times(w, w))))

    def stretching(self, places: Floats) -> Floats:
        """Return |dw/dz| (n,) at w (n, 2)."""
        return modulus(self.derivative(places))

    def line(self, distance: float, count: int) -> Floats:
        """Return `count` points w (count, 2) on the line across the flow at an axial distance of the centre.

        They run clockwise around the hole that is its image, with equal steps along the line.
        """
        steps = np.arange(count) / count
        way = 1.0 if distance > 0 else -1.0
        points = self.centre + distance * self.axis + (way * steps) * self.pitch
        return self.forward(pairs_of(points))


def of_zeta(zeta: Complexes) -> Floats:
    """Return w (n, 2) at ζ (n,)."""
    return pairs_of(1.0 / tanh(zeta))


def inner_point(polygon: Floats) -> complex:
    """Return the point of a lattice inside a polygon (n, 2) that is farthest from the polygon."""
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    best, most = complex(*polygon.mean(axis=0)), -1.0
    for rows in (40, 160, 640):
        x = np.linspace(low[0], high[0], rows + 2)[1:-1]
        for value in x:
            y = _crossings(polygon, value)
            if len(y) < 2:
                continue
            for a, b in zip(y[::2], y[1::2], strict=False):
                middle = np.array([value, 0.5 * (a + b)])
                room = float(np.hypot(*(polygon - middle).T).min())
                if room > most and b - a > _SMALL:
                    best, most = complex(*middle), room
        if most > 0:
            break
    return best


def _crossings(polygon: Floats, x: float) -> Floats:
    """Return the ordinates, ascending, at which a closed polygon crosses the line of an abscissa."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    across = (a[:, 0] > x) != (b[:, 0] > x)
    a, b = a[across], b[across]
    return np.sort(a[:, 1] + (x - a[:, 0]) / (b[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1]))
