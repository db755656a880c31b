"""The axis of a row of blades in the coordinates of its files and of its grid; a `Row` has it along x."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import norms
from meshonet.geometry.blocks.connection import Motion

_UNITS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
AXES = _UNITS | {f"-{name}": (-x, -y, -z) for name, (x, y, z) in _UNITS.items()}
"""Directions by name."""


def axis_along(direction: Sequence[float]) -> Motion:
    """Return the rotation that carries a `direction` (3,), not 0, to x, and directions of axes to axes."""
    way = np.array(direction)
    way = way / np.abs(way).max()
    way = way / norms(way)
    k = int(np.abs(way).argmax())
    up = np.eye(3)[(k + (1 if way[k] > 0.0 else 2)) % 3]
    up = up - (up * way).sum() * way
    up = up / norms(up)
    rows = (way, up, np.cross(way, up))
    return Motion(turn=tuple(tuple(float(value) + 0.0 for value in row) for row in rows))
