"""Completes grids that are symmetric about the plane z = 0: a half and its mirror image.

::

    +------+------+      i of the image runs the other way, so that its blocks are right-handed too. Patches
    | half | image|      in the plane of symmetry become connections; the others have the same names on both
    +------+------+      sides.
         z = 0
"""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import Block, Range, face_counts
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch

_OTHER: dict[Side, Side] = {"west": "east", "east": "west"}  # sides that are exchanged if i is reversed


def with_image(half: Grid) -> Grid:
    """Return a three-dimensional grid and its mirror image in z = 0, joined at its patches of kind symmetry.

    The nodes of these patches lie in z = 0 exactly. The blocks of the image follow those of `half` in the
    same order; the names of blocks get the ending ``-image``. The grid must not be periodic.
    """
    step, image = len(half.blocks), with_i_reversed(half)
    blocks = (*half.blocks, *map(_mirrored, image.blocks))
    own, images, joints = [], [], list(half.connections)
    for patch, other in zip(half.patches, image.patches, strict=True):
        block = half.blocks[patch.block]
        sides = face_counts(block.counts, patch.side)
        if patch.kind == "symmetry":
            ways = _ways(tuple(range(1, len(sides) + 1)), patch.side)
            own_end = patch.block, patch.side, patch.range(sides)
            joints.append(Connection(*own_end, other.block + step, other.side, other.range(sides), ways))
            continue
        own.append(patch)
        images.append(replace(other, block=other.block + step))
    for each in image.connections:
        joints.append(replace(each, block=each.block + step, donor=each.donor + step))
    facts = dict(half.provenance)
    if "zones" in facts:
        facts["zones"] = [*facts["zones"], *(f"{name}-image" for name in facts["zones"])]
    return replace(half, blocks=blocks, patches=(*own, *images), connections=tuple(joints), provenance=facts)


def with_i_reversed(grid: Grid) -> Grid:
    """Return a grid with the direction of i reversed in all blocks, which changes their handedness.

    The grid must not be periodic.
    """
    counts = [block.counts for block in grid.blocks]
    patches, joints = [], []
    for patch in grid.patches:
        sides = face_counts(counts[patch.block], patch.side)
        patches.append(_on(patch, *_reversed(patch.side, patch.range(sides), counts[patch.block])))
    for each in grid.connections:
        own_end, donor_end = ((k, *_reversed(side, span, counts[k])) for k, side, span in each.ends)
        ways = _ways(_ways(each.orientation, each.side), each.donor_side, donor=True)
        joints.append(Connection(*own_end, *donor_end, ways))
    blocks = tuple(Block(np.array(block.nodes[::-1], order="K"), finite=True) for block in grid.blocks)
    return replace(grid, blocks=blocks, patches=tuple(patches), connections=tuple(joints))


def _mirrored(block: Block) -> Block:
    """Return the mirror image of a block in z = 0; 0 keeps its sign."""
    nodes = block.nodes.copy(order="K")
    nodes[..., 2] = 0.0 - nodes[..., 2]
    return Block(nodes, finite=True)


def _reversed(side: Side, span: Range, counts: tuple[int, ...]) -> tuple[Side, Range]:
    """Return a side, and a range of its nodes, of a block with `counts` nodes after i is reversed."""
    if side in _OTHER:
        return _OTHER[side], span
    first, last = span[0]
    return side, ((counts[0] - 1 - last, counts[0] - 1 - first), *span[1:])


def _ways(ways: tuple[int, ...], side: Side, *, donor: bool = False) -> tuple[int, ...]:
    """Return the orientation of a connection after i of the block of a side is reversed."""
    if side in _OTHER:
        return ways
    return tuple(-way if (abs(way) if donor else k) == 1 else way for k, way in enumerate(ways, start=1))


def _on(patch: Patch, side: Side, span: Range) -> Patch:
    across = patch.across and span[1]
    return replace(patch, side=side, start=span[0][0], stop=span[0][1], across=across)
