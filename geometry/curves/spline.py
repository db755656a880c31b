"""Slopes of a spline through points, by chord length: C2 where possible, else limited.

At a kink a tangent stays between the chords on both sides; beside a step, two points close together that turn
one way and back, it stays near the longer chord, or there would be a bulge.
"""

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, distinct, rolled
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import angle_between, turning
from meshonet.kernels._native import solve_tridiagonal

SLACK = 0.25  # how far a tangent may lie outside the angle between its chords, in parts of the turns nearby
LEAST_SLACK = np.radians(0.5)  # where chords hardly turn
LONGEST = 2.0  # largest size of a slope: a longer one makes a loop or a cusp


def spline_slopes(
    points: Floats, *, closed: bool, corners: Indices, tangent: Bools | None = None
) -> tuple[Floats, Floats]:
    """Return the slopes (intervals, 2) of a curve at the start and at the end of each interval.

    Between `corners` (indices of points) the curve is a cubic spline, which is limited to avoid overshoots
    (see `limited`). In intervals beside a corner it is quadratic. Intervals in the mask `tangent` (n,) are
    straight lines, to which neighbouring splines are tangent. A closed curve does not repeat its first point.
    """
    if tangent is not None and tangent.any():
        return _beside_lines(points, corners, tangent)
    n, shift = len(points), int(corners[0]) if closed and corners.size else 0
    ring = rolled(points, -shift)
    chord = np.diff(ring, axis=0, append=ring[:1]) if closed else np.diff(ring, axis=0)
    h = np.hypot(chord[:, 0], chord[:, 1])
    if closed and not corners.size:
        start = periodic_slopes(chord, h)
        stop = rolled(start, -1)
    else:
        stops = np.append(corners - shift, n) if closed else distinct(np.concatenate([[0], corners, [n - 1]]))
        start, stop = open_slopes(chord, h, stops)
        start, stop = rolled(start, shift), rolled(stop, shift)
    return limited(points, start, stop, closed=closed, corners=corners)


def _beside_lines(points: Floats, corners: Indices, tangent: Bools) -> tuple[Floats, Floats]:
    """Return the slopes of a closed curve with straight intervals."""
    n = len(points)
    ends = distinct(np.concatenate([corners, np.flatnonzero(tangent | rolled(tangent, 1))]))
    shift = int(ends[0])
    chord = rolled(points, -1) - points
    h = np.hypot(chord[:, 0], chord[:, 1])
    line = chord / h[:, None]
    smooth = np.ones(n, dtype=bool)
    smooth[corners] = False
    begins, stops = smooth & rolled(tangent, 1) & ~tangent, rolled(smooth & tangent, -1) & ~tangent
    held = np.full((2, n, 2), np.nan)  # slopes at the start and at the end of intervals beside a line
    held[0, begins], held[1, stops] = rolled(line, 1)[begins], rolled(line, -1)[stops]
    start, stop = open_slopes(
        rolled(chord, -shift), rolled(h, -shift), np.append(ends - shift, n), np.roll(held, -shift, axis=1)
    )
    start, stop = limited(points, rolled(start, shift), rolled(stop, shift), closed=True, corners=corners)
    start[begins], stop[stops] = held[0, begins], held[1, stops]
    start[tangent], stop[tangent] = line[tangent], line[tangent]
    return start, stop


def cubics(start: Floats, chord: Floats, first: Floats, last: Floats) -> Floats:
    """Return the coefficients (4, n, d) of n cubics in t from 0 to 1, constant first.

    `start` (n, d) are the points at t = 0. `chord` (n, d) are the vectors to the points at t = 1. `first` and
    `last` (n, d) are the slopes at both ends.
    """
    return np.stack([start, first, 3 * chord - 2 * first - last, first + last - 2 * chord])


