"""Smoothing of sections by least-squares splines of FITPACK, with the fewest knots within the tolerance.

Half of the density of knots follows the angle of the theory of thin airfoils; by arc length, a spline that
smooths the sides would flatten the nose. P. Dierckx, Curve and Surface Fitting with Splines, 1993.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from meshonet.geometry.arrays import Floats, along_and_across, norms
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Change
from meshonet.geometry.shapes.airfoil.clean import CleanSection
from meshonet.geometry.shapes.airfoil.section_curve import sign_changes
from meshonet.geometry.shapes.airfoil.separate_surfaces import wedged_apart

if TYPE_CHECKING:
    from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

_FEWEST = 12  # fewest points of a stretch that is smoothed
_DEGREE = 5  # of the splines: their curvature has no kinks
_ENDS = 1e3  # weight of the ends of a stretch, which are corners
_OUTLIERS = 32  # one point of so many may be farther off than the tolerance before weights bring it back
_ROUNDS = 12  # of weights for outliers
_THIN = 2.0  # thickness of a section, or height of a corner, over the tolerance, that noise can cause
_BESIDE = 3  # points from a corner to the ends of the line that it stands out from
_HEAVIER = 2.0  # factor of the weight of an outlier in each round


def smooth_ring(section: CleanSection, nose_radius: float, limit: float) -> tuple[Floats, float]:
    """Return the points (n, 2) of a section smoothed by splines, and the largest displacement of a point.

    It is at most `limit`. Corners are kept. A trailing edge is closed if it is thinner than `limit`, or if
    noise has moved its upper point below its lower one. Raises InputError: SciPy is not installed.
    """
    unsmoothed = np.concatenate([section.points, section.points[: 0 if section.blunt else 1]])
    points = _closed(unsmoothed, limit)
    nose = int(np.argmax(norms(points - points[0])))
    corners = [k for k in section.corners.tolist() if _stands_out(points, k, limit)]
    stops = sorted({0, len(points) - 1, *corners})
    parts = [_fitted(points[a : b + 1], points[nose], nose_radius, limit) for a, b in pairwise(stops)]
    ring = np.concatenate([*(part[:-1] for part in parts), parts[-1][-1:]])
    ring = ring if (ring[0] != ring[-1]).any() else ring[:-1]
    unsmoothed = unsmoothed[: len(ring)]
    away = wedged_apart(ring, nose, _THIN * limit) - ring
    away[[k for k in stops if k < len(ring)]] = 0.0
    left = np.maximum(limit - norms(ring - unsmoothed), 0.0)
    ring = ring + away * np.minimum(1.0, left / np.maximum(norms(away), np.finfo(float).tiny))[:, None]
    return ring, float(norms(ring - unsmoothed).max())


def smoothing_notes(before: Airfoil, after: Airfoil, most: float) -> tuple[str, ...]:
    """Return notes on what smoothing changed; `most` is the largest displacement of a point."""
    chord = before.chord
    old, new = (sign_changes(each.points_curve, each.chord) for each in (before, after))
    moved = f"the outline is changed: smoothed by up to {most / chord:.2g} chords"
    notes: tuple[str, ...] = (Change(f"{moved}, sign changes of its curvature from {old} to {new}"),)
    if before.blunt and not after.blunt:
        base = f"its base, {before.gap / chord:.2g} chords wide"
        notes += (Change(f"the outline is changed: {base}, is no wider than noise and is closed"),)
    return notes


def _closed(points: Floats, limit: float) -> Floats:
    """Return points (n, 2) with near or swapped ends at their middle."""
    edge = 0.5 * (points[0] + points[-1])
    axis = edge - points[np.argmax(norms(points - edge))]
    _, across = along_and_across(points[[0, -1]] - edge, axis / np.hypot(*axis))
    if norms(points[0] - edge) <= (0.5 if across[1] > across[0] else 1.0) * limit:
        points = points.copy()
        points[[0, -1]] = edge
    return points


def _stands_out(points: Floats, k: int, limit: float) -> bool:
    """Return whether a corner or end is farther off its neighbours' line than noise."""
    a, b = points[max(k - _BESIDE, 0)], points[min(k + _BESIDE, len(points) - 1)]
    _, across = along_and_across(points[k] - a, b - a)
    return k in (0, len(points) - 1) or bool(abs(across) > _THIN * limit * np.hypot(*(b - a)))


def _fitted(points: Floats, nose: Floats, radius: float, limit: float) -> Floats:
    """Return points (n, 2) on the spline with the fewest knots within `limit`."""
    if len(points) < _FEWEST:
        return points
    u = _parameter(points, nose, radius)
    even = 0.5 * (u / u[-1] + np.linspace(0.0, 1.0, len(u)))  # knots follow the density of points too
    ends = u[[0] * (_DEGREE + 1)], u[[-1] * (_DEGREE + 1)]
    for count in range(len(points) - _DEGREE):
        inner = np.interp(np.linspace(0.0, 1.0, count + 2)[1:-1], even, u)
        fit = _within(points, u, np.concatenate([ends[0], inner, ends[1]]), limit)
        if fit is not None:
            return fit
    return points


def _parameter(points: Floats, nose: Floats, radius: float) -> Floats:
    """Return ds / sqrt(distance from the nose + radius / 2), summed (n,): an angle around a parabola."""
    away = norms(0.5 * (points[1:] + points[:-1]) - nose)
    return np.append(0.0, np.cumsum(norms(points[1:] - points[:-1]) / np.sqrt(away + 0.5 * radius)))


def _within(points: Floats, u: Floats, knots: Floats, limit: float) -> Floats | None:
    """Return points (n, 2) on the least-squares spline with `knots`, or None beyond `limit`.

    Weights of a few outliers increase until they are within it.
    """
    try:
        from scipy.interpolate import splev, splprep
    except ImportError:
        remedy = "install it: pip install 'meshonet[smooth]'"
        raise InputError("{smooth} needs scipy, which is not installed", remedy) from None
    weight = np.ones(len(points))
    weight[[0, -1]] = _ENDS
    for _ in range(_ROUNDS):
        try:
            spline: Any = splprep(points.T, w=weight, u=u, k=_DEGREE, t=knots, task=-1)[0]
        except (TypeError, ValueError):  # an interval between knots has too few points
            return None
        fit = np.stack(splev(u, spline), axis=1)
        fit[0], fit[-1] = points[0], points[-1]
        outliers = norms(fit - points) > limit
        if not outliers.any():
            return fit
        if outliers.sum() > len(points) // _OUTLIERS:
            return None
        weight[outliers] *= _HEAVIER
    return None
