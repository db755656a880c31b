"""Smoothing of sections whose coordinates have ripples.

Splines are those of P. Dierckx (FITPACK, through SciPy), with the fewest knots with which points are met to a
given sum of squares: Curve and Surface Fitting with Splines (1993).
"""

from itertools import pairwise
from typing import Any
from warnings import catch_warnings

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError

_FEWEST = 12  # fewest points of a stretch that is smoothed
_HALVINGS = 40  # bisections of the sum of squares in search of the tolerance
_ENDS = 1e3  # weight of the ends of a stretch, which are corners


def smooth_ring(curve: Curve, blunt: bool, limit: float) -> tuple[Floats, float]:
    """Return the points (n, 2) of a section moved to splines within `limit`, and the largest displacement.

    Corners are kept. The `curve` of a `blunt` section begins at the middle of its base, which is omitted.

    Raises InputError: SciPy is not installed.
    """
    stretches = _stretches(curve, blunt)
    parts = [_fitted(stretch, limit) for stretch in stretches]
    most = max(float(norms(a - b).max()) for a, b in zip(parts, stretches, strict=True))
    return np.concatenate([*(part[:-1] for part in parts), parts[-1][-1:] if blunt else parts[0][:0]]), most


def _stretches(curve: Curve, blunt: bool) -> list[Floats]:
    """Return the points (n, 2) of a section from corner to corner, both included, the base left out."""
    points, corners = curve.points, curve.corner_index
    if blunt:
        points, marks = points[1:], corners - 1
    else:
        points, marks = np.concatenate([points, points[:1]]), corners
    stops = sorted({0, len(points) - 1, *(int(k) for k in marks if k >= 0)})
    return [points[a : b + 1] for a, b in pairwise(stops)]


def _fitted(points: Floats, limit: float) -> Floats:
    """Return points (n, 2) on a smoothing spline that is within `limit` of all of them, ends as they are."""
    if len(points) < _FEWEST:
        return points
    try:
        from scipy.interpolate import splev, splprep
    except ImportError:
        remedy = "install it: pip install 'meshonet[smooth]'"
        raise InputError("{smooth} needs scipy, which is not installed", remedy) from None
    u = np.concatenate([[0.0], np.cumsum(np.sqrt(norms(np.diff(points, axis=0))))])
    weight = np.ones(len(points))
    weight[[0, -1]] = _ENDS
    best, low, high = points, 0.0, len(points) * limit**2
    for _ in range(_HALVINGS):
        middle = high if low == 0.0 and best is points else 0.5 * (low + high)
        with catch_warnings(action="ignore", category=RuntimeWarning):  # of sums that it does not quite reach
            spline: Any = splprep(points.T, w=weight, u=u, k=5, s=middle)[0]
        fit = np.stack(splev(u, spline), axis=1)
        fit[0], fit[-1] = points[0], points[-1]
        if norms(fit - points).max() <= limit:
            best, low = fit, middle
            if middle == high:
                break
        else:
            high = middle if middle < high else 0.5 * high
        if low and high - low < 0.02 * high:
            break
    return best
