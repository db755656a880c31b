"""Blunt trailing edges with their two corners rounded off, or closed by a wedge behind them.

::

    upper surface ----.       The fillet, a cubic Bezier curve, leaves the surface at `along` from the corner
                       )      and meets the base at `across` from it: 0.9 of half the base, capped, and twice
                       |      that along the surface. The rest of the outline stays.
    base               |

    upper surface ----.__          Both surfaces go on as cubics, leaving along their own directions, to a tip
                     |   `--.._    `REACH` bases behind the middle of the base, where the mean of the two
    base             |     __..--  directions points; nearer where they would meet before. The given points
    lower surface ---+--``         stay; those on the base are dropped.
"""

import math

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.elementary import arctan2, power, product
from meshonet.geometry.spacing.size_field import GROWTH, limited_size

_ACROSS = 0.9  # part of half the base that a fillet takes
_ALONG = 2.0  # its length along the surface, in that along the base
_CAP = 5e-3  # largest part of the base that a fillet takes, in chords
_PULL = 0.6  # where the control points of the fillet are between its ends (0) and the corner (1)
_POINTS = 24  # on a fillet
_TURN = 0.5
"""Nodes of half a base that turns by 90 degrees that follow its turning, for each that follows its length."""
_MORE = 1.3  # factor up to which cells are added so that neither half has fewer than wanted
_NEAR = 0.1  # chords from the corner within which the surface is given by points taken from the curve
REACH = 4.0
"""Largest length of the wedge in widths of the base: 14 degrees at the tip between parallel surfaces."""
LEAST = 1.0
"""The same at least: surfaces that would meet before are bent outwards, with a corner each."""
_WEDGE_POINTS = 9  # on each side of a wedge


def rounded_base(curve: Curve, chord: float) -> tuple[Curve, float]:
    """Return the curve of a blunt section with its trailing corners rounded, and where the rounding ends.

    The closed curve's first point is the middle of the base, its second and its last are the corners. The
    new one begins there too, leaves the rounded part at the arc length returned and comes back to it as far
    before its end.
    """
    length, half = curve.length, float(curve.knots[1])
    across = min(_ACROSS * half, _CAP * chord)
    along = _ALONG * across
    last = int(math.log(max(_NEAR * chord / along, 1.25)) / math.log(1.25))
    near = along * power(1.25, np.arange(last + 1))
    inner = (curve.knots > half + 1.2 * near[-1]) & (curve.knots < length - half - 1.2 * near[-1])
    corner_arcs = curve.corners[(curve.corners > half + along) & (curve.corners < length - half - along)]
    surface = half + near, curve.knots[inner], length - half - near[::-1], corner_arcs
    arcs = np.unique(np.concatenate(surface))
    lower = _fillet(curve, half - across, half, half + along)
    upper = _fillet(curve, length - half + across, length - half, length - half - along)[::-1]
    points = np.concatenate([curve.points[:1], lower[:-1], curve.at(arcs), upper[1:]])
    corners = len(lower) + np.searchsorted(arcs, corner_arcs)
    rounded = Curve(points, closed=True, corners=corners)
    return rounded, float(rounded.knots[len(lower)])


def half_rounds(curve: Curve, end: float, cells: int) -> tuple[Floats, Floats]:
    """Return distances (n + 1,) from the middle of a rounded base to its lower end, and to its upper end.

    The density of nodes follows length and turning; turning is averaged over two cells to each side, as the
    cells where the base turns most are the skewest of the grid. A slanted base turns more at one end, and has
    more cells there. `curve` and `end` are those of `rounded_base`, `cells`, at least 3, those of a half that
    turns by a right angle.
    """
    per_cell = 64
    n = per_cell * cells  # on either half; place n is the middle
    s = np.linspace(-end, end, 2 * n + 1)
    way = curve.tangent(s)
    turn = np.abs(np.diff(np.unwrap(arctan2(way[:, 1], way[:, 0]))))
    reach = 2 * per_cell
    ends = [np.full(reach, part.mean()) for part in (turn[:per_cell], turn[-per_cell:])]
    total = np.concatenate([[0.0], np.cumsum(np.concatenate([ends[0], turn, ends[1]]))])
    around = total[2 * reach :] - total[: -2 * reach]  # two cells to each side of every place
    turn = (around[1:] + around[:-1]) / (4 * reach)
    weight = 1.0 + _TURN * turn * (2.0 * n / np.pi)
    size = limited_size(s[1:], (1.0 + _TURN) * end / cells / weight, GROWTH)
    count = np.concatenate([[0.0], np.cumsum(end / n / size)])
    halves = count[n] - count[n::-1], count[n:] - count[n]
    more = min(max(cells / float(min(halves[0][-1], halves[1][-1])), 1.0), _MORE)
    upper, lower = (max(3, round(more * float(half[-1]))) for half in halves)
    # halves of 12.6 and 15.4 make 13 and 15 cells without a step in size between them
    places = np.arange(-upper, lower + 1.0)
    knots, counts = np.array([-upper, 0.0, lower]), np.array([-halves[0][-1], 0.0, halves[1][-1]])
    distances = np.interp(monotone_cubic(knots, counts, places), count - count[n], s)
    distances[0], distances[upper], distances[-1] = -end, 0.0, end
    return distances[upper:], -distances[upper::-1]


def _fillet(curve: Curve, begin: float, corner: float, end: float) -> Floats:
    """Return points (n, 2) from the base to the surface, both ends on the curve."""
    a, c, b = curve.at(np.array([begin, corner, end]))
    p, q = a + _PULL * (c - a), b + _PULL * (c - b)
    u = np.linspace(0.0, 1.0, _POINTS)[:, None]
    v = 1.0 - u
    return np.asarray(v * v * v * a + 3 * v * v * u * p + 3 * v * u * u * q + u * u * u * b)


def wedged_base(points: Floats, tangents: tuple[Floats, Floats]) -> Floats:
    """Return the ring (m, 2) of a blunt section, closed by a wedge; it starts at the tip.

    The points (n, 2) run clockwise from the lower corner of the base to the upper one; the `tangents` are the
    unit directions (2,) in which the lower and the upper surface arrive there.
    """
    lower, upper = tangents
    gap = float(np.hypot(*(points[0] - points[-1])))
    along = (lower + upper) / np.hypot(*(lower + upper))
    cross = float(lower[1] * upper[0] - lower[0] * upper[1])
    # tan of half the angle at which the surfaces converge
    closing = cross / (1.0 + float(product(lower, upper)))
    reach = min(REACH, 0.5 / max(closing, 0.5 / REACH))
    reach = max(reach, LEAST)
    tip = 0.5 * (points[0] + points[-1]) + reach * gap * along
    u = np.linspace(0.0, 1.0, _WEDGE_POINTS)[1:, None]
    sides = []
    for corner, leaving in ((points[0], lower), (points[-1], upper)):
        way = tip - corner
        if reach == LEAST:
            leaving = way / np.hypot(*way)
        bend = u * (1 - u) ** 2 * float(np.hypot(*way)) * leaving - u * u * (1 - u) * way
        sides.append(corner + u * u * (3 - 2 * u) * way + bend)
    return np.concatenate([[tip], sides[0][-2::-1], points, sides[1][:-1]])
