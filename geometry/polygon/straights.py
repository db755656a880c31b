"""Where a drawn outline is straight or has kinks that a curve through few of its points would round off."""

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, norms, rolled
from meshonet.geometry.polygon.corners import FEW, turning
from meshonet.geometry.ties import EQUAL

LONG = 4.0  # an interval at least this many times as long as its neighbour on a side may be a straight line
EXPLAINED = 1.25  # largest turn beside a straight line, in those of the circle through the next three points
LEAST = np.radians(2.0)  # radians: a smaller turn is no kink
ALONE = 20.0  # a turn that is this many times as large as both neighbouring ones is a kink
_ROUNDING = np.radians(0.1)  # turns of rounded coordinates


def find_kinks(points: Floats, *, few: int = FEW) -> Indices:
    """Return the ascending indices of kinks of an open polygon `points` (n, 2); corners may be among them.

    A turn of more than 2 degrees is a kink if it is 20 times as large as both neighbouring turns. All turns
    of more than 2 degrees are kinks in a zigzag: a polygon of at most `few` points with two successive turns
    in opposite directions, both at least half of the largest turn.
    """
    turn = turning(points)
    size = np.abs(turn)
    beside = np.maximum(rolled(size, 1), rolled(size, -1))  # the ends turn by 0
    kinks = size > ALONE * beside
    if len(points) <= few:
        back = turn[:-1] * turn[1:] < 0.0
        kinks |= (back & (np.minimum(size[:-1], size[1:]) > (0.5 - EQUAL) * size.max())).any()
    return np.flatnonzero(kinks & (size > LEAST))


def straight_intervals(points: Floats, corners: Indices) -> Bools:
    """Return which edges (n,) of a closed polygon `points` (n, 2) are straight lines, not chords of a curve.

    Such an edge is at least 4 times as long as an adjacent edge, with no corner between the two. At either
    end, unless it is a corner, the edge is nearly tangent to the circular arc through this end and the next
    two points outside the edge. `corners` are indices of points.
    """
    turn, joined = turning(points, closed=True), np.ones(len(points), dtype=bool)
    turn[corners], joined[corners] = 0.0, False
    length = norms(rolled(points, -1) - points)
    many = length * (1.0 + EQUAL) / LONG
    long = joined & (many >= rolled(length, 1)) | rolled(joined, -1) & (many >= rolled(length, -1))
    share = length / (length + rolled(length, -1))  # of the turn at the end of the interval
    after = rolled(turn, -1) * share  # half angle of the arc that begins at each point
    before = rolled(turn, 1) * rolled(1.0 - share, 2)
    return np.asarray(long & _explained(turn, before) & rolled(_explained(turn, after), -1))


def _explained(turn: Floats, half: Floats) -> Bools:
    way = np.where(half < 0.0, -turn, turn)
    return np.asarray((way >= -_ROUNDING) & (way <= EXPLAINED * np.abs(half) + _ROUNDING))
