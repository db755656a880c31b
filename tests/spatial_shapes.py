"""Surfaces and faces in space that tests of several rooms make."""

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid

Floats = NDArray[np.float64]


def cubed_sphere(n: int = 9, radius: float = 1.0) -> Grid:
    """Six patches (n, n, 3) of a sphere, their normals outwards."""
    at = np.tan(np.linspace(-np.pi / 4, np.pi / 4, n))
    a, b = np.meshgrid(at, at, indexing="ij")
    one = np.ones_like(a)
    faces = [(one, a, b), (-one, b, a), (b, one, a), (a, -one, b), (a, b, one), (b, a, -one)]
    patches = [np.stack(face, axis=-1) for face in faces]
    return Grid(tuple(Block(radius * p / np.linalg.norm(p, axis=-1, keepdims=True)) for p in patches))


def half_sphere(n: int = 9) -> Grid:
    """Five patches of the part of the unit sphere above z = 0."""
    sides, half = [block.nodes for block in cubed_sphere(n).blocks], n // 2
    cut = sides[0][:, half:], sides[1][half:], sides[2][half:], sides[3][:, half:], sides[4]
    return Grid(tuple(Block(patch) for patch in cut))


def ball(
    around: int, along: int, angle: float = 2.0, begin: float = 0.0, ends: tuple[float, float] = (0, 1)
) -> Floats:
    """Nodes (around + 1, along + 1, 3) of a part of the unit sphere, x the axis; angles over pi."""
    turn = np.pi * np.linspace(begin, begin + angle, around + 1)[:, None]
    away = np.pi * np.linspace(*ends, along + 1)[None]
    y, z = np.sin(away) * np.cos(turn), np.sin(away) * np.sin(turn)
    nodes = np.stack([-np.cos(away) + 0.0 * turn, y, z], axis=-1)
    nodes[np.abs(nodes) < 1e-12] = 0.0
    if angle == 2.0:
        nodes[-1] = nodes[0]
    return nodes


def box(ni: int = 9, nj: int = 8, nk: int = 7, bump: float = 0.2) -> Floats:
    """Nodes (ni, nj, nk, 3) of a box 2 x 1 x 1 whose bottom has a bump, interpolated linearly in between."""
    x, y, z = np.meshgrid(np.linspace(0, 2, ni), np.linspace(0, 1, nj), np.linspace(0, 1, nk), indexing="ij")
    floor = bump * np.exp(-20 * ((x - 1) ** 2 + (y - 0.5) ** 2))
    floor *= 16 * (x * (2 - x)) * (y * (1 - y)) / 4
    return np.stack([x, y, floor + (1 - floor) * z], axis=-1)
