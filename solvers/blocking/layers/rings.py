"""Rings of layers around the loops of a domain: marched from the wall, limited by the gaps.

The front, their outer edge, is a loop that replaces the wall when the rest of the domain is decomposed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, arc_parts, norms
from meshonet.geometry.cached import cached_property
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import wall_gaps
from meshonet.geometry.domain.loop import Loop
from meshonet.kernels._native import nearest_points
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import Mirror
from meshonet.solvers.blocking.layers.marched import GAP_PART, fitted
from meshonet.solvers.blocking.layers.wall_columns import nearest_arc, wall_columns
from meshonet.solvers.hyperbolic.settings import ATTEMPTS
from meshonet.solvers.layers.even_line import FINER, SLACK, Measures

FILLED = 0.85
"""Largest part of a gap that the rings of both walls fill; without sharp edges they fill twice `GAP_PART`."""
THICKNESS, COLUMNS = 0.018, 140
"""Thickness of layers where there is room, and the inverse length of the longest cells, by loop length."""
_SAMPLES = 2000  # points of a wall from which distances are measured


@dataclass(frozen=True, eq=False)
class Ring:
    """Layers around a boundary loop, made of columns (lines of nodes from the wall outwards).

    Parameters
    ----------
    wall : the loop.
    arcs : (n,) ascending arc lengths on the wall at which columns start, the first at a corner if there is
        one.
    levels : (n, m, 2) nodes of each column, from the wall to the front (the outer edge of the layers).
    front : the front as a loop with a point for each column. It has a corner where the wall has one.
    """

    wall: Loop
    arcs: Floats
    levels: Floats
    front: Loop

    @property
    def thickness(self) -> Floats:
        """(n,) lengths of the lines of nodes from the wall to the outer edge."""
        return np.asarray(norms(np.diff(self.levels, axis=1)).sum(axis=1))

    def columns(self, places: Floats) -> tuple[Floats, Floats]:
        """Return lines (k, m, 2) from the wall to the outer edge, and the arc lengths (k,) of their starts.

        The lines end at the arc lengths `places` (k,) on the outer edge. Each is interpolated by cubics from
        four lines of nodes, but never across a corner.
        """
        n = len(self.arcs)
        knots = np.append(self.front.curve.knots, self.front.length)
        index = np.interp(np.mod(places, self.front.length), knots, np.arange(n + 1.0))
        near = np.round(index)
        index = np.where(np.abs(index - near) < 1e-7, near, index)  # whole numbers but for round-off
        low, high = self._piece(np.minimum(index.astype(np.intp), n - 1))
        weights, first = column_weights(index, low, high)
        nodes = np.zeros((len(places), *self.levels.shape[1:]))
        for k in range(4):
            nodes += weights[:, k, None, None] * self.levels[(first + k) % n]
        starts = (
            monotone_cubic(np.arange(-1.0, n + 2.0), self._unwrapped(), np.clip(index, 0.0, n))
            % self.wall.length
        )
        exact = index == np.round(index)
        starts[exact] = self.arcs[index[exact].astype(np.intp) % n]
        return started(nodes, self.wall.at(starts)), starts

    @cached_property
    def along(self) -> Measures:
        """Arc lengths of outer edge, wall and first line above the wall, by position along the outer edge."""
        n = len(self.arcs)
        index = np.arange(FINER * n + 1) / FINER
        knots = np.append(self.front.curve.knots, self.front.length)
        wall = monotone_cubic(np.arange(-1.0, n + 2.0), self._unwrapped(), index)
        level = self.levels[:, 1]
        step = np.hypot(*(np.roll(level, -1, axis=0) - level).T)
        around = np.cumsum(np.concatenate([[0.0], step[-1:], step, step[:1]]))
        above = monotone_cubic(np.arange(-1.0, n + 2.0), around, index)
        front = np.interp(index, np.arange(n + 1.0), knots)
        return Measures(front, np.stack([front, wall - wall[0], above - above[0]]), SLACK)

    def _unwrapped(self) -> Floats:
        """Return ascending arc lengths (n + 3,) of columns -1 to n + 1."""
        around = np.append(self.arcs, [self.arcs[0] + self.wall.length, self.arcs[1] + self.wall.length])
        return np.concatenate([[self.arcs[-1] - self.wall.length], around])

    def _piece(self, base: Indices) -> tuple[Indices, Indices]:
        """Return the first and last column of the stretch between corners in which a column lies."""
        n, corners = len(self.arcs), np.array(self.front.corners, dtype=np.intp)
        if len(corners) == 0:
            return base - 1, base + 2
        k = np.searchsorted(corners, base, side="right") - 1
        low = np.where(k < 0, corners[-1] - n, corners[k])
        high = np.where(k + 1 < len(corners), corners[(k + 1) % len(corners)], corners[0] + n)
        return low, high


def march_ring(
    domain: Domain, number: int, first: float, thickness: float, largest: float,
    mirrors: Sequence[Mirror] = (), before: Ring | None = None, room: Floats | None = None,
) -> Ring:  # fmt: skip
    """Return the layers around the whole loop `number`, `thickness` thick where there is room.

    `first` is the height of first cells, `largest` the greatest length of cells along the wall, both in the
    domain's unit. The layers are symmetric about `mirrors` of the loop. `room` (n,) is the largest thickness
    at the n lines of nodes of `before`, an earlier result. Raises InputError, with the position, if no layer
    fits in a gap, or if every march folds at a wall.
    """
    loop = domain.loops[number]
    own = [mirror for mirror in mirrors if mirror.loops[number] == number]
    sums = [float(mirror.sums[number]) for mirror in own]
    arcs = wall_columns(loop, largest, sums)
    images = [
        (nearest_arc(arcs, total - arcs[0], loop.length) - np.arange(len(arcs))) % len(arcs) for total in sums
    ]
    gap = GAP_PART * wall_gaps(domain, loop, arcs)
    if before is not None and room is not None:
        gap = np.minimum(gap, np.interp(arcs, before.arcs, room, period=loop.length))
    steps = [each for each in (range(1), range(1, len(own))) if own and each]
    for each in steps:
        moves = np.zeros(len(arcs))
        for k in each:
            move = (sums[k] - arcs[images[k]] - arcs) / loop.length
            moves += move - np.round(move)
        arcs = arcs + loop.length / (len(each) + 1) * moves
    for to in (*images, *images):  # turns are two images
        gap = np.minimum(gap, gap[to])
    if own:
        arcs = _at_corners(loop, arcs)

    def at(column: int) -> str:
        return place(loop, arcs[column])

    levels = fitted(loop.at(arcs), arcs, loop.length, gap, thickness, first, ATTEMPTS, place=at)
    for each in steps:
        levels = sum((own[k].images(levels[images[k]]) for k in each), start=levels) / (len(each) + 1)
    if own:
        levels[:, 0] = loop.at(arcs)
    return _ring(loop, arcs, levels)


def room_between(rings: Mapping[int, Ring]) -> dict[int, Floats]:
    """Return, by loop index, the permitted thickness (n,) of layers; inf where no other layers are close."""
    rooms = {}
    walls = {k: np.arange(_SAMPLES) / _SAMPLES * ring.wall.length for k, ring in rings.items()}
    for k, ring in rings.items():
        room = np.full(len(ring.arcs), np.inf)
        for other in (number for number in rings if number != k):
            theirs, arcs = rings[other], walls[other]
            front = np.ascontiguousarray(ring.front.curve.points)
            nearest, square = nearest_points(front, theirs.wall.at(arcs))
            gap = ring.thickness + np.sqrt(square)
            opposite = np.interp(arcs, theirs.arcs, theirs.thickness, period=theirs.wall.length)[nearest]
            tight = ring.thickness + opposite > FILLED * gap
            room = np.where(tight, np.minimum(room, GAP_PART * gap), room)
        if np.isfinite(room).any():
            rooms[k] = room
    return rooms


def mirrored(ring: Ring, loop: Loop, mirror: Mirror, total: float) -> Ring:
    """Return the mirror image of layers around `loop`; arc length s becomes arc length `total` - s."""
    arcs = _at_corners(loop, np.mod(total - ring.arcs[::-1], loop.length))
    levels = mirror.images(ring.levels[::-1])
    levels[:, 0] = loop.at(arcs)
    first = -int(np.argmin(arcs))
    return _ring(loop, np.roll(arcs, first), np.roll(levels, first, axis=0))


def _at_corners(loop: Loop, arcs: Floats) -> Floats:
    """Return arc lengths (n,), the nearest ones moved to the corners of a loop."""
    arcs = arcs.copy()
    for corner in loop.corner_arcs.tolist():
        arcs[nearest_arc(arcs, corner, loop.length)] = corner
    return arcs


def place(loop: Loop, arc: float) -> str:
    """Return the name and the coordinates of a point on a loop, for messages."""
    x, y = loop.at(np.array([arc]))[0]
    return f"{loop.name_at(float(arc))}, ({x:.6g}, {y:.6g})"


def _ring(loop: Loop, arcs: Floats, levels: Floats) -> Ring:
    corners = np.flatnonzero(np.isin(arcs, loop.corner_arcs))
    if len(corners):  # from a corner on, so that pieces between corners do not wrap
        arcs, levels = np.roll(arcs, -corners[0]), np.roll(levels, -corners[0], axis=0)
        corners = corners - corners[0]
        arcs = np.where(arcs < arcs[0], arcs + loop.length, arcs)
    curve = Curve(levels[:, -1], closed=True, corners=())
    front = Loop(curve, tuple(int(k) for k in corners), (loop.names[0],))
    return Ring(loop, arcs, levels, front)


def column_weights(index: Floats, low: Indices, high: Indices) -> tuple[Floats, Indices]:
    """Return weights (k, 4) of four neighbouring columns of nodes, and the index (k,) of the first of them.

    They interpolate at positions `index` (k,), counted in columns, and use only columns `low` to `high` (k,).
    """
    first = np.clip(index.astype(np.intp) - 1, low, np.maximum(high - 3, low))
    width = np.minimum(high - first, 3)
    offset = index - first
    weights = np.zeros((len(index), 4))
    for k in range(4):
        weight = np.ones(len(index))
        for knot in range(4):
            if knot != k:
                used = (knot <= width) & (k <= width)
                weight *= np.where(used, (offset - knot) / (k - knot), 1.0)
        weights[:, k] = np.where(k > width, 0.0, weight)
    return weights, first


def started(lines: Floats, begin: Floats) -> Floats:
    """Return lines (k, m, 2) moved to start at `begin` (k, 2); their last nodes do not move."""
    moved = lines + (1.0 - arc_parts(lines))[..., None] * (begin - lines[:, 0])[:, None]
    moved[:, 0] = begin
    return np.asarray(moved)
