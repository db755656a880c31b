"""Sections for tests, made from formulas written here apart from the code under test."""

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

STATIONS = np.array([0, 1.25, 2.5, 5, 7.5, 10, 15, 20, 25, 30, 40, 50, 60, 70, 80, 90, 95, 100]) / 100
"""Where the old reports give their ordinates."""


def surfaces(
    ratio: float = 0.12, camber: float = 0.0, base: float = 0.0, x: Points | None = None
) -> tuple[Points, Points]:
    """Return upper and lower surface (n, 2), leading edge first, chord 1, closed but for `base`."""
    x = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 61)) if x is None else x
    half = 5 * ratio * (0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    half = np.where(x == 1, 0.0, half) + 0.5 * base * x
    middle = 4 * camber * x * (1 - x)
    return np.stack([x, middle + half], axis=1), np.stack([x, middle - half], axis=1)


def selig(ratio: float = 0.12, camber: float = 0.0, base: float = 0.0, x: Points | None = None) -> Points:
    """Return the points in Selig's order: trailing edge, upper side, leading edge, lower side."""
    upper, lower = surfaces(ratio, camber, base, x)
    return np.concatenate([upper[::-1], lower[1:]])


def oblique(ratio: float) -> Points:
    """Return a section open at its end, whose lower side ends 0.003 chords before the upper one."""
    upper, lower = surfaces(ratio, 0.02, 0.03 * ratio)
    lower[:, 0] *= 0.997
    return np.concatenate([upper[::-1], lower[1:]])


def text(points: Points, digits: int = 6) -> str:
    """Return lines of x y."""
    return "".join(f"{x:.{digits}f} {y:.{digits}f}\n" for x, y in points)


def farthest(points: Points, curve: Points) -> float:
    """Return the largest distance of points (n, 2) from a polyline (m, 2)."""
    import shapely

    line = shapely.LineString(curve)
    return float(max(line.distance(shapely.Point(p)) for p in points))
