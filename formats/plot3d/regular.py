"""How regular the cells of a block are: what tells the right reading of a file from wrong ones."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats


def regular_cells(nodes: Floats) -> tuple[int, int]:
    """Return how many cells lie as most others do, and how many there are, of (ni, nj, 2) or in space.

    In the plane and in volumes these are the cells of the prevailing sign of area or volume; on a surface the
    pairs of neighbours whose normals differ by less than a right angle.
    """
    if nodes.shape[2:] == (3,):
        normal = _cross(*_diagonals(nodes))
        pairs = (normal[1:], normal[:-1]), (normal[:, 1:], normal[:, :-1])
        signs = np.concatenate([np.ones(1), *((a * b).sum(axis=-1).ravel() for a, b in pairs)])
        return int((signs > 0).sum()), len(signs)
    if nodes.ndim == 3:
        (x, y), (u, v) = (np.moveaxis(d, -1, 0) for d in _diagonals(nodes))
        signs = x * v - y * u
    else:
        u, v, w = (nodes[1:, :-1, :-1], nodes[:-1, 1:, :-1], nodes[:-1, :-1, 1:])
        corner = nodes[:-1, :-1, :-1]
        signs = (_cross(u - corner, v - corner) * (w - corner)).sum(axis=-1)
    return max(int((signs > 0).sum()), int((signs < 0).sum())), signs.size


def _diagonals(nodes: Floats) -> tuple[Floats, Floats]:
    return nodes[1:, 1:] - nodes[:-1, :-1], nodes[:-1, 1:] - nodes[1:, :-1]


def _cross(a: Floats, b: Floats) -> Floats:
    (x, y, z), (u, v, w) = np.moveaxis(a, -1, 0), np.moveaxis(b, -1, 0)
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)