def checked_points(points: Floats, what: str, point: str, dimension: int, *, closed: bool = False) -> Floats:
    """Return `points` (n, d) of a curve as float64, without a repeated first point if the curve is `closed`.

    `what` names the curve in messages. `point`, such as ``point {}``, names a point with its index.
    `dimension` is d. Raises InputError: another shape; fewer than 2 points (closed: 3); a point that is not
    finite or equals its neighbour.
    """
    nodes = np.array(points, dtype=np.float64)
    if nodes.ndim != 2 or nodes.shape[1] != dimension:
        raise InputError(f"points of a {what} have shape {nodes.shape}", f"give (n, {dimension})")
    bad = np.flatnonzero(~np.isfinite(nodes).all(axis=1))
    if bad.size:
        raise InputError(f"{point.format(bad[0])} is not finite", "check the input for NaN or infinity")
    if closed and len(nodes) > 1 and np.array_equal(nodes[0], nodes[-1]):
        nodes = nodes[:-1]
    least, kind = (3, f"closed {what}") if closed else (2, what)
    if len(nodes) < least:
        raise InputError(f"a {kind} of {len(nodes)} points", f"give at least {least}")
    step = np.diff(nodes, axis=0, append=nodes[:1]) if closed else np.diff(nodes, axis=0)
    same = np.flatnonzero((step == 0).all(axis=1))
    if same.size:
        where = ", ".join(f"{value:.6g}" for value in nodes[same[0]])
        raise InputError(f"{point.format(same[0])} and the next are the same, ({where})", "remove one")
    return nodes


def open_slopes(
    chord: Floats, h: Floats, stops: Indices, held: Floats | None = None
) -> tuple[Floats, Floats]:
    """Return the slopes (intervals, d) at the start and at the end of each interval of an open curve.

    `stops` are indices of points, the first and the last among them. A spline joins each stop to the next.
    `chord` (intervals, d) are the vectors between points, `h` (intervals,) their lengths. `held` (2,
    intervals, d) fixes slopes: ``held[0, k]`` at the start of the spline that begins with interval k,
    ``held[1, k]`` at the end of one that ends with it. Where this slope is not fixed, or is NaN, the first
    or last interval of the spline is a parabola.
    """
    delta = chord / h[:, None]
    doubled = np.zeros(len(h) + 1, dtype=np.intp)
    doubled[stops[1:-1]] = 1
    first = np.arange(len(h)) + np.cumsum(doubled)[:-1]  # row of the slope at the start of each interval
    n = len(h) + len(stops) - 1
    lower, diagonal, upper, right = np.zeros(n), np.ones(n), np.zeros(n), np.empty((n, chord.shape[1]))
    begin, end = first[stops[:-1]], first[stops[1:] - 1] + 1
    alone = np.diff(stops) == 1  # a single interval between corners is straight
    upper[begin], lower[end] = np.where(alone, 0.0, 1.0), np.where(alone, 0.0, 1.0)
    right[begin] = np.where(alone, 1.0, 2.0)[:, None] * delta[stops[:-1]]
    right[end] = np.where(alone, 1.0, 2.0)[:, None] * delta[stops[1:] - 1]
    if held is not None:
        for slope, row, off in ((held[0, stops[:-1]], begin, upper), (held[1, stops[1:] - 1], end, lower)):
            known = np.isfinite(slope[:, 0])
            off[row[known]], right[row[known]] = 0.0, slope[known]
    smooth = np.ones(len(h) + 1, dtype=bool)
    smooth[stops] = False
    k = np.flatnonzero(smooth)
    row = first[k]
    lower[row], diagonal[row], upper[row] = h[k], 2 * (h[k - 1] + h[k]), h[k - 1]
    right[row] = 3 * (h[k, None] * delta[k - 1] + h[k - 1, None] * delta[k])
    solve_tridiagonal(lower, diagonal, upper, right)
    return right[first], right[first + 1]


def periodic_slopes(chord: Floats, h: Floats) -> Floats:
    """Return the slopes (n, d) of the periodic spline at the start of each interval.

    `chord` (n, d) are the vectors from each point to the next, `h` (n,) their lengths.
    """
    delta = chord / h[:, None]
    before = rolled(h, 1)
    lower, diagonal, upper = h.copy(), 2 * (before + h), before.copy()
    low, up, pivot = upper[-1], lower[0], -diagonal[0]
    diagonal[0] -= pivot
    diagonal[-1] -= low * up / pivot
    right = np.zeros((len(h), chord.shape[1] + 1))
    right[:, :-1] = 3 * (h[:, None] * rolled(delta, 1) + before[:, None] * delta)
    right[0, -1], right[-1, -1] = pivot, low
    solve_tridiagonal(lower, diagonal, upper, right)
    v = up / pivot
    factor = (right[0, :-1] + v * right[-1, :-1]) / (1 + right[0, -1] + v * right[-1, -1])
    return np.asarray(right[:, :-1] - right[:, -1:] * factor)


