"""Grids of many blocks in space, made by hand and joined by the places of their nodes."""

from collections.abc import Callable, Sequence

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import PLACES, Block
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes


def joined(lattices: Sequence[Floats], namer: Callable[[Floats], str] = lambda _: "wall") -> Grid:
    """The grid of nodes (ni, nj, nk, 3) each, joined where sides touch; `namer` names whole outer sides."""
    blocks = [Block(nodes) for nodes in lattices]
    connections = find_connections(blocks)
    blocks = list(with_equal_nodes(blocks, connections))
    inside = {(each.block, each.side) for each in connections}
    inside |= {(each.donor, each.donor_side) for each in connections}
    patches = [
        Patch(namer(block.face(side)), side, 0, block.face(side).shape[0] - 1, block=number)
        for number, block in enumerate(blocks)
        for side in PLACES
        if (number, side) not in inside
    ]
    return Grid(tuple(blocks), tuple(patches), connections)


def shell(n: int = 9, layers: int = 12, first: float = 0.02, growth: float = 1.2) -> Grid:
    """Six blocks between the unit sphere, their bottoms, and a larger one; three meet at eight edges."""
    t = np.tan(np.linspace(-np.pi / 4, np.pi / 4, n))
    radius = 1.0 + np.concatenate([[0.0], np.cumsum(first * growth ** np.arange(layers))])
    a, b = np.meshgrid(t, t, indexing="ij")
    lattices = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            point = np.empty((n, n, 3))
            point[..., axis], point[..., (axis + 1) % 3], point[..., (axis + 2) % 3] = sign, sign * a, b
            point /= np.linalg.norm(point, axis=-1, keepdims=True)
            lattices.append(point[:, :, None] * radius[:, None])
    return joined(lattices, lambda side: "body" if np.linalg.norm(side[0, 0]) < 1.01 else "farfield")


def disc(n: int = 6, m: int = 6, core: float = 0.45) -> list[Floats]:
    """A unit disc in five lattices (n, m, 2), the four around the core with layers at the circle."""
    t = np.linspace(-core, core, n)
    low = np.full(n, -core)
    sides = [np.stack(pair, axis=-1) for pair in ((t, low), (-low, t), (t[::-1], -low), (low, t[::-1]))]
    depth = (1.0 - np.tanh(2.0 * np.linspace(1.0, 0.0, m)) / np.tanh(2.0))[None, :, None]
    lattices = [np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1)]
    for k, side in enumerate(sides):
        angle = -0.75 * np.pi + 0.5 * np.pi * (k + np.linspace(0.0, 1.0, n))
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        lattices.append((1.0 - depth) * circle[:, None] + depth * side[:, None])
    return lattices


def bend(n: int = 6, m: int = 6, along: int = 13, radius: float = 2.0) -> Grid:
    """A pipe of five blocks that turns by 90 degrees around y."""
    angle = np.linspace(0.0, np.pi / 2, along)
    lattices = []
    for plane in disc(n, m):
        away = radius + plane[..., 0, None]
        height = np.broadcast_to(plane[..., 1, None], (*plane.shape[:2], along))
        lattices.append(np.stack([away * np.cos(angle), height, away * np.sin(angle)], axis=-1))

    def name(side: Floats) -> str:
        flat = [label for label, axis in (("outlet", 0), ("inlet", 2)) if np.ptp(side[..., axis]) < 1e-9]
        return flat[0] if flat else "wall"

    return joined(lattices, name)


def perturbed(grid: Grid, size: float, seed: int = 0) -> Grid:
    """Each node inside moved at random by up to `size` times the shortest edge at it, alike in all blocks."""
    from meshonet.geometry.volume.hex_mesh import hex_mesh_of, with_nodes

    mesh = hex_mesh_of(grid)
    shortest = np.full(len(mesh.nodes), np.inf)
    for block in mesh.blocks:
        for axis in range(3):
            numbers = np.moveaxis(block, axis, 0)
            lengths = np.linalg.norm(np.diff(mesh.nodes[numbers], axis=0), axis=-1)
            np.minimum.at(shortest, numbers[1:], lengths)
            np.minimum.at(shortest, numbers[:-1], lengths)
    inner = np.flatnonzero(~mesh.outer)
    nodes = mesh.nodes.copy()
    way = np.random.default_rng(seed).uniform(-1.0, 1.0, (len(inner), 3))
    nodes[inner] += size * shortest[inner, None] * way
    return with_nodes(grid, mesh.with_nodes(nodes))
