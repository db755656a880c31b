"""Cells and faces of a lattice of node numbers, in the node order of VTK.

Quadrilaterals and bottoms of hexahedra run counter-clockwise; the top follows. Faces do so from outside.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Side, ring_of
from meshonet.geometry.blocks.block import PLACES

Indices = NDArray[np.int64]


def cells_of(number: Indices) -> Indices:
    """Return the nodes (m, 4 or 8) of each cell of a block with the node numbers (ni, nj[, nk])."""
    if number.ndim == 2:
        return _flat(ring_of(number))
    below, above = ring_of(number[:, :, :-1]), ring_of(number[:, :, 1:])
    return _flat([*below, *above])


def cell_numbers(counts: Sequence[tuple[int, ...]]) -> list[Indices]:
    """Return, for each block, an array (ni-1, nj-1[, nk-1]) of cell numbers.

    Numbers begin at 0 and continue from block to block; i varies fastest. `counts` has the numbers of nodes
    (ni, nj[, nk]) of each block.
    """
    shapes = [tuple(n - 1 for n in count) for count in counts]
    ends = np.cumsum([0, *(int(np.prod(shape)) for shape in shapes)])
    return [
        np.arange(first, last).reshape(shape, order="F")
        for first, last, shape in zip(ends, ends[1:], shapes, strict=False)
    ]


def faces_of(side_numbers: Indices, side: Side) -> Indices:
    """Return the node numbers of the k cell edges (k, 2) or cell faces (k, 4) on a part of a block's side.

    `side_numbers` (n,) or (n, m) are the numbers of the nodes in this part; `side` is the name of the side.
    Edges have the domain on their left. The normals of faces point out of the domain.
    """
    if side_numbers.ndim == 1:
        rows = np.stack([side_numbers[:-1], side_numbers[1:]], axis=-1)
        return rows[:, ::-1] if side in ("north", "west") else rows
    faces = _flat(ring_of(side_numbers))
    axis, end = PLACES[side]
    points_out = (axis == 1) == (end == 0)  # the cross product of the side's directions
    return faces if points_out else faces[:, [0, 3, 2, 1]]


def _flat(corners: Sequence[Indices] | Indices) -> Indices:
    """Return one row per cell, the first index fastest."""
    return np.stack([corner.ravel(order="F") for corner in corners], axis=-1)
