"""Turning angles of a polygon, and which of its points are corners."""

import math

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, along_and_across, cross2, norms, rolled
from meshonet.geometry.elementary import arctan2

KINK = np.radians(8.0)
"""Radians: a larger turn is a corner if both neighbouring points turn by less than a fifth of it."""
SHARP = np.radians(40.0)
"""Radians: a larger turn is a corner if both neighbouring turns are less than half of it or points few."""
ALWAYS = np.radians(75.0)  # radians: a larger turn is always a corner
HAIRPIN = np.radians(100.0)  # radians: a larger turn may be the round end of a thin body given by few points
WIDENS = 0.75
"""Behind an oblique base a body widens at this fraction or more of its first rate, behind a nose at half."""
ALONE = np.radians(50.0)  # turning beside a corner below which a sharp one may be a coarsely given round end
FEW = 12  # a closed polygon with at most this many points is a polygon, not a sampled curve


def angle_between(a: Floats, b: Floats) -> Floats:
    """Return the angles (...) in radians from vectors `a` to `b`; in the plane (..., 2) left is positive."""
    if a.shape[-1] == 3:
        return np.asarray(arctan2(norms(np.cross(a, b)), (a * b).sum(axis=-1)))
    return np.asarray(arctan2(cross2(a, b), a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]))


def turning(points: Floats, *, closed: bool = False) -> Floats:
    """Return the angle (n,) in radians by which a polygon `points` (n, 2) turns at each point.

    Left turns are positive; the angle is 0 at the ends of an open polygon.
    """
    ring = np.concatenate([points[-1:], points, points[:1]]) if closed else points
    step = ring[1:] - ring[:-1]
    angle = angle_between(step[:-1], step[1:])
    return angle if closed else np.concatenate([[0.0], angle, [0.0]])[: len(points)]


def find_corners(points: Floats, *, closed: bool = False, few: int = FEW) -> Indices:
    """Return the ascending indices of the points that are corners.

    A point is a corner if the polygon `points` (n, 2) turns there

    - by more than 8 degrees and five times as much as at both neighbouring points;
    - by more than 40 degrees and twice as much as at both neighbouring points;
    - by more than 75 degrees.

    Two adjacent points are both corners if the polygon turns at both by more than 40 degrees (8 degrees if
    the polygon is open), and five times as much as at the next points on both sides. So both ends of an
    oblique base (blunt trailing edge) are corners.

    The coarsely sampled round end of a thin body is no corner, even if it turns by up to 155 degrees. Near a
    round end, the thickness of the body grows like the square root of the distance, near an edge linearly;
    this tells them apart (`growth_exponent`). But a closed polygon of at most `few` points is not taken for a
    sampled curve: all its turns of more than 40 degrees are corners.
    """
    angle = np.abs(turning(points, closed=closed))
    if not angle.max() > KINK:
        return np.empty(0, np.intp)
    beside = np.empty_like(angle)
    np.maximum(angle[:-2], angle[2:], out=beside[1:-1])
    first, last = (angle[-1], angle[0]) if closed else (0.0, 0.0)
    beside[0], beside[-1] = max(first, angle[1]), max(angle[-2], last)
    polygon = closed and len(points) <= few
    sharp = (
        (angle > KINK) & (angle > 5 * beside)
        | (angle > SHARP) & (polygon | (angle > 2 * beside))
        | (angle > ALWAYS)
    )
    # two adjacent points, as at a base or a ramp, with little turning beyond them
    ahead, after = rolled(angle, -1), rolled(angle, -2)
    both = np.minimum(angle, ahead) > (SHARP if closed else KINK)
    pair = both & (rolled(angle, 1) < 0.2 * angle) & (after < 0.2 * ahead)
    sharp |= pair | rolled(pair, 1)
    if polygon:
        return np.flatnonzero(sharp)
    bases = _oblique_bases(points, angle) if closed else np.zeros(len(points), dtype=bool)
    corners = np.flatnonzero(sharp | bases)
    hairpin = (angle[corners] > HAIRPIN) | ((angle[corners] > SHARP) & (beside[corners] < ALONE))
    kept = np.ones(len(corners), dtype=bool)
    for n in np.flatnonzero(hairpin & ~bases[corners]):
        kept[n] = growth_exponent(points, int(corners[n]), closed=closed) >= 0.75
    return corners[kept]


def _oblique_bases(points: Floats, angle: Floats) -> Bools:
    """Return for each point (n,) of a closed polygon whether it is one of the two ends of an oblique base.

    One end turns by more than `HAIRPIN`, the next by more than `KINK`, both five times as much as the points
    beyond them, and the body widens at an even rate behind them, unlike behind a round end.
    """
    ahead, before, after = rolled(angle, -1), rolled(angle, 1), rolled(angle, -2)
    pair = (np.maximum(angle, ahead) > HAIRPIN) & (np.minimum(angle, ahead) > KINK)
    pair &= (before < 0.2 * angle) & (after < 0.2 * ahead)
    for k in np.flatnonzero(pair):
        pair[k] = _widens_on(points, int(k))
    return pair | rolled(pair, 1)


def _widens_on(points: Floats, k: int) -> bool:
    """Return whether a body widens at an even rate behind its points k and k + 1, not like behind a nose.

    Widths are measured across the direction from these two points to the second pair after them.
    """
    n = len(points)
    if n < 7:
        return False
    a, b = points[np.arange(k, k - 3, -1) % n], points[np.arange(k + 1, k + 4) % n]
    middle = 0.5 * (a + b) - 0.5 * (a[0] + b[0])
    axis = middle[2] / max(math.hypot(*middle[2]), 1e-300)
    width = np.abs(along_and_across(a - b, axis)[1])
    along = along_and_across(middle, axis)[0]
    rates = np.diff(width) * np.diff(along)[::-1]  # both times the product of the two distances
    return bool(rates[1] >= WIDENS * rates[0])


def growth_exponent(points: Floats, k: int, *, closed: bool = True) -> float:
    """Return the exponent p with which a body becomes thicker away from its point k.

    At a small distance d from point k of the polygon `points` (n, 2), the thickness is proportional to d^p.
    The exponent p is about 1/2 behind a round end, 1 behind a wedge, and more behind a cusp. It is estimated
    from the two points on each side of point k, and is infinite without such points.
    """
    n = len(points)
    if n < 5 or (not closed and not 2 <= k < n - 2):
        return np.inf
    a2, a1, b1, b2 = points[np.mod([k - 2, k - 1, k + 1, k + 2], n)]
    near, far = math.hypot(*(a1 - b1)), math.hypot(*(a2 - b2))
    d1, d2 = math.hypot(*(0.5 * (a1 + b1) - points[k])), math.hypot(*(0.5 * (a2 + b2) - points[k]))
    if not (near > 0 and far > 0 and 0 < d1 < d2):
        return np.inf
    return math.log(far / near) / math.log(d2 / d1)
