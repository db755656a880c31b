"""Grids of many blocks made by hand, whose sides are joined by comparing all of them."""

from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch

Namer = Callable[[Floats], str]


def joined(lattices: Sequence[Floats], namer: Namer, name: str = "") -> Grid:
    """The grid of nodes (ni, nj, 2) each, whole sides connected where nodes are the same."""
    blocks = tuple(Block(nodes) for nodes in lattices)
    free = [(number, side) for number in range(len(blocks)) for side in SIDES]
    connections, taken = [], set()
    for (a, first), (b, second) in combinations(free, 2):
        own, donor = blocks[a].face(first), blocks[b].face(second)
        if (a, first) in taken or (b, second) in taken or len(own) != len(donor):
            continue
        for way in (1, -1):
            if np.array_equal(own, donor[::way]):
                span = ((0, len(own) - 1),)
                connections.append(Connection(a, first, span, b, second, span, (way,)))
                taken |= {(a, first), (b, second)}
                break
    patches = [
        Patch(namer(blocks[k].face(side)), side, 0, len(blocks[k].face(side)) - 1, block=k)
        for k, side in free
        if (k, side) not in taken
    ]
    return Grid(blocks, tuple(patches), tuple(connections), name)


def turned(nodes: Floats, quarters: int) -> Floats:
    """The same nodes (ni, nj, 2), still right-handed, i running where j or its reverse did."""
    for _ in range(quarters % 4):
        nodes = np.swapaxes(nodes, 0, 1)[:, ::-1]
    return nodes


def between(low: Floats, high: Floats, n: int) -> Floats:
    """Lattice (m, n, 2) of straight lines between two sides (m, 2), whose nodes are kept bitwise."""
    t = np.linspace(0.0, 1.0, n)[None, :, None]
    nodes = (1 - t) * low[:, None] + t * high[:, None]
    nodes[:, 0], nodes[:, -1] = low, high
    return nodes


def butterfly(n: int = 7, m: int = 5, core: float = 0.45) -> Grid:
    """A unit disc in five blocks; the four around the core have i along the circle, one of them turned."""
    t = np.linspace(-core, core, n)
    low = np.full(n, -core)
    sides = [np.stack(pair, axis=-1) for pair in ((t, low), (-low, t), (t[::-1], -low), (low, t[::-1]))]
    inner = np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1)
    lattices = [inner]
    for k, side in enumerate(sides):
        angle = -0.75 * np.pi + 0.5 * np.pi * (k + np.linspace(0.0, 1.0, n))
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        circle[[0, -1]] = np.array([_corner(k), _corner(k + 1)])
        lattice = between(circle, side, m)
        lattices.append(turned(lattice, 1) if k == 2 else lattice)
    return joined(lattices, lambda _: "wall", "butterfly")


def _corner(k: int) -> tuple[float, float]:
    half = np.sqrt(0.5)
    return [(-half, -half), (half, -half), (half, half), (-half, half)][k % 4]


def o_ring(n: int = 7, m: int = 6, growth: float = 1.2) -> Grid:
    """Four blocks between circles of radius 1 and 3, i clockwise, first cells at the wall thin."""
    steps = growth ** np.arange(m - 1)
    radius = 1.0 + 2.0 * np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum()
    angle = -2 * np.pi * np.arange(4 * (n - 1) + 1) / (4 * (n - 1))
    whole = np.stack([np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius)], axis=-1)
    whole[-1] = whole[0]
    lattices = [whole[k * (n - 1) : (k + 1) * (n - 1) + 1] for k in range(4)]
    return joined(
        lattices, lambda side: "wall" if np.hypot(*side.mean(axis=0)) < 1.01 else "farfield", "ring"
    )


def duct(quarters: int = 1, ni: int = 9, nj: int = 5, bend: float = 0.0) -> Grid:
    """Two blocks, each 2 long and 1 high; the second is `quarters` turns round in its indices.

    With `bend` the second one rises by so much per length, so that lines have a kink at x = 2.
    """
    x, y = np.meshgrid(np.linspace(0.0, 4.0, 2 * ni - 1), np.linspace(0.0, 1.0, nj), indexing="ij")
    nodes = np.stack([x, y + bend * np.maximum(x - 2.0, 0.0)], axis=-1)
    lattices = [nodes[:ni], turned(nodes[ni - 1 :], quarters)]
    names = {0.0: "inlet", 4.0: "outlet"}
    return joined(lattices, lambda side: names.get(float(np.ptp(side[:, 0]) or side[0, 0]), "wall"), "duct")