def limited(
    points: Floats, start: Floats, stop: Floats, *, closed: bool, corners: Indices
) -> tuple[Floats, Floats]:
    """Return the slopes `start` and `stop` (intervals, 2) of each interval, limited to avoid overshoots.

    Tangents stay near the directions of the two chords that meet at a point. At `corners` (indices of
    points), the curve has two tangents. A closed curve does not repeat its first point.
    """
    n = len(points)
    chord = rolled(points, -1) - points  # the last of an open curve is not used
    turn = turning(points, closed=closed)
    free = np.ones(n, dtype=bool)
    free[corners] = False
    if not closed:
        free[[0, -1]] = False
    turn[~free] = 0.0
    low, high, slack = _ranges(turn, np.hypot(chord[:, 0], chord[:, 1]))
    behind, ahead = rolled(turn, 1), rolled(turn, -1)
    to_stop = (
        np.where(free, low, np.minimum(behind, 0) - slack),
        np.where(free, high, np.maximum(behind, 0) + slack),
    )
    to_start = (
        np.where(free, low - turn, -np.maximum(ahead, 0) - slack),
        np.where(free, high - turn, -np.minimum(ahead, 0) + slack),
    )
    k = np.arange(len(start))
    start = _turned(start, chord[k], to_start[0][k], to_start[1][k])
    stop = _turned(stop, chord[k], to_stop[0][(k + 1) % n], to_stop[1][(k + 1) % n])
    inner = corners if closed else corners[(corners > 0) & (corners < n - 1)]
    return _edges_kept_open(start, stop, chord, inner)


def _ranges(turn: Floats, length: Floats) -> tuple[Floats, Floats, Floats]:
    """Return least and largest angles (n,) of tangents from the chords before, and the slack.

    Beside a step, whose ends turn in opposite directions, tangents stay near the other chord.
    """
    step_after = turn * rolled(turn, -1) < 0
    step_before = rolled(step_after, 1)
    before = rolled(length, 1)
    short = np.where(step_after, length, before)
    weight = np.where(step_after != step_before, np.minimum(1.0, 2 * short / (length + before)), 1.0)
    reach = turn * weight
    size = np.abs(reach)
    slack = SLACK * np.maximum(size, np.maximum(rolled(size, 1), rolled(size, -1))) + LEAST_SLACK
    near_after = step_before & ~step_after  # near the chord after the point: from turn - reach to turn
    low = np.where(near_after, turn - np.maximum(reach, 0), np.minimum(reach, 0)) - slack
    high = np.where(near_after, turn - np.minimum(reach, 0), np.maximum(reach, 0)) + slack
    return low, high, slack


def _edges_kept_open(start: Floats, stop: Floats, chord: Floats, corners: Indices) -> tuple[Floats, Floats]:
    """Return slopes along the chords at edges sharper than 120 degrees whose sides would cross."""
    before, after = chord[corners - 1], chord[corners]
    angle, kept = angle_between(before, after), angle_between(stop[corners - 1], start[corners])
    open_by = np.where(np.sign(kept) == np.sign(angle), np.pi - np.abs(kept), np.abs(kept) - np.pi)
    closed_up = (np.abs(angle) > np.radians(120.0)) & (open_by < 0.25 * (np.pi - np.abs(angle)))
    if not closed_up.any():
        return start, stop
    start, stop, at = start.copy(), stop.copy(), corners[closed_up]
    start[at] = chord[at] / np.hypot(chord[at, 0], chord[at, 1])[:, None]
    stop[at - 1] = chord[at - 1] / np.hypot(chord[at - 1, 0], chord[at - 1, 1])[:, None]
    return start, stop


def _turned(slope: Floats, chord: Floats, least: Floats, most: Floats) -> Floats:
    """Return slopes (n, 2) at angles from the chord from `least` to `most`, at most `LONGEST` long."""
    angle = angle_between(chord, slope)
    size = np.hypot(slope[:, 0], slope[:, 1])
    wrong = np.flatnonzero((angle < least) | (angle > most) | (size > LONGEST))
    if wrong.size == 0:
        return slope
    out = slope.copy()
    unit = chord[wrong] / np.hypot(chord[wrong, 0], chord[wrong, 1])[:, None]
    a = np.clip(angle[wrong], least[wrong], most[wrong])
    length = np.minimum(size[wrong], LONGEST)
    out[wrong, 0] = length * (unit[:, 0] * cos(a) - unit[:, 1] * sin(a))
    out[wrong, 1] = length * (unit[:, 0] * sin(a) + unit[:, 1] * cos(a))
    return out
