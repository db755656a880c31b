"""Blunt trailing edges with rounded corners, or closed by a wedge.

A fillet is a cubic Bezier curve. The sides of a wedge are tangential cubics to a tip behind the middle of the
base, `REACH` widths away, or nearer if the surfaces would meet before.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.elementary import arctan2, power, product
from meshonet.geometry.polygon.corners import find_corners
from meshonet.geometry.shapes.airfoil.clean import CleanSection
from meshonet.geometry.spacing.gradual_sizes import limited_sizes
from meshonet.geometry.spacing.size_field import GROWTH

if TYPE_CHECKING:
    from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

_ACROSS = 0.9  # fraction of half the base that a fillet takes
_ALONG = 2.0  # length of the fillet along the surface, over that along the base
_CAP = 5e-3  # upper limit of the length that a fillet takes of the base, in chords
_PULL = 0.6  # position of the fillet's control points between its ends (0) and the corner (1)
_POINTS = 24  # points on a fillet
_TURN = 0.5  # on half a base of 90 degrees: nodes placed by turning, for each node placed by length
_MORE = 1.3  # factor up to which cells are added so that neither half has too few
_NEAR = 0.1  # chords from the corner within which the surface gets new points, taken from the curve
REACH = 4.0  # largest length of the wedge in widths of the base: 14 degrees between parallel surfaces
LEAST = 1.0  # smallest length of the wedge in widths of the base; surfaces that would meet before are bent
_WEDGE_POINTS = 9  # on each side of a wedge


def rounded_base(curve: Curve, chord: float) -> tuple[Curve, float]:
    """Return `curve` with rounded corners at its blunt trailing edge (base), and half the new base's length.

    `curve` and the returned curve are closed, begin in the middle of the base, and do not repeat this point.
    The second and the last point of `curve` are the corners. The new base includes their roundings.
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
    """Return distances (n + 1,) of nodes from the middle of a rounded base along its lower and upper half.

    `curve` begins in the middle of the base, each half of which has the length `end`. Cells are smaller where
    the curve turns more. A half that turns by 90 degrees has about `cells` (at least 3) cells.
    """
    per_cell = 64
    n = per_cell * cells  # on either half; index n is the middle
    s = np.linspace(-end, end, 2 * n + 1)
    way = curve.tangent(s)
    turn = np.abs(np.diff(np.unwrap(arctan2(way[:, 1], way[:, 0]))))
    reach = 2 * per_cell
    ends = [np.full(reach, part.mean()) for part in (turn[:per_cell], turn[-per_cell:])]
    total = np.concatenate([[0.0], np.cumsum(np.concatenate([ends[0], turn, ends[1]]))])
    around = total[2 * reach :] - total[: -2 * reach]  # two cells on each side of every point
    turn = (around[1:] + around[:-1]) / (4 * reach)
    weight = 1.0 + _TURN * turn * (2.0 * n / np.pi)
    size = limited_sizes((1.0 + _TURN) * end / cells / weight, s[1:], GROWTH)
    count = np.concatenate([[0.0], np.cumsum(end / n / size)])
    halves = count[n] - count[n::-1], count[n:] - count[n]
    more = min(max(cells / float(min(halves[0][-1], halves[1][-1])), 1.0), _MORE)
    upper, lower = (max(3, round(more * float(half[-1]))) for half in halves)
    # halves of 12.6 and 15.4 become 13 and 15 cells without a jump of size between them
    places = np.arange(-upper, lower + 1.0)
    knots, counts = np.array([-upper, 0.0, lower]), np.array([-halves[0][-1], 0.0, halves[1][-1]])
    distances = np.interp(monotone_cubic(knots, counts, places), count - count[n], s)
    distances[0], distances[upper], distances[-1] = -end, 0.0, end
    return distances[upper:], -distances[upper::-1]


def _fillet(curve: Curve, begin: float, corner: float, end: float) -> Floats:
    """Return points (n, 2) from the base to the surface, with both ends on the curve."""
    a, c, b = curve.at(np.array([begin, corner, end]))
    p, q = a + _PULL * (c - a), b + _PULL * (c - b)
    u = np.linspace(0.0, 1.0, _POINTS)[:, None]
    v = 1.0 - u
    return np.asarray(v * v * v * a + 3 * v * v * u * p + 3 * v * u * u * q + u * u * u * b)


def wedged_base(section: CleanSection, tangents: tuple[Floats, Floats]) -> CleanSection:
    """Return a blunt section closed by a wedge; the result starts at the tip of the wedge.

    `tangents` are unit directions (2,) of the lower and the upper surface at the base.
    """
    points, (lower, upper) = section.points, tangents
    gap = float(np.hypot(*(points[0] - points[-1])))
    along = (lower + upper) / np.hypot(*(lower + upper))
    cross = float(lower[1] * upper[0] - lower[0] * upper[1])
    # tangent of half the angle at which the surfaces converge
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
    ring = np.concatenate([[tip], sides[0][-2::-1], points, sides[1][:-1]])
    added = _WEDGE_POINTS - 2
    corners = section.corners + added + 1
    bent = np.ones(len(corners), dtype=bool)
    bent[[0, -1]] = reach == LEAST and np.isin(corners[[0, -1]], find_corners(ring, closed=True, few=0))
    index = np.concatenate([section.index[[0] * (added + 1)], section.index, section.index[[-1] * added]])
    return CleanSection(ring, index, False, 0.0, np.append(0, corners[bent]))


def opened_base(airfoil: Airfoil, gap: float) -> CleanSection:
    """Return the section, opened linearly along its chord to a blunt trailing edge of height `gap`."""
    curve, section = airfoil.curve, airfoil._section
    points, knots, index, corners = curve.points, curve.knots, section.index, section.corners
    if airfoil.blunt:
        points, knots = points[1:], knots[1:]
    else:
        last = len(points)
        points, knots = np.append(points, points[:1], axis=0), np.append(knots, curve.length)
        index, corners = np.append(index, index[0]), np.union1d(corners, [0, last])
    chord = airfoil.trailing_edge - airfoil.leading_edge
    normal = np.array([-chord[1], chord[0]]) / airfoil.chord
    along = np.clip(product(points - airfoil.leading_edge, chord) / airfoil.chord**2, 0.0, None)
    missing = np.where(knots < airfoil.nose_arc, -0.5, 0.5) * (gap - airfoil.gap)
    return CleanSection(points + (missing * along)[:, None] * normal, index, True, gap, corners)
