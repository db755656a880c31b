"""Volumes for tests: analytic maps of the unit cube, and random domains with bubbles on each face."""

from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.six_faces import SixFaces

Map = Callable[[Floats, Floats, Floats], tuple[Floats, ...]]


def lattice(counts: tuple[int, int, int]) -> list[Floats]:
    """Return the coordinates of the unit cube's nodes."""
    return np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in counts), indexing="ij")


def mapped(to: Map, counts: tuple[int, int, int]) -> Floats:
    """Return nodes (ni, nj, nk, 3) of a map of the unit cube."""
    return np.stack(to(*lattice(counts)), axis=-1)


def skewed(a: Floats, b: Floats, c: Floats) -> tuple[Floats, ...]:
    """Edges that are not at right angles, and faces that are not plane."""
    return a + 0.2 * b * c, 1.5 * b + 0.1 * a * c, 0.8 * c - 0.2 * a * b


def bent_pipe(a: Floats, b: Floats, c: Floats) -> tuple[Floats, ...]:
    """A quarter of a ring of a thick shell."""
    radius, angle, turn = 0.4 + 0.6 * a, 0.5 * np.pi * b, 0.5 * np.pi * c
    arm = 2.0 + radius * np.cos(angle)
    return arm * np.cos(turn), -arm * np.sin(turn), radius * np.sin(angle)


def bump(a: Floats, b: Floats, c: Floats) -> tuple[Floats, ...]:
    """A box with a steep hill on its bottom, of which the interpolation alone is distorted."""
    hill = 0.6 * np.exp(-((a - 0.5) ** 2 + (b - 0.5) ** 2) / 0.0288) * (16 * a * (1 - a) * b * (1 - b))
    return a, b, c + hill * (1.0 - c) ** 8


def random_domain(seed: int, n: int) -> SixFaces:
    """Return faces of n nodes a side: moved corners, a smooth warp, and independent bubbles of the faces."""
    rng = np.random.default_rng(seed)
    corners = np.stack(lattice((2, 2, 2)), axis=-1) + 0.08 * rng.normal(size=(2, 2, 2, 3))
    warp, bubbles = 0.02 * rng.normal(size=(3, 3, 3, 3)), 0.05 * rng.normal(size=(3, 2, 2, 2, 3))
    a, b, c = lattice((n, n, n))
    nodes = np.zeros((n, n, n, 3))
    for i, j, k in np.ndindex(2, 2, 2):
        share = (a if i else 1 - a) * (b if j else 1 - b) * (c if k else 1 - c)
        nodes += share[..., None] * corners[i, j, k]
    for p, q, r in np.ndindex(3, 3, 3):
        wave = np.cos(np.pi * (p * a + q * b + r * c)) / (1 + p + q + r)
        nodes += wave[..., None] * warp[p, q, r]
    for axis, (s, t) in enumerate(((b, c), (a, c), (a, b))):
        for end, p, q in np.ndindex(2, 2, 2):
            wave = np.sin(np.pi * (p + 1) * s) * np.sin(np.pi * (q + 1) * t) / (1 + p + q)
            face = np.moveaxis(nodes, axis, 0)[-end]
            face += np.moveaxis(wave, axis, 0)[-end][..., None] * bubbles[axis, end, p, q]
    return SixFaces.of_block(nodes)
