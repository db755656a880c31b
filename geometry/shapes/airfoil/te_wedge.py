"""Blunt trailing edges closed by a wedge behind them.

::

    upper surface ----.__          Both surfaces go on as cubics, leaving along their own directions, to a tip
                     |   `--.._    `REACH` bases behind the middle of the base, where the mean of the two
    base             |     __..--  directions points; nearer where they would meet before. The given points
    lower surface ---+--``         stay; those on the base are dropped.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats

REACH = 4.0
"""Largest length of the wedge in widths of the base: 14 degrees at the tip between parallel surfaces."""
LEAST = 1.0
"""The same at least: surfaces that would meet before are bent outwards, with a corner each."""
_POINTS = 9


def wedged_base(points: Floats, tangents: tuple[Floats, Floats]) -> Floats:
    """Return the ring (m, 2) of a blunt section, closed by a wedge; it starts at the tip.

    The points (n, 2) run clockwise from the lower corner of the base to the upper one; the `tangents` are the
    unit directions (2,) in which the lower and the upper surface arrive there.
    """
    lower, upper = tangents
    gap = float(np.hypot(*(points[0] - points[-1])))
    along = (lower + upper) / np.hypot(*(lower + upper))
    cross = float(lower[1] * upper[0] - lower[0] * upper[1])
    closing = cross / (1.0 + float(lower @ upper))  # tan of half the angle at which the surfaces converge
    reach = min(REACH, 0.5 / max(closing, 0.5 / REACH))
    reach = max(reach, LEAST)
    tip = 0.5 * (points[0] + points[-1]) + reach * gap * along
    u = np.linspace(0.0, 1.0, _POINTS)[1:, None]
    sides = []
    for corner, leaving in ((points[0], lower), (points[-1], upper)):
        way = tip - corner
        if reach == LEAST:
            leaving = way / np.hypot(*way)
        bend = u * (1 - u) ** 2 * float(np.hypot(*way)) * leaving - u * u * (1 - u) * way
        sides.append(corner + u * u * (3 - 2 * u) * way + bend)
    return np.concatenate([[tip], sides[0][-2::-1], points, sides[1][:-1]])
