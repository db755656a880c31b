"""Which places on both sides of the channel between two blades are opposite each other, in all sections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, wrapped
from meshonet.geometry.threads import in_threads
from meshonet.solvers.blocking.layers.even_line import PlaceLinks
from meshonet.solvers.rows.section_plane import SectionPlane

_SAMPLES = 201  # places on each side
_EDGE = 3  # of these at both edges have nothing opposite them
_FROM = -0.25  # least place: u = 0, the leading edge, is between others


@dataclass(frozen=True, eq=False)
class ChannelLines:
    """Lines across the channel, at right angles to the fronts of layers, in the mean of sections.

    Parameters
    ----------
    upper : (n,) places u on the upper side, from 0 to 0.5.
    lower : (n,) what is opposite these on the lower side of the next blade, 1 - u.
    slant : (n,) tangent of the angle by which a line leans one of whose ends is moved by a unit of u; 0 where
        nothing is opposite.
    """

    upper: Floats
    lower: Floats
    slant: Floats

    @classmethod
    def of(cls, planes: Sequence[SectionPlane]) -> ChannelLines:
        """Return the lines of some sections."""
        upper = np.linspace(0.0, 0.5, _SAMPLES)
        squares, sums = np.zeros(_SAMPLES), np.zeros(_SAMPLES)
        for lower, slant in in_threads(lambda plane: _opposite(plane, upper), planes):
            squares += slant**2
            sums += slant**2 * lower
        known = np.flatnonzero(squares > 0.0)
        if len(known):
            upper_known, lower = upper[known], sums[known] / squares[known]
            return cls(upper, np.interp(upper, upper_known, lower), np.sqrt(squares / len(planes)))
        return cls(upper, upper, squares)

    def links(self, u: Floats, start: Floats, pairs: Indices, weight: float) -> PlaceLinks:
        """Return by how much more lines between `pairs` (p, 2) of places (k,) lean than those at `start`.

        They are linear near `u` (k,), and multiplied by a weight.
        """
        one = u[pairs[:, 0]]
        slope = np.interp(one, self.upper, np.gradient(self.lower, self.upper))
        scale = weight * np.interp(one, self.upper, self.slant)
        factors = -scale[:, None] * np.stack([slope, np.ones(len(one))], axis=1)
        aside = self._aside(u[pairs]) - self._aside(start[pairs])
        return PlaceLinks(pairs, factors, scale * aside - (factors * u[pairs]).sum(axis=1))

    def leaning(self, u: Floats, pairs: Indices) -> float:
        """Return the mean square of tangents by which lines between `pairs` (p, 2) of places u (k,) lean."""
        upper = wrapped(u[pairs[:, 0]], _FROM)
        slant = np.interp(upper, self.upper, self.slant)
        return float(((slant * self._aside(u[pairs])) ** 2).mean())

    def _aside(self, pairs: Floats) -> Floats:
        """Return by how much u on the lower side (p,) is aside of what is opposite that on the upper one."""
        upper, lower = (wrapped(each, _FROM) for each in (pairs[:, 0], 1.0 - pairs[:, 1]))
        return np.asarray(lower - np.interp(upper, self.upper, self.lower))


def _opposite(plane: SectionPlane, upper: Floats) -> tuple[Floats, Floats]:
    """Return what is opposite places `upper` (n,) of a section, 1 - u, and the slant there."""
    front, pitch = plane.cascade.ring.front, np.array([0.0, plane.cascade.pitch[1]])
    one, other = (front.at(plane.front_arcs(u)) for u in (upper, 1.0 - upper))
    away = ((other + pitch - one[:, None]) ** 2).sum(axis=-1)
    k = away.argmin(axis=1)
    inside = (k >= _EDGE) & (k < len(upper) - _EDGE)
    k, row = np.clip(k, 1, len(upper) - 2), np.arange(len(upper))
    before, here, after = away[row, k - 1], away[row, k], away[row, k + 1]
    shift = 0.5 * (before - after) / (before - 2.0 * here + after)
    lower = upper[k] + np.clip(shift, -0.5, 0.5) * upper[1]
    return lower, np.where(inside, plane.cascade.blade.length / np.sqrt(here), 0.0)
