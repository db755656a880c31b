"""Grids of several blocks for formats: those of the other rooms, and passages with periodic sides."""

from collections.abc import Callable

import numpy as np
from block_grids import butterfly, duct, o_ring, turned

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.find_connections import find_connections, order
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes


def _passage(motion: Motion, name: str) -> Grid:
    """Three blocks in a row along x, the middle one turned; their lower sides are the upper ones moved."""
    x = np.linspace(0.1, 1.9, 13)
    low = np.stack([x + 1.0, 0.3 * np.sin(2 * x)], axis=-1)
    t = np.linspace(0, 1, 6)[None, :, None]
    whole = low[:, None] * (1 - t) + motion(low)[:, None] * t
    lattices = [whole[:5], turned(whole[4:9], 1), whole[8:]]
    blocks = tuple(Block(lattice) for lattice in lattices)
    seams = find_connections(blocks)
    joints = (
        Connection(0, "south", ((0, 4),), 0, "north", ((0, 4),), (1,), motion),
        Connection(1, "west", ((0, 4),), 1, "east", ((0, 4),), (1,), motion),
        Connection(2, "south", ((0, 4),), 2, "north", ((0, 4),), (1,), motion),
    )
    patches = [Patch("inlet", "west", 0, 5), Patch("outlet", "east", 0, 5, block=2)]
    for joint in joints:
        patches.append(Patch("periodic low", joint.side, 0, 4, block=joint.block))
        patches.append(Patch("periodic high", joint.donor_side, 0, 4, block=joint.donor))
    connections = tuple(sorted((*seams, *joints), key=order))
    return Grid(
        with_equal_nodes(blocks, connections), tuple(patches), connections, name, {"method": "formula"}
    )


def passage() -> Grid:
    """A passage whose upper side is the lower one shifted."""
    return _passage(Motion((0.1, 0.7)), "passage Ω")


def sector() -> Grid:
    """A passage whose upper side is the lower one turned by 40 degrees about the origin."""
    c, s = np.cos(np.radians(40)), np.sin(np.radians(40))
    return _passage(Motion((), ((float(c), -float(s)), (float(s), float(c)))), "sector")


def step() -> Grid:
    """A backward-facing step: a block that two others touch, one of them with half of a side."""
    x, y = np.meshgrid(np.linspace(0.0, 3.0, 13), np.linspace(0.0, 2.0, 9), indexing="ij")
    nodes = np.stack([x, y + 0.01 * np.sin(x)], axis=-1)
    blocks = (Block(nodes[:5, 4:]), Block(turned(nodes[4:], 3)))
    (joint,) = find_connections(blocks)
    patches = (
        Patch("inlet", "west", 0, 4), Patch("lower wall", "south", 0, 4), Patch("top", "north", 0, 4),
        Patch("lower wall", "north", 0, 4, block=1), Patch("outlet", "west", 0, 8, block=1),
    )  # fmt: skip
    return Grid(blocks, patches, (joint,), "step")


MANY: list[Callable[[], Grid]] = [butterfly, o_ring, duct, step, passage, sector]
"""Makers of grids of several blocks; all but the last two without periodic sides."""


def by_block(patches: tuple[Patch, ...]) -> tuple[Patch, ...]:
    """Patches in the order of their blocks, as files that store them block by block have them."""
    return tuple(sorted(patches, key=lambda patch: patch.block))


def sorted_joints(connections: tuple[Connection, ...]) -> list[Connection]:
    return sorted(connections, key=order)
