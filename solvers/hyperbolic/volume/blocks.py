"""The grid of a volume marched from a surface: one block per patch."""

from dataclasses import replace
from itertools import groupby

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Side
from meshonet.geometry.blocks.block import Block, face_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.layout.shared_sides import key_of, shared, shared_in_part
from meshonet.geometry.surface.surface import Surface

_SIDES: tuple[Side, ...] = ("west", "east", "south", "north")
SYMMETRY, FREE = "symmetry", "free"


def blocks_of(surface: Surface, lines: Floats) -> tuple[Block, ...]:
    """Return a block for each patch of a surface; `lines` (3, n, levels) start at the surface's n nodes."""
    return tuple(Block(np.moveaxis(lines[:, lattice], 0, -1)) for lattice in surface.lattices)


def volume_grid(surface: Surface, blocks: tuple[Block, ...], in_plane: Bools) -> Grid:
    """Return the grid of `blocks`; `in_plane` (k,) is True for open edges in planes of symmetry."""
    top = blocks[0].counts[2] - 1
    sides = [
        (b, side, face_of(lattice, side)) for b, lattice in enumerate(surface.lattices) for side in _SIDES
    ]
    whole, rest = shared(sides)
    partly, outer = shared_in_part(rest)
    order = sorted((*whole, *partly), key=lambda each: (each.block, _SIDES.index(each.side), each.range))
    connections = tuple(
        replace(
            each, range=(*each.range, (0, top)), donor_range=(*each.donor_range, (0, top)),
            orientation=(*each.orientation, 2),
        )
        for each in order
    )  # fmt: skip
    plane = {key_of(edge): bool(flag) for edge, flag in zip(surface.open_edges, in_plane, strict=True)}
    patches = []
    for number, (lattice, name) in enumerate(zip(surface.lattices, surface.names, strict=True)):
        ni, nj = lattice.shape
        patches += [
            Patch(name, "bottom", 0, ni - 1, (0, nj - 1), number, "wall"),
            Patch("farfield", "top", 0, ni - 1, (0, nj - 1), number),
        ]
        for (block, side, nodes), start in outer:
            for flat, run in groupby(range(len(nodes) - 1), key=lambda k: plane[key_of(nodes[k : k + 2])]):
                stop = start + len(list(run))
                if block == number:
                    patches.append(Patch(SYMMETRY if flat else FREE, side, start, stop, (0, top), number))
                start = stop
    return Grid(blocks, tuple(patches), connections)
