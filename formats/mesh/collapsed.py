"""Degenerate sides of volumes, collapsed to a line (an axis) or a point (a pole).

Coincident nodes get one number: cells there have six or five nodes, and faces without area are left out.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Bools, Side
from meshonet.geometry.blocks.block import PLACES, face_of, sides_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.shared_nodes import joined_labels
from meshonet.geometry.errors import InputError

Indices = NDArray[np.int64]


def collapsed_edges(grid: Grid) -> Iterator[tuple[int, Side, int, Bools]]:
    """Yield where sides of volumes have edges of zero length: block number, side, direction and mask.

    The edges run along direction 0 or 1 of the side. The mask covers all edges of the side that do so.
    """
    for number, block in enumerate(grid.blocks):
        for side in sides_of(block.counts) if len(block.counts) == 3 else ():
            face = block.face(side)
            for direction, (first, second) in enumerate(((face[1:], face[:-1]), (face[:, 1:], face[:, :-1]))):
                same = (first == second).all(axis=-1)
                if same.any():
                    yield number, side, direction, same


def with_collapsed(grid: Grid, numbers: list[Indices]) -> list[Indices]:
    """Return the node `numbers` of all blocks; both ends of an edge of zero length get the same number.

    The new numbers have no gaps. Without edges of zero length, `numbers` itself is returned.
    """
    edges = list(collapsed_edges(grid))
    if not edges:
        return numbers
    pairs = []
    for block, side, direction, same in edges:
        face = face_of(numbers[block], side)
        first, second = (face[1:], face[:-1]) if direction == 0 else (face[:, 1:], face[:, :-1])
        pairs.append(np.stack([first[same], second[same]], axis=-1))
    joined = np.concatenate(pairs)
    label = joined_labels(1 + max(int(number.max()) for number in numbers), [(joined[:, 0], joined[:, 1])])
    return [label[number] for number in numbers]


def refuse_collapsed(grid: Grid, what: str) -> None:
    """Raise InputError if a volume has edges of zero length on a side; `what` names the format."""
    for block, side, direction, same in collapsed_edges(grid):
        place = [int(index) for index in np.argwhere(same)[0]]
        axes = [name for axis, name in enumerate("ijk") if axis != PLACES[side][0]]
        at = ", ".join(f"{name}={index}" for name, index in zip(axes, place, strict=True))
        x, y, z = grid.blocks[block].face(side)[tuple(place)]
        problem = f"{what} has hexahedra, and an edge along {axes[direction]} has no length"
        raise InputError(
            problem,
            "write cgns, plot3d, vtm or openfoam",
            place=f"block {block}, {side}, {at}, x={x:.6g}, y={y:.6g}, z={z:.6g}",
        )
