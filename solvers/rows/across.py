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

        `u` and `start` (k,) are present and original positions of nodes, from 0 to 1 around a blade. A row of
        `pairs` (p, 2) has the indices of a node and of the node on the next blade to which a line leads.
        Lean is the tangent of the angle between this line and the shortest one across the channel from the
        same node. The increase in lean is linearised at `u` and multiplied by `weight`.
        """
        one = u[pairs[:, 0]]
        slope = np.interp(one, self.upper, np.gradient(self.lower, self.upper))
        scale = weight * np.interp(one, self.upper, self.slant)
        factors = -scale[:, None] * np.stack([slope, np.ones(len(one))], axis=1)
        aside = self.aside(u[pairs]) - self.aside(start[pairs])
        return PlaceLinks(pairs, factors, scale * aside - (factors * u[pairs]).sum(axis=1))

    def leaning(self, u: Floats, pairs: Indices) -> float:
        """Return the mean square lean (see `links`) of p lines across the channel between two blades.

        Nodes are at `u` (k,), from 0 to 1 around each blade; `pairs` (p, 2) are indices of the ends of lines.
        """
        return float((self.weights(u[pairs]) * self.aside(u[pairs]) ** 2).mean())

    def weights(self, pairs: Floats) -> Floats:
        """Return f (p,) so that ``f * self.aside(pairs) ** 2`` are squared leans of lines (see `links`)."""
        return np.asarray(np.interp(wrapped(pairs[:, 0], _FROM), self.upper, self.slant) ** 2)

    def aside(self, pairs: Floats) -> Floats:
        """Return by how much (p,) the second ends of p lines would have to move to make the lines ideal.

        The lines lead from one blade to the next; ideal lines are nearly normal to the layers of both.
        `pairs` (p, 2) are the positions of both ends of each line, from 0 to 1 around the blades.
        """
        upper, lower = (wrapped(each, _FROM) for each in (pairs[:, 0], 1.0 - pairs[:, 1]))
        return np.asarray(lower - np.interp(upper, self.upper, self.lower))
