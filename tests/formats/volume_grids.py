"""Volumes of one and of many blocks, made by hand, blocks of the pipe turned in all ways."""

from collections.abc import Callable
from dataclasses import replace
from itertools import combinations, product

import numpy as np
from block_grids import butterfly, o_ring
from format_shapes import c_grid
from many_blocks import passage, sector, step

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import PLACES, Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes

HEIGHTS = (0.0, 0.3, 0.7, 1.0, 1.6)


def box(name: str = "box Ω") -> Grid:
    """A skewed box, with a wall on a part of its bottom."""
    x, y, z = np.meshgrid(*(np.linspace(0, 1, n) for n in (5, 4, 6)), indexing="ij")
    nodes = np.stack([2 * x + 0.1 * y * z, y + 0.2 * np.sin(2 * x), z + 0.1 * x * y], axis=-1)
    patches = (
        Patch("in let", "west", 0, 3), Patch("outlet", "east", 0, 3),
        Patch("plate", "bottom", 1, 4, (0, 2), kind="wall"), Patch("symmetry", "south", 0, 4),
    )  # fmt: skip
    return Grid((Block(nodes),), patches, (), name, {"method": "formula"})


def pipe() -> Grid:
    """A bend of a quarter of a circle, its section a butterfly, its blocks turned in all ways."""
    straight = extruded(butterfly(), np.linspace(0.0, 1.0, 6).tolist())
    lattices = [_cycled(_bent(block.nodes, 3.0), k) for k, block in enumerate(straight.blocks)]
    return joined(lattices, _of_pipe, "pipe")


def _bent(nodes: Floats, radius: float) -> Floats:
    """Nodes of a straight unit duct along z, bent by a quarter of a circle around the y axis."""
    x, y, z = np.moveaxis(nodes, -1, 0)
    angle = 0.5 * np.pi * z
    return np.stack([radius - (radius - x) * np.cos(angle), y, (radius - x) * np.sin(angle)], axis=-1)


def _of_pipe(face: Floats) -> str:
    x, _, z = np.moveaxis(face.reshape(-1, 3), -1, 0)
    if np.allclose(z, 0):
        return "inlet"
    return "outlet" if np.allclose(x, 3) else "wall"


def _cycled(nodes: Floats, times: int) -> Floats:
    """The same nodes, i running where j or k did; right-handed as they were."""
    for _ in range(times % 3):
        nodes = np.moveaxis(nodes, 0, 2)
    return nodes[::-1, :, ::-1] if times % 2 else nodes


def joined(lattices: list[Floats], namer: Callable[[Floats], str], name: str) -> Grid:
    """The grid of nodes (ni, nj, nk, 3) each, whole sides connected where nodes are the same."""
    blocks = tuple(Block(nodes) for nodes in lattices)
    free = list(product(range(len(blocks)), PLACES))
    connections, taken = [], set[tuple[int, str]]()
    for (a, first), (b, second) in combinations(free, 2):
        own, donor = blocks[a].face(first), blocks[b].face(second)
        for order, one, two in product(((1, 2), (2, 1)), (1, -1), (1, -1)):
            seen = donor.transpose(order[0] - 1, order[1] - 1, 2)[::one, ::two]
            if np.array_equal(own, seen) and not taken & {(a, first), (b, second)}:
                spans = [tuple((0, n - 1) for n in face.shape[:2]) for face in (own, donor)]
                ways = order[0] * one, order[1] * two
                connections.append(Connection(a, first, spans[0], b, second, spans[1], ways))
                taken |= {(a, first), (b, second)}
    patches = []
    for k, side in free:
        if (k, side) not in taken:
            n, m = blocks[k].face(side).shape[:2]
            title = namer(blocks[k].face(side))
            patches.append(Patch(title, side, 0, n - 1, (0, m - 1), k))
    return Grid(blocks, tuple(patches), tuple(connections), name, {"method": "formula"})


def twisted(make: Callable[[], Grid]) -> Grid:
    """A plane grid repeated in z, turned about z as it goes up."""
    grid = extruded(make(), HEIGHTS)
    blocks = []
    for block in grid.blocks:
        x, y, z = np.moveaxis(block.nodes, -1, 0)
        c, s = np.cos(0.3 * z), np.sin(0.3 * z)
        blocks.append(Block(np.stack([c * x - s * y, s * x + c * y, z + 0.05 * x], axis=-1)))
    return replace(grid, blocks=tuple(blocks))


def ring() -> Grid:
    """Four blocks in a ring."""
    return twisted(o_ring)


def c_volume() -> Grid:
    """A block that meets itself along its wake."""
    return twisted(lambda: c_grid(6, 9, 4))


def stepped() -> Grid:
    """A block that meets two others with parts of its side."""
    return twisted(step)


def shifted() -> Grid:
    """A passage of three blocks with periodic sides, laid over."""
    return _laid_over(extruded(passage(), HEIGHTS))


def turned_sector() -> Grid:
    """A sector of 40 degrees about a tilted axis off the origin."""
    return _laid_over(extruded(sector(), HEIGHTS))


def _laid_over(grid: Grid) -> Grid:
    """A grid turned in space, its motions along."""
    a, b = 0.6, 0.4
    about_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    whole = Motion((0.3, -0.2, 0.5), tuple(map(tuple, (about_y @ about_x).tolist())))
    blocks = [Block(whole(block.nodes)) for block in grid.blocks]
    motions: dict[Motion, Motion] = {}
    connections = []
    for each in grid.connections:
        if each.transform is not None and each.transform not in motions:
            turn = np.array(each.transform.turn or np.eye(3))
            shift = np.array(each.transform.shift or np.zeros(3))
            outer, origin = np.array(whole.turn), np.array(whole.shift)
            new = outer @ turn @ outer.T
            moved = outer @ shift + origin - new @ origin
            rows = tuple(map(tuple, new.tolist())) if each.transform.turn else ()
            motions[each.transform] = Motion(tuple(moved.tolist()), rows)
        motion = each.transform and motions[each.transform]
        connections.append(replace(each, transform=motion))
    return replace(grid, blocks=with_equal_nodes(blocks, connections), connections=tuple(connections))


VOLUMES: list[Callable[[], Grid]] = [box, pipe, ring, c_volume, stepped, shifted, turned_sector]
"""Makers of volumes; the last two have periodic sides."""
