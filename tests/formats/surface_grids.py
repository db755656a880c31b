"""Surfaces of one and of many patches, made by hand: closed, open, with patches turned in all ways."""

from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes


def _of(lattices: list[Floats], name: str, patches: tuple[Patch, ...] = ()) -> Grid:
    blocks = [Block(nodes) for nodes in lattices]
    seams = find_connections(blocks)
    return Grid(with_equal_nodes(blocks, seams), patches, seams, name, {"method": "formula"})


def sphere(n: int = 5) -> Grid:
    """Six patches of a unit sphere, normals outwards, some with their indices turned by a quarter."""
    u, v = np.meshgrid(*(np.linspace(-1, 1, n + k) for k in (0, 0)), indexing="ij")
    one = np.ones_like(u)
    sides = [(u, v, one), (v, u, -one), (one, u, v), (-one, v, u), (v, one, u), (u, -one, v)]
    patches = []
    for k, side in enumerate(sides):
        nodes = np.stack(side, axis=-1)
        nodes = nodes / np.sqrt((nodes**2).sum(axis=-1, keepdims=True))
        patches.append(np.swapaxes(nodes, 0, 1)[::-1] if k in (1, 4) else nodes)
    return _of(patches, "sphere Ω")


def shell() -> Grid:
    """A half of a cylinder of two patches of different counts, with named edges."""
    angle, z = np.meshgrid(np.linspace(0, np.pi, 13), np.linspace(0, 2, 6), indexing="ij")
    nodes = np.stack([np.cos(angle), np.sin(angle), z + 0.1 * np.sin(angle)], axis=-1)
    patches = (Patch("symmetry", "west", 0, 5), Patch("free edge", "south", 1, 4, kind="outlet"))
    return _of([nodes[:6], nodes[5:]], "shell", patches)


def tube() -> Grid:
    """One patch around a cylinder, which meets itself."""
    angle, z = np.meshgrid(np.linspace(0, 2 * np.pi, 17), np.linspace(0, 2, 4), indexing="ij")
    nodes = np.stack([np.cos(angle), np.sin(angle), z], axis=-1)
    nodes[-1] = nodes[0]
    return _of([nodes], "tube")


def leaf() -> Grid:
    """One curved patch."""
    x, y = np.meshgrid(np.linspace(0, 1, 7), np.linspace(0, 1, 5), indexing="ij")
    return _of([np.stack([x, y, 0.2 * x * y], axis=-1)], "leaf")


def sheet() -> Grid:
    """One flat patch in the plane z = 0: only its file can say that it is a surface."""
    x, y = np.meshgrid(np.linspace(0, 1, 7), np.linspace(0, 1, 5), indexing="ij")
    return _of([np.stack([x, y, 0 * x], axis=-1)], "sheet")


SURFACES: list[Callable[[], Grid]] = [sphere, shell, tube, leaf]
"""Makers of surfaces that no file can take for a grid in the plane."""
