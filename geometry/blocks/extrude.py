"""Planar blocks repeated along z to make volumes, and the inverse: the plane that volumes repeat.

::

      +--------+      top of each block: the patch front, at the last height
     /   /   / |
    +--------+ |      patches and connections of the plane extend over all heights
    |  xi    | +
    |  eta   |/       bottom of each block: the patch back, at the first height
    +--------+
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import count
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.across import planar
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Kind, Patch, kind_of
from meshonet.geometry.errors import InputError

End: TypeAlias = tuple[str, Kind]  # name and kind of the patch that a plane becomes
BACK, FRONT = "back", "front"
"""Names of the planes at the first and at the last height, symmetry planes."""


def extruded(grid: Grid, heights: Sequence[float]) -> Grid:
    """Return the volumes of a planar `grid`, whose nodes are repeated at each z of `heights`.

    There are at least two heights, in increasing order. Patches and connections extend over all of them. In a
    grid around a body, the body becomes a wall unless its patches have another kind. The planes at the first
    and last height become the symmetry planes ``back`` and ``front``; other patches with these two names are
    renamed. Raises InputError: blocks that are not planar, fewer than two heights, heights that do not
    increase.
    """
    planar(grid)
    z = np.asarray(heights, dtype=np.float64)
    if len(z) < 2 or not (np.diff(z) > 0).all():
        raise InputError(f"heights {z.tolist()} do not increase", "give two or more that do")
    nodes = []
    for block in grid.blocks:  # in planar layout
        solid = np.empty((3, *block.counts, len(z)))
        solid[:2], solid[2] = np.moveaxis(block.nodes, -1, 0)[..., None], z
        nodes.append(np.moveaxis(solid, 0, -1))
    return thickened(grid, nodes, ((BACK, "symmetry"), (FRONT, "symmetry")))


def thickened(
    grid: Grid, nodes: Sequence[Floats], ends: tuple[End, End] | None, motion: Motion | None = None
) -> Grid:
    """Return a planar grid as volumes with the given `nodes`, and with its patches and connections.

    `nodes` has an array (ni, nj, nk, 3) of finite nodes for each block. Patches and connections extend over
    all planes of nodes. `ends` has the name and kind of the patch on the first plane, then on the last. If it
    is None, these planes are connected. They coincide, unless a `motion` from first to last is given. Raises
    InputError: blocks that are not planar; nodes that differ where blocks are connected.
    """
    planar(grid)
    planes = nodes[0].shape[2]
    connections = [thick(each, planes) for each in grid.connections]
    patches = _renamed(_with_walls(grid), [name for name, _ in ends or ()])
    for number, block in enumerate(grid.blocks):
        i, j = (n - 1 for n in block.counts)
        if ends is None:
            whole = ((0, i), (0, j))
            connections.append(Connection(number, "bottom", whole, number, "top", whole, (1, 2), motion))
            continue
        for side, (name, kind) in zip(("bottom", "top"), ends, strict=True):
            patches.append(Patch(name, side, 0, i, (0, j), number, kind))  # type: ignore[arg-type]
    blocks = tuple(Block(each, finite=True) for each in nodes)
    return replace(grid, blocks=blocks, patches=tuple(patches), connections=tuple(connections))


def plane_of_extruded(grid: Grid) -> Grid | None:
    """Return the planar grid from which the function `extruded` makes `grid`; None if there is none."""
    if any(block.nodes.shape[3:] != (3,) for block in grid.blocks):
        return None
    z = grid.blocks[0].nodes[0, 0, :, 2]
    ends = {(p.block, p.side): p for p in grid.patches if p.side in ("bottom", "top")}
    for number, block in enumerate(grid.blocks):
        back, front = ends.get((number, "bottom")), ends.get((number, "top"))
        if not back or not front or (back.name, front.name) != (BACK, FRONT):
            return None
        if block.counts[2] != len(z) or not np.array_equal(
            block.nodes[..., 2], np.broadcast_to(z, block.counts)
        ):
            return None
        if (block.nodes[..., :2] != block.nodes[:, :, :1, :2]).any():
            return None
    whole = (0, len(z) - 1)
    if any(each.range[1:] != (whole,) or each.orientation[1:] != (2,) for each in grid.connections):
        return None
    blocks = tuple(Block(block.nodes[:, :, 0, :2], finite=True) for block in grid.blocks)
    patches = [replace(p, across=None) for p in grid.patches if p.side not in ("bottom", "top")]
    connections = tuple(_flat(each) for each in grid.connections)
    flat = replace(grid, blocks=blocks, patches=(), connections=connections)
    if flat.around_body:
        patches = [
            replace(p, kind=kind_of(p.name)) if p.side == "south" and p.kind == "wall" else p for p in patches
        ]
        patches = [p for p in patches if p != Patch("south", "south", p.start, p.stop)]
    return replace(flat, patches=tuple(patches))


def _with_walls(grid: Grid) -> list[Patch]:
    """Return the patches of a planar grid, with those of a body as walls, which a volume cannot infer."""
    if not grid.around_body:
        return list(grid.patches)
    body = [p for p in grid.outer_patches() if p.side == "south"]
    walls = {p.name for p in body if p.kind in ("other", "interface")}
    patches = [replace(p, kind="wall") if p.side == "south" and p.name in walls else p for p in grid.patches]
    named = {p.name for p in grid.patches}
    return [*patches, *(replace(p, kind="wall") for p in body if p.name not in named)]


def _renamed(patches: Sequence[Patch], ends: Sequence[str]) -> list[Patch]:
    """Return `patches`, renamed where one has the name of an end plane (`ends`)."""
    taken = {*ends, *(patch.name for patch in patches)}
    new = {name: next(word for k in count(2) if (word := f"{name}-{k}") not in taken) for name in ends}
    return [replace(patch, name=new.get(patch.name, patch.name)) for patch in patches]


def thick(each: Connection, planes: int) -> Connection:
    """Return a connection of planar blocks as a connection of volumes, over `planes` planes of nodes."""
    whole = (0, planes - 1)
    ranges = (*each.range, whole), (*each.donor_range, whole)
    motion = each.transform
    if motion:
        turn = (*((*row, 0.0) for row in motion.turn), (0.0, 0.0, 1.0)) if motion.turn else ()
        motion = Motion((*motion.shift, 0.0) if motion.shift else (), turn)
    return replace(
        each, range=ranges[0], donor_range=ranges[1], orientation=(*each.orientation, 2), transform=motion
    )


def _flat(each: Connection) -> Connection:
    motion = each.transform
    if motion is not None:
        motion = Motion(motion.shift[:2], tuple(row[:2] for row in motion.turn[:2]))
    return replace(
        each,
        range=each.range[:1],
        donor_range=each.donor_range[:1],
        orientation=each.orientation[:1],
        transform=motion,
    )
