"""Boundaries that tests of the march share, and what they measure of its grids."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.far_field import o_boundary
from meshonet.geometry.spacing.sampling import Sampling


def circle(n: int, radius: float = 0.5) -> Floats:
    angle = -2 * np.pi * np.arange(n + 1) / n
    ring = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    ring[-1] = ring[0]
    return ring


def ellipse(n: int, nj: int, thickness: float = 0.4) -> Boundary:
    return o_boundary(circle(n) * [1.0, thickness], nj, np.zeros(2), 10.0)


def airfoil(name: str = "2412", ni: int = 200, nj: int = 80) -> Boundary:
    return naca(name).boundary(Sampling(ni, nj, spacing="curvature"))


def first_cells(nodes: Floats) -> Floats:
    return np.asarray(np.hypot(*(nodes[:, 1] - nodes[:, 0]).T))


def deviation(nodes: Floats) -> Floats:
    """Degrees off 90 of all four corners of every cell."""
    corners = [nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]]
    results = []
    for k, at in enumerate(corners):
        u, v = corners[(k + 1) % 4] - at, corners[k - 1] - at
        cosine = (u * v).sum(axis=-1) / np.hypot(*np.moveaxis(u, -1, 0)) / np.hypot(*np.moveaxis(v, -1, 0))
        results.append(np.abs(np.degrees(np.arccos(cosine)) - 90.0))
    return np.stack(results)
