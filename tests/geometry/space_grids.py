"""Blocks in space for tests: lattices, turned lattices, a pipe with an axis, the six faces of a ball."""

from itertools import permutations, product

import numpy as np

from meshonet.geometry.arrays import Floats


def lattice(*spans: tuple[float, float, int]) -> Floats:
    """Nodes (ni, nj, nk, 3) at equal steps."""
    return np.stack(np.meshgrid(*(np.linspace(*span) for span in spans), indexing="ij"), axis=-1)


def turned(nodes: Floats, number: int) -> Floats:
    """The nodes of a right-handed block, counted in one of the 24 right-handed ways."""
    ways = [
        (axes, signs)
        for axes in permutations(range(3))
        for signs in product((1, -1), repeat=3)
        if np.linalg.det(np.eye(3)[list(axes)] * signs) > 0
    ]
    axes, signs = ways[number % len(ways)]
    return nodes.transpose(*axes, 3)[tuple(slice(None, None, sign) for sign in signs)]


def pipe(n: int = 5, around: int = 13, along: int = 4, inner: float = 0.0) -> Floats:
    """A pipe of radius 1, i outwards, j around, k along; without an inner radius west is its axis."""
    radius, angle = np.linspace(inner, 1, n), np.linspace(0, 2 * np.pi, around)
    r, t, z = np.meshgrid(radius, angle, np.linspace(0, 2, along), indexing="ij")
    return np.stack([r * np.cos(t), r * np.sin(t), z], axis=-1)


def sphere_patches(n: int = 5) -> list[Floats]:
    """The six faces (n, n, 3) of a cube on the unit sphere, normals outwards."""
    cube = lattice(*[(-1.0, 1.0, n)] * 3)
    faces = [cube[0].swapaxes(0, 1), cube[-1], cube[:, 0], cube[:, -1].swapaxes(0, 1)]
    faces += [cube[:, :, 0].swapaxes(0, 1), cube[:, :, -1]]
    angles = [np.tan(np.pi / 4 * face) for face in faces]
    return [face / np.linalg.norm(face, axis=-1, keepdims=True) for face in angles]
