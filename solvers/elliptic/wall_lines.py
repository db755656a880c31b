"""The grid lines that start at a side of a grid: their first heights and angles."""

import numpy as np

from meshonet.geometry.arrays import Floats


def lines_from_side(nodes: Floats, side: str) -> Floats:
    """Return a view of `nodes` (ni, nj, 2) as lines that leave `side`: (along it, away from it, 2)."""
    lines = nodes if side in ("south", "north") else np.swapaxes(nodes, 0, 1)
    return lines[:, ::-1] if side in ("north", "east") else lines


def first_heights(lines: Floats) -> Floats:
    """Return the lengths (n,) of the first pieces of `lines` (n, m, 2)."""
    return np.asarray(np.hypot(*(lines[:, 1] - lines[:, 0]).T))


def leaning(lines: Floats, tangent: Floats) -> Floats:
    """Return the cosine (n,) of the angle between a wall's unit `tangent` (n, 2) and `lines` (n, m, 2) there.

    The direction of a line at the wall is that of the parabola through its first three nodes.
    """
    a, b, c = lines[:, 0], lines[:, 1], lines[:, 2]
    first, second = np.hypot(*(b - a).T), np.hypot(*(c - b).T)
    out = (b - a) / first[:, None]
    direction = out + (out - (c - b) / second[:, None]) * (first / (first + second))[:, None]
    return np.asarray((direction * tangent).sum(axis=1) / np.hypot(*direction.T))
