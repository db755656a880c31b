"""Strips of layers along stretches of walls that end at convex corners.

::

        front of one | Q             Q: where the fronts of two strips meet; a, b: where their columns through
        _ _ _ _ _ _ _|_ _ _ _       it start. Between them and the corner P lies a block of its own.
        front of the |
        other        | a             A strip that ends alone ends on what lies beyond the corner: its last
        ---------- P-+-------        column there follows the loop.
                     b
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, complex_of
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import gaps_in_front, wall_points
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.column_weights import column_weights, line_lengths, started, whole_columns
from meshonet.solvers.blocking.marched import GAP_PART, fitted
from meshonet.solvers.blocking.rings import place
from meshonet.solvers.blocking.stretches import Stretch
from meshonet.solvers.blocking.wall_columns import wall_columns
from meshonet.solvers.hyperbolic.settings import ATTEMPTS

REACH = 5.0
"""Thicknesses from a corner up to which the wall beyond is not in front of a strip."""
_MARGIN = 0.1  # of its thickness: the loop has no other points so near to where a front ends
_ALONG = 3.0  # thicknesses of wall in which columns go along with the last one
_SHARED = 0.4  # of a column of cells: columns nearer than this to one that is put in are left out
_SAMPLES = 2000  # of the loop, where gaps are looked for
_FINER = 8


@dataclass(frozen=True, eq=False)
class Strip:
    """Layers along a stretch of a wall.

    Parameters
    ----------
    stretch : which it is.
    wall : the loop.
    arcs : (n,) places on it where the columns of `levels` start, ascending; they may pass its length.
    levels : (n, m, 2) nodes from the wall (0) to the front (m - 1).
    heights : lengths of the loop beyond its ends that the first and last column cover, 0 where it is joined.
    """

    stretch: Stretch
    wall: Loop
    arcs: Floats
    levels: Floats
    heights: tuple[float, float] = (0.0, 0.0)

    @property
    def front(self) -> Floats:
        """(n, 2) the nodes of the last level."""
        return np.ascontiguousarray(self.levels[:, -1])

    @property
    def thickness(self) -> Floats:
        """(n,) lengths of the columns."""
        return line_lengths(self.levels)

    @cached_property
    def sharp(self) -> Indices:
        """Columns at corners of the wall, but for the first and the last column."""
        inner = np.isin(np.mod(self.arcs, self.wall.length), self.wall.corner_arcs)
        inner[[0, -1]] = False
        return np.flatnonzero(inner)

    @property
    def front_corners(self) -> tuple[int, ...]:
        """Its ends, and the columns at corners of the wall."""
        return (0, *self.sharp.tolist(), len(self.levels) - 1)

    @property
    def front_names(self) -> tuple[str, ...]:
        """Those of the wall."""
        middles = [0.5 * (self.arcs[i] + self.arcs[i + 1]) for i in self.front_corners[:-1]]
        return tuple(self.wall.name_at(float(arc)) for arc in middles)

    @property
    def ends(self) -> tuple[float, float]:
        """Arc lengths of the loop at which the front begins and ends; at the corners where it is joined."""
        begin, end = self.stretch.span(self.wall)
        return begin - self.heights[0], end + self.heights[1]

    @property
    def margins(self) -> tuple[float, float]:
        """Lengths beside the front in which the loop has no other points."""
        return _MARGIN * self.heights[0], _MARGIN * self.heights[1]

    @property
    def joined(self) -> tuple[bool, bool]:
        """Whether the front begins, and ends, where that of another strip does."""
        return self.stretch.joined

    def columns(self, index: Floats) -> tuple[Floats, Floats]:
        """Return the lines (k, m, 2) at column numbers (k,), and where they start: arc lengths (k,)."""
        index = whole_columns(index)
        bounds = np.array(self.front_corners)
        piece = np.clip(np.searchsorted(bounds, index, side="right") - 1, 0, len(bounds) - 2)
        weights, first = column_weights(index, bounds[piece], bounds[piece + 1])
        rows = np.minimum(first[:, None] + np.arange(4), len(self.levels) - 1)
        nodes = (weights[:, :, None, None] * self.levels[rows]).sum(axis=1)
        starts = self.starts(index)
        return started(nodes, self.wall.at(starts)), starts

    def starts(self, index: Floats) -> Floats:
        """Return the arc lengths (k,) of the wall at column numbers (k,)."""
        arcs = monotone_cubic(np.arange(float(len(self.arcs))), self.arcs, index)
        exact = index == np.round(index)
        arcs[exact] = self.arcs[index[exact].astype(np.intp)]
        return np.asarray(np.mod(arcs, self.wall.length))

    @property
    def along_wall(self) -> tuple[Floats, Floats]:
        """Column numbers (m,) and arc lengths (m,) of the wall there, from 0."""
        n = len(self.arcs)
        index = np.arange(_FINER * (n - 1) + 1) / _FINER
        return index, monotone_cubic(np.arange(float(n)), self.arcs, index) - self.arcs[0]

    def cut_off(self, index: float, point: Floats, at_end: bool) -> Strip:
        """Return the strip without the columns before a column number, or behind it.

        Its first, or last, column then leads to `point`.
        """
        lines, _ = self.columns(np.array([index]))
        new = lines[0]
        step = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(new, axis=0).T))])
        new = new + (step / step[-1])[:, None] * (point - new[-1])
        new[-1] = point
        n = len(self.arcs)
        arc = monotone_cubic(np.arange(float(n)), self.arcs, np.array([index]))
        if at_end:
            keep = np.arange(n) < index - _SHARED
            parts = (self.levels[keep], new[None]), (self.arcs[keep], arc)
        else:
            keep = np.arange(n) > index + _SHARED
            parts = (new[None], self.levels[keep]), (arc, self.arcs[keep])
        return replace(self, levels=np.concatenate(parts[0]), arcs=np.concatenate(parts[1]))


def march_strip(domain: Domain, stretch: Stretch, first: float, thickness: float, largest: float) -> Strip:
    """Return the layers along a stretch, as thick as `thickness` where there is room.

    Where it is joined they reach up to the corner still; `joined_strips` cuts them off. `first` is the height
    of first cells, `largest` the length of cells along the wall, in the domain's unit. Raises InputError: no
    room for layers, or a wall that every march folds at; with the place.
    """
    loop = domain.loops[stretch.loop]
    begin, end = stretch.span(loop)
    arcs = wall_columns(loop, largest)
    arcs = np.concatenate([arcs, arcs + loop.length])
    arcs = np.concatenate([[begin], arcs[(arcs > begin) & (arcs < end)], [end]])
    tangent = loop.tangent(arcs)
    tangent[-1] = loop.tangent(np.array([end - _inside(loop)]))[0]
    room = GAP_PART * _gaps(domain, stretch, thickness, arcs, tangent)
    room[[0, -1]] = np.minimum(room[[0, -1]], _room_beyond(loop, stretch))
    places = np.minimum(arcs, end - _inside(loop))  # the last is not yet what follows
    levels = fitted(
        loop.at(arcs), arcs, 4.0 * arcs[-1], room, thickness, first, ATTEMPTS,
        place=lambda k: place(loop, float(places[k])), ends=_ways(loop, stretch, tangent),
    )  # fmt: skip
    strip = Strip(stretch, loop, arcs, levels)
    return _on_loop(strip)


def _inside(loop: Loop) -> float:
    return 1e-7 * loop.length


def _gaps(domain: Domain, stretch: Stretch, thickness: float, arcs: Floats, tangent: Floats) -> Floats:
    """Return the gaps (n,) in front of columns, but to what lies beyond the nearer end of the stretch."""
    loop = domain.loops[stretch.loop]
    begin, end = stretch.span(loop)
    own = np.linspace(0.0, loop.length, _SAMPLES, endpoint=False)
    points = loop.at(own)
    others = [each for k, each in enumerate(domain.loops) if k != stretch.loop]
    rest = wall_points(others) if others else np.empty((0, 2))
    reach = REACH * thickness
    ahead, back = np.mod(own - end, loop.length) < reach, np.mod(begin - own, loop.length) < reach
    outside = np.mod(own - begin, loop.length) > end - begin
    later = arcs > 0.5 * (begin + end)
    gaps = np.empty(len(arcs))
    for half, near, far in ((~later, back, ahead), (later, ahead, back)):
        walls = np.concatenate([points[~(near | (far & outside))], rest])
        gaps[half] = gaps_in_front(walls, loop.at(arcs[half]), tangent[half])
    return gaps


def _room_beyond(loop: Loop, stretch: Stretch) -> Floats:
    """Return how thick (2,) layers may be at the ends of a stretch, by what lies beyond these."""
    count, room = len(loop.corners), []
    for corner, way, joined in ((stretch.first, -1, stretch.joined[0]), (stretch.last, 1, stretch.joined[1])):
        k = (corner + way) % count
        while loop.corner_cells[k] == 2 and k != corner:
            k = (k + way) % count
        length = way * (loop.corner_arcs[k] - loop.corner_arcs[corner]) % loop.length or loop.length
        angle = float(np.radians(loop.corner_angles[corner]))
        room.append(GAP_PART * length * (math.tan(0.5 * angle) if joined else 1.0))
    return np.array(room)


def _ways(loop: Loop, stretch: Stretch, tangent: Floats) -> Floats:
    """Return directions (2, 2) of the first and last column: along the loop, or normal to the wall."""
    begin, end = stretch.span(loop)
    along = loop.tangent(np.array([begin - _inside(loop), end]))
    normal = np.stack([-tangent[[0, -1], 1], tangent[[0, -1], 0]], axis=1)
    ways = np.stack([-along[0], along[1]])
    return np.where(np.array(stretch.joined)[:, None], normal, ways)


def _on_loop(strip: Strip) -> Strip:
    """Return a strip whose ends that are not joined lie on the loop, columns near them moved along."""
    levels, heights = strip.levels.copy(), [0.0, 0.0]
    begin, end = strip.stretch.span(strip.wall)
    for side, corner, way in ((0, begin, -1.0), (1, end, 1.0)):
        if strip.joined[side]:
            continue
        column = levels[-side]
        away = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(column, axis=0).T))])
        new = strip.wall.at(corner + way * away)
        left = np.maximum(1.0 - np.abs(strip.arcs - corner) / (_ALONG * away[-1]), 0.0) ** 2
        levels += left[:, None, None] * (new - column)
        levels[-side], heights[side] = new, float(away[-1])
    return replace(strip, levels=levels, heights=(heights[0], heights[1]))


def joined_strips(strips: Sequence[Strip]) -> list[Strip]:
    """Return the strips of a loop, cut off where their fronts meet.

    Raises InputError: they do not meet, or do so beyond a short wall.
    """
    cut = list(strips)
    begins: dict[int, tuple[float, Floats]] = {}
    for k, strip in enumerate(strips):
        if not strip.joined[1]:
            continue
        after = next(i for i, each in enumerate(strips) if each.stretch.first == strip.stretch.last)
        meeting = _crossing(strip.front, strips[after].front, k == after)
        if meeting is None:
            raise InputError(
                "layers of two walls do not meet in their corner", "use thinner first cells, or one wall's",
                place=place(strip.wall, strip.stretch.span(strip.wall)[1]),
            )  # fmt: skip
        index, begin, point = meeting
        cut[k] = strip.cut_off(index, point, at_end=True)
        begins[after] = begin, point
    for k, (begin, point) in begins.items():
        cut[k] = cut[k].cut_off(begin, point, at_end=False)
        if len(cut[k].arcs) < 2:
            raise InputError(
                "the wall is too short for the layers of those beside it",
                "use thinner first cells, or leave its layers out",
                place=place(strips[k].wall, strips[k].stretch.span(strips[k].wall)[0]),
            )
    return cut


def _crossing(first: Floats, second: Floats, same: bool) -> tuple[float, float, Floats] | None:
    """Return where a front (n, 2) crosses one (m, 2) that follows it, nearest to the corner between them.

    That is a place on each, by number of its nodes, and the point. `same` says that both are one front.
    """
    p, q = (complex_of(line) for line in (first, second))
    i, j = np.arange(len(p) - 1)[:, None], np.arange(len(q) - 1)
    along, across, apart = np.diff(p)[:, None], np.diff(q), q[:-1] - p[:-1, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        turned = (np.conj(along) * across).imag
        at = (np.conj(apart) * across).imag / turned
        beside = (np.conj(apart) * along).imag / turned
    cross = (at >= 0.0) & (at <= 1.0) & (beside >= 0.0) & (beside <= 1.0)
    if same:
        cross &= i > j + 1
    if not cross.any():
        return None
    k, m = np.unravel_index(int(np.where(cross, j - i, len(p) + len(q)).argmin()), cross.shape)
    part = float(at[k, m])
    return k + part, m + float(beside[k, m]), first[k] + part * (first[k + 1] - first[k])
