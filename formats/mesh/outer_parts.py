"""The boundary of a grid of blocks as named faces, each with the cell behind it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.mesh.cell_faces import cell_numbers, faces_of
from meshonet.formats.mesh.periodic import Part, PeriodicPair, periodic_pairs
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.grid import Grid

Indices = NDArray[np.int64]


def outer_parts(grid: Grid, numbers: Sequence[Indices]) -> tuple[dict[str, Part], tuple[PeriodicPair, ...]]:
    """Return the outer faces by name, those of periodic pairs last, and these pairs.

    `numbers` are those of the nodes of each block. Faces that connections join belong to no part; an outer
    one that nobody named is called by its side.
    """
    cells = cell_numbers([block.counts for block in grid.blocks])
    pieces: dict[str, list[Part]] = {}
    for patch in grid.outer_patches():
        side = face_of(numbers[patch.block], patch.side)
        ranges = patch.range(side.shape)
        nodes = side[tuple(slice(start, stop + 1) for start, stop in ranges)]
        behind = face_of(cells[patch.block], patch.side)[tuple(slice(*span) for span in ranges)]
        part = Part(faces_of(nodes, patch.side), behind.ravel(order="F"))
        pieces.setdefault(patch.name, []).append(part)
    parts = {name: Part(*map(np.concatenate, zip(*several, strict=True))) for name, several in pieces.items()}
    pairs = tuple(periodic_pairs(grid, numbers, cells, parts))
    for pair in pairs:
        parts |= {pair.name: pair.own, pair.partner: pair.opposite}
    return parts, pairs
