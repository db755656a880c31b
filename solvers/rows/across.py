"""Which places on both sides of the channel between two blades are opposite each other, in all sections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, wrapped
from meshonet.solvers.layers.even_line import PlaceLinks
from meshonet.solvers.rows.section_plane import ON_SIDE, SectionPlane

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
        upper = ON_SIDE
        squares, sums = np.zeros(len(upper)), np.zeros(len(upper))
        for lower, slant in (plane.across for plane in planes):
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
        aside = self.aside(u[pairs]) - self.aside(start[pairs])
        return PlaceLinks(pairs, factors, scale * aside - (factors * u[pairs]).sum(axis=1))

    def leaning(self, u: Floats, pairs: Indices) -> float:
        """Return the mean square of tangents by which lines between `pairs` (p, 2) of places u (k,) lean."""
        return float((self.weights(u[pairs]) * self.aside(u[pairs]) ** 2).mean())

    def weights(self, pairs: Floats) -> Floats:
        """Return the square of the slant (p,) of lines between pairs (p, 2) of places."""
        return np.asarray(np.interp(wrapped(pairs[:, 0], _FROM), self.upper, self.slant) ** 2)

    def aside(self, pairs: Floats) -> Floats:
        """Return by how much u on the lower side (p,) is aside of what is opposite that on the upper one."""
        upper, lower = (wrapped(each, _FROM) for each in (pairs[:, 0], 1.0 - pairs[:, 1]))
        return np.asarray(lower - np.interp(upper, self.upper, self.lower))
