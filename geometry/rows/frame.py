"""The axis of a row of blades in its files, which becomes the x axis, and their unit."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import norms
from meshonet.geometry.blocks.motion import Motion

_ALONG = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
AXES = _ALONG | {f"-{name}": (-x, -y, -z) for name, (x, y, z) in _ALONG.items()}
"""Unit vectors of the axes by name."""
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Lengths of the units of files, in metres."""


def axis_along(direction: Sequence[float]) -> Motion:
    """Return a rotation of `direction` (3,) to x, by multiples of 90 degrees if it is a coordinate axis."""
    way = np.array(direction)
    way = way / np.abs(way).max()
    way = way / norms(way)
    k = int(np.abs(way).argmax())
    up = np.eye(3)[(k + (1 if way[k] > 0.0 else 2)) % 3]
    up = up - (up * way).sum() * way
    up = up / norms(up)
    rows = (way, up, np.cross(way, up))
    return Motion(turn=tuple(tuple(float(value) + 0.0 for value in row) for row in rows))


def axis_name(frame: Motion | None) -> str:
    """Return the name, such as ``-z``, of the axis that `frame` rotates to x; for oblique axes, "axis"."""
    direction = AXES["x"] if frame is None else frame.turn[0]
    return next((name for name, each in AXES.items() if each == direction), "axis")
