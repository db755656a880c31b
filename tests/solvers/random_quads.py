"""Random four-sided domains: straight, wavy, bowed, kinked and bumped sides between moved corners."""

import numpy as np
from solver_shapes import corner_jacobians, quad

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.self_intersection import find_crossing
from meshonet.solvers.algebraic.tfi import tfi

FINE = 801


def random_quad(seed: int, ni: int, nj: int) -> Boundary | None:
    """Return the domain of `seed` with any node counts, or None when no grid in it is valid.

    Then its outline crosses itself, or a corner opens by 180 degrees or more.
    """
    rng = np.random.default_rng(seed)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + rng.normal(0, 0.12, (4, 2))
    stretch = np.exp(rng.uniform(-0.6, 0.6))
    corners *= [stretch, 1 / stretch]
    ends = ((0, 1, ni), (3, 2, ni), (0, 3, nj), (1, 2, nj))
    south, north, west, east = (_side(corners[a], corners[b], n, rng) for a, b, n in ends)
    try:
        boundary = quad(south, north, west, east, f"quad {seed}")
    except InputError:
        return None
    return None if find_crossing(boundary.outline()) or _flat_corner(boundary) else boundary


def _flat_corner(boundary: Boundary) -> bool:
    nodes = tfi(boundary).nodes
    return bool((corner_jacobians(nodes)[[0, 1, 2, 3], [0, -1, -1, 0], [0, 0, -1, -1]] <= 0).any())


def _side(a: Floats, b: Floats, n: int, rng: np.random.Generator) -> Floats:
    t = np.linspace(0, 1, FINE)
    normal = np.array([a[1] - b[1], b[0] - a[0]])
    at = rng.uniform(0.25, 0.75)
    kind = rng.choice(5, p=[0.15, 0.3, 0.2, 0.2, 0.15])
    if kind == 0:
        height = 0 * t
    elif kind == 1:
        k = np.arange(1, 7)
        height = (rng.normal(size=6) * rng.uniform(0.02, 0.2) / k**1.5) @ np.sin(np.pi * np.outer(k, t))
    elif kind == 2:
        height = 4 * rng.uniform(-0.3, 0.35) * t * (1 - t)
    elif kind == 3:
        height = rng.uniform(-0.22, 0.25) * np.minimum(t / at, (1 - t) / (1 - at))
    else:
        height = rng.uniform(-0.2, 0.2) * np.exp(-(((t - at) / rng.uniform(0.06, 0.2)) ** 2))
        height = height - height[0] * (1 - t) - height[-1] * t
    points = a + (b - a) * t[:, None] + height[:, None] * normal
    length = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    place = np.linspace(0, 1, n)
    place = place + rng.choice([0.0, 1.0], p=[0.7, 0.3]) * rng.uniform(-0.1, 0.1) * np.sin(2 * np.pi * place)
    s = place * length[-1]
    return np.stack([np.interp(s, length, points[:, c]) for c in (0, 1)], axis=1)
