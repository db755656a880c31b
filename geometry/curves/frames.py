"""Rotation-minimising frames along a curve in space, by double reflection.

W. Wang, B. Juettler, D. Zheng, Y. Liu, ACM Transactions on Graphics 27 (2008) 2; fourth order.
"""

import math

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.path import Path
from meshonet.geometry.elementary import cos, product, sin
from meshonet.geometry.errors import InputError

STEPS = 4  # default number of integration steps between neighbouring arc lengths


def frames_along(
    path: Path, s: Floats, up: Floats | None = None, *, steps: int = STEPS
) -> tuple[Floats, Floats]:
    """Return x and y axes (n, 3) of cross-sections of a path at arc lengths `s` (n,), which increase from 0.

    x, y and the tangent are right-handed. At the start, y is as close as possible to `up`, by default to z,
    or to y if the path starts along z. On a closed path, frames are turned about the tangent at a constant
    rate, so that the last frame equals the first. Raises InputError: `up` is parallel to the path's start.
    """
    fine = (s[:-1, None] + (np.arange(steps) / steps) * np.diff(s)[:, None]).ravel()
    fine = np.append(fine, s[-1])
    points, tangents, _ = path.at(fine)
    first = tangents[0]
    if up is None:
        up = np.array([0.0, 1.0, 0.0]) if abs(first[2]) > 0.9 else np.array([0.0, 0.0, 1.0])
    y = up - product(up, first) * first
    size = math.hypot(*y)
    if not size > 1e-6 * math.hypot(*up):
        raise InputError("points along the path where it starts", "give another direction", parameter="up")
    y_axes = _reflected(points, tangents, y / size)
    if path.closed:
        x = np.cross(y_axes[-1], tangents[-1])
        angle = math.atan2(product(y_axes[0], x), product(y_axes[0], y_axes[-1]))
        y_axes = turned(y_axes, tangents, -angle * fine / path.length)
    y_axes, tangents = y_axes[::steps], tangents[::steps]
    return np.cross(y_axes, tangents), y_axes


def turned(y_axes: Floats, tangents: Floats, angle: Floats) -> Floats:
    """Return y axes (n, 3) rotated about tangents (n, 3) by angles (n,) in radians, right-handed."""
    x_axes = np.cross(y_axes, tangents)
    return cos(angle)[:, None] * y_axes - sin(angle)[:, None] * x_axes


def _reflected(points: Floats, tangents: Floats, y: Floats) -> Floats:
    """Return the axis `y` (3,) transported from point to point by two reflections each."""
    axes = np.empty_like(points)
    axes[0] = y
    step = np.diff(points, axis=0)
    size = (step * step).sum(axis=1)
    mirrored = tangents[:-1] - (2.0 * (step * tangents[:-1]).sum(axis=1) / size)[:, None] * step
    second = tangents[1:] - mirrored
    weight = (second * second).sum(axis=1)
    axis = y.tolist()  # numbers, not arrays of three: a long path has a million steps
    rows = zip(*(each.tolist() for each in (step, size, second, weight, tangents[1:])), strict=True)
    for k, (across, square, beside, other, tangent) in enumerate(rows, start=1):
        axis = _less(axis, across, 2.0 * _dot(across, axis) / square)
        if other > 0:
            axis = _less(axis, beside, 2.0 * _dot(beside, axis) / other)
        axis = _less(axis, tangent, _dot(axis, tangent))  # removes rounding errors
        length = math.hypot(*axis)
        axis = [axis[0] / length, axis[1] / length, axis[2] / length]
        axes[k] = axis
    return axes


def _dot(a: list[float], b: list[float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _less(a: list[float], b: list[float], times: float) -> list[float]:
    return [a[0] - times * b[0], a[1] - times * b[1], a[2] - times * b[2]]
