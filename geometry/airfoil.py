"""An airfoil: its curve, leading and trailing edge, and nodes along its wall."""

from __future__ import annotations

import numpy as np

from geometry.arrays import Floats
from geometry.boundary import Boundary, polygon_area
from geometry.curves import Curve
from geometry.errors import InputError
from geometry.sampling import DEFAULT_NI, DEFAULT_NJ, Sampling
from geometry.topology import o_boundary

SHARP_GAP = 2e-4
"""Trailing-edge gap, in chords, below which an edge counts as sharp (more real files fold without this rule)."""


class Airfoil:
    """A closed section with one leading and one trailing edge.

    Parameters
    ----------
    points : (n, 2) around the section from the trailing edge to the trailing edge, either way round.
    name : what the input called it.
    """

    def __init__(self, points: Floats, name: str = "") -> None:
        self.name = name
        ring = np.asarray(points, dtype=np.float64)
        if polygon_area(ring) > 0:
            ring = ring[::-1]
        middle = 0.5 * (ring[0] + ring[-1])
        self.chord = float(np.hypot(*(ring - middle).T).max())
        self.gap = float(np.hypot(*(ring[0] - ring[-1])))
        self.blunt = self.gap >= SHARP_GAP * self.chord
        self.trailing_edge = middle
        if self.blunt:
            ring = np.concatenate([middle[None], ring])
            corners = [0, 1, len(ring) - 1]
        else:
            ring = np.concatenate([middle[None], ring[1:-1]])
            corners = [0]
        self.curve = Curve(ring, closed=True, corners=corners)
        self._first, self._last = (
            (self.curve.knots[1], self.curve.knots[-1]) if self.blunt else (0.0, self.curve.length)
        )
        s = np.linspace(0.0, self.curve.length, 4001)
        p = self.curve.at(s)
        self._le = float(s[np.argmax(np.hypot(*(p - middle).T))])
        self.leading_edge = self.curve.at(np.array([self._le]))[0]

    def wall(self, ni: int, sampling: Sampling) -> Floats:
        """Return ni nodes (ni, 2) on the curve, clockwise from the trailing edge, the first repeated bitwise at the end."""
        half = max(1, min((ni - 1) // 8, 8)) if self.blunt else 0
        n = ni - 1 - 2 * half
        n1 = n // 2
        lower = self._first + (self._le - self._first) * 0.5 * (1 - np.cos(np.pi * np.linspace(0, 1, n1 + 1)))
        upper = self._le + (self._last - self._le) * 0.5 * (1 - np.cos(np.pi * np.linspace(0, 1, n - n1 + 1)))
        base = np.linspace(0, self._first, half + 1)
        end = np.linspace(self._last, self.curve.length, half + 1)
        nodes = self.curve.at(np.concatenate([base[:-1], lower[:-1], upper, end[1:]]))
        nodes[-1] = nodes[0]
        return nodes

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the O boundary within a circle around mid-chord."""
        if sampling.topology not in ("auto", "o"):
            raise InputError(f"topology {sampling.topology} of an airfoil is not made yet", "use o")
        ni, nj = sampling.ni or DEFAULT_NI, sampling.nj or DEFAULT_NJ
        centre = 0.5 * (self.leading_edge + self.trailing_edge)
        return o_boundary(
            self.wall(ni, sampling), nj, centre, sampling.far_field * self.chord, self.curve, self.name
        )
