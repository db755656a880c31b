"""C sheets of layers: marched from a wall with one sharp edge and from both sides of the wake behind it.

::

    outer loop |<--- wake --- edge     the march starts on wake, wall and wake, the domain on its left; its
               |---- wake -->   ) wall  front leads from one place on the outer loop to another beside it
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import gaps_in_front, wall_points
from meshonet.geometry.domain.grading import graded
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.column_weights import column_weights, line_lengths, started, whole_columns
from meshonet.solvers.blocking.even_line import FINER, SLACK, Measures
from meshonet.solvers.blocking.free_wake import Wake
from meshonet.solvers.blocking.marched import GAP_PART, SLOPE, THINNER, TRIES, marched
from meshonet.solvers.blocking.wall_columns import wall_columns
from meshonet.solvers.hyperbolic.settings import OPEN_ATTEMPTS

SPREAD = 0.03
"""By how much the sheet thickens along the wake."""
WAKE_GROWTH, WAKE_LARGEST = 1.1, 1.0 / 15.0
"""Ratio of neighbouring columns along the wake, and the largest, in chords."""
OPENING, NEAR = 5.0, 0.3
"""First cells x chords behind the edge are higher than at the wall by 1 + 5 x²/(x + 0.3)."""
_MARGIN = 0.3
OUTLET = 0.5
"""Chords around the end of the wake in which the outer loop is not in the way."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """Layers along wake, wall and wake.

    Parameters
    ----------
    number : of the loop.
    wall : the loop.
    levels : (n, m, 2) nodes from wake and wall (0) to the front (m - 1).
    edge : number of the column at which the wall begins; it ends as many before the last.
    arcs : (n,) where columns start: arc lengths of the wall, rising, and of the wake from the edge.
    opening : (n,) how much higher than at the wall first cells are.
    ends : arc lengths of the outer loop at which the front begins and ends; between them lies the wake's.
    """

    number: int
    wall: Loop
    levels: Floats
    edge: int
    arcs: Floats
    opening: Floats
    ends: tuple[float, float]
    out: float

    @cached_property
    def front(self) -> Floats:
        """(n, 2) the nodes of the last level."""
        return np.ascontiguousarray(self.levels[:, -1])

    @property
    def front_corners(self) -> tuple[int, ...]:
        """Its ends, and the columns at the edge."""
        last = len(self.levels) - 1
        return (0, self.edge, last - self.edge, last)

    @property
    def front_names(self) -> tuple[str, ...]:
        """That of the wall."""
        return (self.wall.names[0],) * 3

    @property
    def margins(self) -> tuple[float, float]:
        """Lengths of the outer loop beside the front in which it has no points."""
        return (_MARGIN * (self.ends[1] - self.ends[0]),) * 2

    @property
    def joined(self) -> tuple[bool, bool]:
        """Fronts of sheets begin and end on the outer loop."""
        return False, False

    @property
    def thickness(self) -> Floats:
        """(n,) lengths of the columns."""
        return line_lengths(self.levels)

    def along(self, front: Floats) -> Measures:
        """Return what rises along the columns by their numbers: arc lengths of three levels.

        Those of the front, `front` (n,), of wake and wall, and of the level next to them.
        """
        n = len(self.levels)
        index = np.arange(FINER * (n - 1) + 1) / FINER
        values = [np.interp(index, np.arange(float(n)), front)]
        for level in (self.levels[:, 0], self.levels[:, 1]):
            arcs = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(level, axis=0).T))])
            values.append(monotone_cubic(np.arange(float(n)), arcs, index))
        return Measures(index, np.stack(values), SLACK)

    def columns(self, index: Floats, start: Floats) -> tuple[Floats, Floats]:
        """Return lines (k, m, 2) at column numbers (k,), which need not be whole, and their openings.

        They begin at the columns `start` (k,) of wake and wall.
        """
        weights, rows = self._cubics(index)
        nodes = (weights[:, :, None, None] * self.levels[rows]).sum(axis=1)
        opening = exp((weights * log(self.opening[rows])).sum(axis=1))
        return started(nodes, self.begin(start)), opening

    def begin(self, index: Floats) -> Floats:
        """Return the points (k, 2) of wake and wall at column numbers (k,)."""
        weights, rows = self._cubics(index)
        points = (weights[:, :, None] * self.levels[rows, 0]).sum(axis=1)
        on = self.on_wall(index)
        points[on] = self.wall.at(self.wall_arcs(index[on]))
        return points

    def on_wall(self, index: Floats) -> NDArray[np.bool_]:
        """Return which (k,) of columns are on the wall."""
        return np.asarray((index >= self.edge) & (index <= len(self.arcs) - 1 - self.edge))

    def wall_arcs(self, index: Floats) -> Floats:
        """Return the arc lengths (k,) of the wall at columns (k,) that are on it."""
        weights, rows = self._cubics(index)
        arcs = (weights * self.arcs[rows]).sum(axis=1)
        exact = index == np.round(index)
        arcs[exact] = self.arcs[index[exact].astype(np.intp)]
        return np.asarray(np.mod(arcs, self.wall.length))

    def _cubics(self, index: Floats) -> tuple[Floats, Indices]:
        """Return weights (k, 4) and rows (k, 4) of columns that do not reach over the edge."""
        n, edge = len(self.levels), self.edge
        index = whole_columns(index)
        base = np.minimum(index.astype(np.intp), n - 2)
        low = np.where(base < edge, 0, np.where(base < n - 1 - edge, edge, n - 1 - edge))
        high = np.where(base < edge, edge, np.where(base < n - 1 - edge, n - 1 - edge, n - 1))
        weights, first = column_weights(index, low, high)
        return weights, np.minimum(first[:, None] + np.arange(4), n - 1)


def march_sheet(
    domain: Domain, number: int, wake: Wake, outer: Loop, first: float, thickness: float, largest: float
) -> Sheet | None:
    """Return the sheet around a loop and its wake, as thick as `thickness` where there is room, or None."""
    loop = domain.loops[number]
    arcs = wall_columns(loop, largest)
    arcs = np.roll(arcs, -int(np.argmin(np.abs(arcs - loop.corner_arcs[0]))))
    arcs = np.append(np.where(arcs < arcs[0], arcs + loop.length, arcs), arcs[0] + loop.length)
    behind, line = _wake_columns(wake, float(min(arcs[1] - arcs[0], arcs[-1] - arcs[-2])))
    edge = len(behind) - 1
    start = np.concatenate([line[:0:-1], loop.at(arcs), line[1:]])
    chords = np.concatenate([behind[:0:-1], np.zeros(len(arcs)), behind[1:]]) / wake.chord
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(start, axis=0).T))])
    tangent = np.gradient(start, along, axis=0)
    tangent[edge], tangent[-1 - edge] = start[edge + 1] - start[edge], start[-1 - edge] - start[-2 - edge]
    tangent /= np.hypot(*tangent.T)[:, None]
    walls = wall_points(domain.loops)
    walls = walls[np.hypot(*(walls - line[-1]).T) > OUTLET * wake.chord]
    room = GAP_PART * gaps_in_front(walls, start, tangent)
    ends = outer.tangent(np.array([wake.arc]))[0]
    for _ in range(TRIES):
        thick = thickness + SPREAD * chords * wake.chord
        wanted = graded(np.minimum(thick, room), along, 4.0 * along[-1], SLOPE)
        if wanted.min() < max(4.0 * first, 0.1 * thickness):
            return None
        levels, folded = marched(start, wanted, first, OPEN_ATTEMPTS, np.stack([-ends, ends]))
        if levels is not None and not folded.any():
            return _sheet(domain, number, wake, outer, levels, edge, arcs, behind, chords)
        thickness *= THINNER
    return None


def _sheet(
    domain: Domain, number: int, wake: Wake, outer: Loop, levels: Floats, edge: int, arcs: Floats,
    behind: Floats, chords: Floats,
) -> Sheet | None:  # fmt: skip
    """Return the sheet of levels (n, m, 2) whose ends are put on the outer loop."""
    heights = []
    for column, way in ((0, -1.0), (-1, 1.0)):
        away = np.hypot(*(levels[column] - levels[column, 0]).T)
        levels[column] = outer.at(wake.arc + way * away)
        heights.append(float(away[-1]))
    gap = np.abs(np.mod(outer.corner_arcs - wake.arc + 0.5 * outer.length, outer.length) - 0.5 * outer.length)
    if len(gap) and gap.min() < 4.0 * max(heights):
        return None
    places = np.concatenate([behind[:0:-1], arcs, behind[1:]])
    opening = 1.0 + OPENING * chords**2 / (chords + NEAR)
    ends = wake.arc - heights[0], wake.arc + heights[1]
    return Sheet(number, domain.loops[number], levels, edge, places, opening, ends, wake.arc)


def _wake_columns(wake: Wake, first: float) -> tuple[Floats, Floats]:
    """Return arc lengths (k,) along the wake, and points (k, 2) there."""
    curve = Curve(wake.points, corners=())
    steps, total = [first], first
    while total < curve.length:
        steps.append(min(steps[-1] * WAKE_GROWTH, WAKE_LARGEST * wake.chord))
        total += steps[-1]
    arcs = np.concatenate([[0.0], np.cumsum(steps)])
    rise = np.linspace(0.0, 1.0, len(arcs)) ** 2  # the first cells stay as they are
    arcs *= 1.0 + rise * (curve.length / arcs[-1] - 1.0)
    arcs[-1] = curve.length
    return arcs, curve.at(arcs)
