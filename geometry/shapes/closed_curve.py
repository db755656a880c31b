"""The shape of a closed curve of points: an airfoil or another outline."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, ends_meet
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import find_corners, turning
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.outline import Outline


def closed_curve(points: Floats, name: str, places: Sequence[str] = ()) -> Outline | Airfoil:
    """Return the closed curve through `points` (n, 2) as an airfoil if it is one, else as an outline.

    `places` has the place of each point in the input.
    """
    keep = np.concatenate([[True], (np.diff(points, axis=0) != 0).any(axis=1)])
    if ends_meet(points):
        keep[-1] = len(points) < 3
    points, places = points[keep], [place for place, kept in zip(places, keep, strict=False) if kept]
    if len(points) < 3:
        raise InputError(f"{len(points)} points", "a closed curve needs at least 3")
    if _ends_in_one_edge(points):
        return Airfoil(points, name, places)
    return Outline(points, name, places=places)


def _ends_in_one_edge(points: Floats) -> bool:
    """Return whether a slender curve (n, 2) has one corner, or the two of a base, at one end."""
    if len(points) < 10:
        return False
    turn = np.abs(turning(points, closed=True))
    corners = find_corners(points, closed=True, few=0)
    sharp = corners[turn[corners] > np.radians(60.0)]
    if not 1 <= len(sharp) <= 2 or turn[sharp].sum() < np.radians(120.0):
        return False
    edge = points[sharp].mean(axis=0)
    length = float(np.hypot(*(points - edge).T).max())
    base = float(np.hypot(*np.ptp(points[sharp], axis=0)))
    area = abs(polygon_area(points))
    return base < 0.25 * length and area < 0.5 * length**2
