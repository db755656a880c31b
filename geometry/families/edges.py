"""Edges of nodes for the families, and nodes along curves in the complex plane."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.spacing.along_curve import on_corners

Corners = list[tuple[float, float]]


def polyline(corners: Corners, n: int, like: Corners | None = None) -> Floats:
    """Return n nodes (n, 2) along straight pieces, in nearly equal steps, every corner bitwise a node.

    With `like`, as many corners, each lies on the node where that polyline has it.

    >>> polyline([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], 5).tolist()
    [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 0.5], [1.0, 1.0]]
    """
    points = np.array(corners, dtype=np.float64)
    pieces = np.diff(points if like is None else np.array(like), axis=0)
    knots = np.concatenate([[0.0], np.cumsum(np.hypot(*pieces.T))])
    s = on_corners(np.linspace(0.0, knots[-1], n), knots[1:-1])
    nodes = np.stack([np.interp(s, knots, points[:, 0]), np.interp(s, knots, points[:, 1])], axis=1)
    nodes[np.searchsorted(s, knots)] = points
    return nodes


def arc_lengths(z: Complexes) -> Floats:
    """Return the arc length (n,) at each point of a polygon (n,), from 0."""
    return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(z)))])


def at_lengths(z: Complexes, length: Floats, at: Floats) -> Complexes:
    """Return points (m,) of a polygon (n,), whose points lie at `length`, at arc lengths `at` (m,)."""
    return np.interp(at, length, z.real) + 1j * np.interp(at, length, z.imag)


def as_nodes(z: Complexes) -> Floats:
    """Return (n, 2) nodes for complex ones (n,)."""
    return np.stack([z.real, z.imag], axis=-1)
