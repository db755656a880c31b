"""Blunt trailing edges with their two corners rounded off.

::

    upper surface ----.       The fillet, a cubic Bezier curve, leaves the surface at `along` from the corner
                       )      and meets the base at `across` from it: 0.9 of half the base, capped, and twice
                       |      that along the surface. The rest of the outline stays.
    base               |
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Floats
from geometry.curves import Curve

_ACROSS = 0.9
_ALONG = 2.0
_CAP = 5e-3
"""Largest part of the base that a fillet takes, in chords."""
_PULL = 0.6
"""Where the control points of the fillet are between its ends (0) and the corner (1)."""
_POINTS = 24
_NEAR = 0.1
"""Chords from the corner within which the surface is given by points taken from the curve."""


def rounded_base(curve: Curve, chord: float) -> tuple[Curve, float]:
    """Return the curve of a blunt section with its trailing corners rounded, and where the rounding ends.

    Parameters
    ----------
    curve : closed; its first point is the middle of the base, its second and its last are the corners.
    chord : unit of the caps.

    Returns
    -------
    tuple
        the curve, from the middle of the base on as before, and the arc length at which it leaves the rounded
        part; it comes back to it as far before its end.
    """
    length, half = curve.length, float(curve.knots[1])
    across = min(_ACROSS * half, _CAP * chord)
    along = _ALONG * across
    near = along * 1.25 ** np.arange(1 + int(np.log(max(_NEAR * chord / along, 1.25)) / np.log(1.25)))
    inner = (curve.knots > half + 1.2 * near[-1]) & (curve.knots < length - half - 1.2 * near[-1])
    corner_arcs = curve.corners[(curve.corners > half + along) & (curve.corners < length - half - along)]
    arcs = np.unique(
        np.concatenate([half + near, curve.knots[inner], length - half - near[::-1], corner_arcs])
    )
    lower = _fillet(curve, half - across, half, half + along)
    upper = _fillet(curve, length - half + across, length - half, length - half - along)[::-1]
    points = np.concatenate([curve.points[:1], lower[:-1], curve.at(arcs), upper[1:]])
    corners = len(lower) + np.searchsorted(arcs, corner_arcs)
    rounded = Curve(points, closed=True, corners=corners)
    return rounded, float(rounded.knots[len(lower)])


def _fillet(curve: Curve, begin: float, corner: float, end: float) -> Floats:
    """Return points (n, 2) from the base to the surface, both ends on the curve."""
    a, c, b = curve.at(np.array([begin, corner, end]))
    p, q = a + _PULL * (c - a), b + _PULL * (c - b)
    u = np.linspace(0.0, 1.0, _POINTS)[:, None]
    v = 1.0 - u
    return np.asarray(v**3 * a + 3 * v * v * u * p + 3 * v * u * u * q + u**3 * b)
