"""A half and its mirror image: parts of sides stay where they are in space."""

import numpy as np

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.halves import with_image
from meshonet.geometry.blocks.patches import Patch


def box(low: tuple[float, ...], counts: tuple[int, ...]) -> Block:
    """Cubes of length 1 from a corner on."""
    axes = [start + np.arange(count) for start, count in zip(low, counts, strict=True)]
    return Block(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1))


def test_parts_of_sides_that_are_named_or_joined_are_mirrored() -> None:
    blocks = box((0, 0, 0), (6, 3, 3)), box((2, 2, 0), (3, 4, 2))  # the second on part of the first
    patches = (
        Patch("symmetry", "bottom", 0, 5, (0, 2)),
        Patch("symmetry", "bottom", 0, 2, (0, 3), block=1),
        Patch("slot wall", "south", 1, 2, (1, 2)),
        Patch("inlet", "west", 0, 1, (1, 2)),
    )
    half = Grid(blocks, patches, find_connections(blocks))
    whole = with_image(half)
    for connection in whole.connections:
        connection.check(whole.face)
    assert len(whole.connections) == len(find_connections(whole.blocks)) == 4
    for own, image in zip(whole.patches[:2], whole.patches[2:], strict=True):
        assert own.name == image.name
        there = whole.at(image)
        assert np.array_equal(whole.at(own) * [1, 1, -1], there if own.side == "west" else there[::-1])
