"""An outer loop cut open by C sheets: it follows their fronts in to the bodies and back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.loop import Loop
from meshonet.solvers.blocking.c_sheets import Sheet

_MARGIN = (
    0.3  # of the distance from wake to front: points of the loop nearer than this to a front are left out
)


@dataclass(frozen=True, eq=False)
class CutLoop:
    """A loop along fronts and what is left of an outer loop.

    Parameters
    ----------
    outer : the loop that was cut.
    sheets : in the order in which the outer loop meets them.
    loop : the new one; its corners are those of `outer`, the ends of fronts, and the columns at edges.
    first : numbers of the points of `loop` at which each front begins.
    arcs : (n,) arc lengths of `outer` at the points of `loop`, rising behind each front; along fronts, none.
    """

    outer: Loop
    sheets: tuple[Sheet, ...]
    loop: Loop
    first: tuple[int, ...]
    arcs: Floats

    @classmethod
    def of(cls, outer: Loop, sheets: list[Sheet]) -> CutLoop:
        """Return the outer loop cut open by sheets."""
        sheets = sorted(sheets, key=lambda each: each.out)
        points: list[Floats] = []
        straight, arcs, first, smooth, corners = [], [], [], [], []
        count, knots = 0, outer.curve.knots
        lines = outer.curve.straight if outer.curve.straight is not None else np.zeros(len(knots), dtype=bool)
        for k, sheet in enumerate(sheets):
            n = len(sheet.front)
            begin, end = sheet.ends[1], sheets[(k + 1) % len(sheets)].ends[0]
            begin = begin % outer.length
            end = begin + (end - begin) % outer.length
            margin = _MARGIN * (sheet.ends[1] - sheet.ends[0])
            turns = np.concatenate([knots, knots + outer.length])
            inner = np.flatnonzero((turns > begin + margin) & (turns < end - margin))
            first.append(count)
            smooth += [count, count + n - 1]
            corners += [count, count + sheet.edge, count + n - 1 - sheet.edge, count + n - 1]
            at = np.searchsorted(turns, begin, side="right") - 1
            straight += [False] * (n - 1) + [bool(lines[at % len(knots)])]
            straight += [bool(lines[i % len(knots)]) for i in inner]
            arcs += [np.full(n - 1, np.nan), np.array([begin]), turns[inner]]
            points += [sheet.front, outer.curve.points[inner % len(knots)]]
            for found, of in ((smooth, outer.curve.corner_index), (corners, outer.corners)):
                found += (count + n + np.flatnonzero(np.isin(inner % len(knots), of))).tolist()
            count += n + len(inner)
        mask = np.array(straight) if any(straight) else None
        curve = Curve(np.concatenate(points), closed=True, corners=sorted(smooth), straight=mask)
        loop = Loop(curve, tuple(sorted(corners)), outer.names[:1])
        return cls(outer, tuple(sheets), loop, tuple(first), np.concatenate(arcs))

    def span(self, k: int) -> tuple[float, float]:
        """Return the arc lengths of the new loop at which a front begins and ends."""
        knots = self.loop.curve.knots
        return float(knots[self.first[k]]), float(knots[self.first[k] + len(self.sheets[k].front) - 1])

    def index(self, k: int, arcs: Floats) -> Floats:
        """Return the column numbers (m,) of a sheet at arc lengths (m,) of the new loop on its front."""
        n = len(self.sheets[k].front)
        knots = self.loop.curve.knots[self.first[k] : self.first[k] + n]
        return np.interp(arcs, knots, np.arange(float(n)))

    def front_arcs(self, k: int, index: Floats) -> Floats:
        """Return arc lengths (m,) of the new loop at column numbers (m,) of a sheet."""
        n = len(self.sheets[k].front)
        knots = self.loop.curve.knots[self.first[k] : self.first[k] + n]
        return np.interp(index, np.arange(float(n)), knots)

    def outer_arcs(self, arcs: Floats) -> Floats:
        """Return the arc lengths (m,) of the outer loop at those (m,) of the new loop that are on it."""
        result = np.empty(len(arcs))
        bounds = [*self.first[1:], len(self.arcs)]
        for k, stop in enumerate(bounds):
            begin = self.first[k] + len(self.sheets[k].front) - 1
            own = self.sheets[(k + 1) % len(self.sheets)].ends[0]
            start = float(self.arcs[begin])
            known = np.append(self.arcs[begin:stop], start + (own - start) % self.outer.length)
            knots = self.loop.curve.knots
            at = np.append(knots[begin:stop], knots[stop] if stop < len(knots) else self.loop.length)
            on = (arcs >= at[0]) & (arcs <= at[-1])
            result[on] = np.interp(arcs[on], at, known)
        return np.asarray(np.mod(result, self.outer.length))
