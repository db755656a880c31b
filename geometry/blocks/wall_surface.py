"""The walls of a volume grid as a surface grid."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import SIDES
from meshonet.geometry.blocks.block import Block, face_of, part_of
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch


def wall_surface(grid: Grid) -> Grid:
    """Return the walls of a volume as a grid of a surface, with normals that point into the volume.

    Blocks of the volume must be right-handed. Edges of the surface that lie in the plane of symmetry (z = 0
    or y = 0) and are not joined to other edges become the patch ``symmetry``. Blocks are named after the
    walls.
    """
    walls = [patch for patch in grid.patches if patch.kind == "wall"]
    blocks = [_outwards(grid, patch) for patch in walls]
    zones = {"zones": [patch.name for patch in walls]}
    surface = Grid(tuple(blocks), (), find_connections(blocks), grid.name, zones)
    return replace(surface, patches=tuple(_symmetry(surface, _axis(grid))))


def _axis(grid: Grid) -> int:
    """Return the axis across the plane of symmetry: 1 or 2, for y or z."""
    sides = [grid.face(each.block, each.side) for each in grid.patches if each.kind == "symmetry"]
    return 1 if sides and not any(side[..., 1].any() for side in sides) else 2


def _outwards(grid: Grid, patch: Patch) -> Block:
    """Return the nodes (n, m, 3) of a patch, i x j into the volume."""
    face = face_of(grid.blocks[patch.block].nodes, patch.side)
    nodes = part_of(face, patch.range(face.shape[:2]))
    axis, end = patch.place
    inwards = (axis != 1) == (end == 0)
    return Block(np.ascontiguousarray(nodes if inwards else nodes.swapaxes(0, 1)))


def _symmetry(surface: Grid, axis: int) -> list[Patch]:
    patches = []
    for number, (block, joined) in enumerate(zip(surface.blocks, surface.joined_ranges(), strict=True)):
        for side in SIDES:
            edge = face_of(block.nodes[..., axis], side)
            if not edge.any() and side not in [each for each, _ in joined]:
                patches.append(Patch("symmetry", side, 0, len(edge) - 1, block=number))
    return patches
