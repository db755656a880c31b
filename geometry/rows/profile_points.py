"""Points of profiles and walls as given: repeated ones left out, open profiles refused."""

import numpy as np
from numpy.typing import ArrayLike

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.self_intersection import find_crossing

LEAST_POINTS = 12
_SAME = 1e-9  # consecutive points nearer than this fraction of the size of the profile count as one
_THIN = 1e-5  # smallest area of a profile over the square of its size: a plate 1e-5 chords thick
_OPEN = 0.1  # largest distance between the first and the last point, relative to the size of the profile
_STEPS = 3.0  # the same, divided by the longest distance of neighbouring points, for profiles of few points


def as_points(values: ArrayLike, columns: int) -> Floats:
    """Return `values` as an array (n, columns). Raises InputError: another shape, or not numbers."""
    try:
        points = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        points = np.empty(0)
    if points.ndim != 2 or points.shape[1] != columns or not np.isfinite(points).all():
        shape = f" of shape {points.shape}" if points.size else ""
        problem = f"no points{shape}" if np.isfinite(points).all() else "points that are not finite"
        raise InputError(problem, f"give numbers (n, {columns})")
    return points


def apart(points: Floats, *, closed: bool) -> Floats:
    """Return points (n, d) without repeated neighbours; if `closed`, last and first are neighbours too."""
    steps = norms(points - np.roll(points, -1, axis=0))
    kept = steps > _SAME * np.ptp(points, axis=0).max(initial=0.0)
    kept[-1:] |= not closed
    return np.ascontiguousarray(points[kept])


def distinct_points(points: Floats) -> Floats:
    """Return points (n, 3) around a profile without repeated ones. Raises InputError: too few are left."""
    p = np.asarray(points, dtype=np.float64)
    count = len(p)
    p = apart(p, closed=True) if count else p
    if len(p) < LEAST_POINTS:
        problem = f"{count} points" if len(p) == count else f"{len(p)} different points of {count}"
        raise InputError(problem, f"give {LEAST_POINTS} or more around the blade, all in one unit")
    return p


def check_profile(plane: Floats, points: Floats) -> None:
    """Raise InputError unless `points` go around a blade; `plane`: their m' (`MeridionalMap`) and theta."""
    size = float(norms(np.ptp(plane, axis=0)))
    steps = norms(plane - np.roll(plane, 1, axis=0))
    if steps[0] > max(_OPEN * size, _STEPS * steps[1:].max()):
        problem = (
            f"is open between its first and its last point, {_place(points[0])} and {_place(points[-1])}"
        )
        raise InputError(problem, "give points all around the blade, with no blank line or text between them")
    if abs(polygon_area(plane)) < _THIN * size * size:
        raise InputError("encloses no area", "give points around the blade, not a line")
    crossing = find_crossing(plane)
    if crossing is not None:
        k = int(norms(plane - [crossing.x, crossing.y]).argmin())
        raise InputError(f"crosses itself near {_place(points[k])}", "give its points in order around it")


def _place(point: Floats) -> str:
    return "({:.6g}, {:.6g}, {:.6g})".format(*point)
