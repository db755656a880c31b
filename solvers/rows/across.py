"""Places opposite each other across the channel between two blades, as means over sections."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, wrapped
from meshonet.solvers.layers.even_line import PlaceLinks
from meshonet.solvers.rows.section_plane import ON_SIDE, SectionPlane

_FROM = -0.25  # least place: u = 0, the leading edge, is between others


@dataclass(frozen=True, eq=False)
class ChannelLines:
    """Ends of lines that lead across a channel, nearly normal to the layers of the blades on both sides."""

    upper: Floats  # (n,) places u (see `SectionPlane`) on the upper side of a blade, from 0 to 0.5
    lower: Floats  # (n,) 1 - u of the opposite places, on the lower side of the next blade
    slant: Floats  # (n,) lean (see `links`) if an end moves by 1 in u; 0 where nothing is opposite

    @classmethod
    def of(cls, planes: Sequence[SectionPlane]) -> Self:
        """Return the lines across the channel, averaged over the sections `planes`."""
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
        """Return linear conditions that keep lines across the channel from leaning more than at the start.

        `u` and `start` (k,) are the present and original positions of nodes, from 0 to 1 around a blade. Each
        line joins the two nodes with the indices in a row of `pairs` (p, 2). Lean is the tangent of the angle
        between a line and the shortest way from its first node to the layers of the next blade. The increase
        in lean is linearised at `u` and multiplied by `weight`.
        """
        one = u[pairs[:, 0]]
        slope = np.interp(one, self.upper, np.gradient(self.lower, self.upper))
        scale = weight * np.interp(one, self.upper, self.slant)
        factors = -scale[:, None] * np.stack([slope, np.ones(len(one))], axis=1)
        aside = self.aside(u[pairs]) - self.aside(start[pairs])
        return PlaceLinks(pairs, factors, scale * aside - (factors * u[pairs]).sum(axis=1))

    def leaning(self, u: Floats, pairs: Indices) -> float:
        """Return the mean square lean (see `links`) of lines across the channel between two blades.

        The lines join nodes with indices `pairs` (p, 2) at positions `u` (k,), from 0 to 1 around a blade.
        """
        return float((self.weights(u[pairs]) * self.aside(u[pairs]) ** 2).mean())

    def weights(self, pairs: Floats) -> Floats:
        """Return factors (p,): ``aside(pairs) ** 2`` times these is the squared lean of lines (`links`)."""
        return np.asarray(np.interp(wrapped(pairs[:, 0], _FROM), self.upper, self.slant) ** 2)

    def aside(self, pairs: Floats) -> Floats:
        """Return the ideal minus the actual position (p,) of the second end of each of p lines.

        The lines lead across the channel between two blades. `pairs` (p, 2) are the positions of both ends,
        from 0 to 1 around a blade. With the ideal second end, a line is nearly normal to both blades' layers.
        """
        upper, lower = (wrapped(each, _FROM) for each in (pairs[:, 0], 1.0 - pairs[:, 1]))
        return np.asarray(lower - np.interp(upper, self.upper, self.lower))
