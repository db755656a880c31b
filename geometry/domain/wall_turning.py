"""Curvature and turning angles of walls between two points, and the corners there."""

from functools import lru_cache

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, distinct, running_sums
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import arctan2
from meshonet.geometry.polygon.corners import turning

SAMPLES, _WINDOW = 400, 3  # points around a loop, and those on either side over which its bend is averaged


@lru_cache(maxsize=64)
def _table(loop: Loop) -> tuple[Floats, Floats]:
    """Return the arc lengths (n + 1,) of a loop's points, and its absolute turning (degrees) up to each."""
    at = np.abs(np.degrees(turning(loop.curve.points, closed=True)))
    at[list(loop.corners)] = 0.0
    along = 0.5 * (at + np.roll(at, -1))
    return np.append(loop.curve.knots, loop.length), np.concatenate([[0.0], np.cumsum(along)])


def turning_between(loop: Loop, first: Floats, last: Floats) -> Floats:
    """Return the angles (k,) in degrees by which a loop turns between arc lengths, corners left out.

    They are integrals of |curvature| from arc length `first` (k,) to `last` (k,).
    """
    arcs, turned = _table(loop)
    return _turned(loop, last, arcs, turned) - _turned(loop, first, arcs, turned)


def _turned(loop: Loop, arc: Floats, arcs: Floats, turned: Floats) -> Floats:
    rounds = np.floor(arc / loop.length)
    return np.asarray(np.interp(arc - rounds * loop.length, arcs, turned) + rounds * turned[-1])


def corners_between(loop: Loop, first: float, last: float) -> tuple[Floats, Indices]:
    """Return the arc lengths of corners between two arc lengths, and how many cells should meet at each."""
    low, high = min(first, last), max(first, last)
    rounds = np.floor(low / loop.length) + np.arange(3)
    arcs = (loop.corner_arcs + rounds[:, None] * loop.length).ravel()
    cells = np.tile(loop.corner_cells, 3)
    slack = 1e-9 * loop.length
    inside = np.flatnonzero((arcs > low + slack) & (arcs < high - slack))
    if last < first:
        inside = inside[::-1]
    return arcs[inside], cells[inside]


def sizes_by_bend(loop: Loop, largest: float, turn: float) -> tuple[Floats, Floats]:
    """Return arc lengths (n,) around a loop, including its corners, and the cell length (n,) at each.

    Cells are at most `largest` long, and the wall turns by at most `turn` radians along a cell.
    """
    arcs = distinct(np.append(np.linspace(0.0, loop.length, SAMPLES, endpoint=False), loop.corner_arcs))
    return arcs, np.minimum(largest, turn / np.maximum(wall_bend(loop, arcs, _WINDOW), 1e-300))


def wall_bend(loop: Loop, arcs: Floats, window: int) -> Floats:
    """Return the absolute curvature (n,) of a loop at ascending arc lengths (n,), in radians per length.

    It is averaged over `window` points before and behind each point. Corners, which must be among `arcs`, do
    not count.
    """
    along = loop.tangent(arcs)
    direction = arctan2(along[:, 1], along[:, 0])
    turn = np.diff(direction, append=direction[:1])
    turn = np.abs((turn + np.pi) % (2.0 * np.pi) - np.pi)
    turn[np.searchsorted(arcs, loop.corner_arcs) - 1] = 0.0
    step = np.diff(arcs, append=arcs[0] + loop.length)
    around = np.arange(-window, len(arcs) + window) % len(arcs)
    return running_sums(turn[around], 2 * window + 1) / running_sums(step[around], 2 * window + 1)
