"""Volume blocks over one table of nodes: a node of an interface, singular edge or pole exists once.

Blocks are arrays of node numbers, as in `meshonet.geometry.layout.layout.Layout`.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import AnyArray, Bools, Floats, Indices, Side, extent_of
from meshonet.geometry.blocks.block import PLACES, Block, face_of
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.handedness import signed_volume
from meshonet.geometry.blocks.shared_nodes import joined_labels, node_table
from meshonet.geometry.errors import InputError

FaceValues: TypeAlias = Callable[[int, Side], NDArray[Any]]
"""Function from the number of a block and a side to a view (n, m) of values at this side."""

_MOST = 0.8  # a block with a larger fraction of negative cells is left-handed, others have folded cells
POLE = 1e-12  # nodes of a line nearer than this fraction of the size of the grid coincide


@dataclass(frozen=True, eq=False)
class HexMesh:
    """Conforming hexahedra in blocks that share nodes."""

    nodes: Floats  # (n, 3) coordinates
    blocks: tuple[Indices, ...]  # right-handed arrays (ni, nj, nk) of node indices
    connections: tuple[Connection, ...]  # connections of the grid, without the periodic ones

    @property
    def cells(self) -> int:
        """Number of cells in all blocks."""
        return int(sum(np.prod([n - 1 for n in block.shape]) for block in self.blocks))

    @cached_property
    def outer(self) -> Bools:
        """Whether each node (n,) is on an unconnected part of a side."""
        outer = np.zeros(len(self.nodes), dtype=bool)
        for number, block in enumerate(self.blocks):
            for side in PLACES:
                face = face_of(block, side)
                free = self.free_cells(number, side)
                for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
                    outer[face[i : i + free.shape[0], j : j + free.shape[1]][free]] = True
        return outer

    def free_cells(self, number: int, side: Side) -> Bools:
        """Return whether each cell (n-1, m-1) of a side of block `number` is unconnected."""
        face = face_of(self.blocks[number], side)
        free = np.ones((face.shape[0] - 1, face.shape[1] - 1), dtype=bool)
        for each in self.connections:
            for block, joined, ((a, b), (c, d)) in each.ends:
                if (block, joined) == (number, side):
                    free[a:b, c:d] = False
        return free

    @cached_property
    def beyond(self) -> tuple[Indices, ...]:
        """Node indices (ni+2, nj+2, nk+2) of each block and of a layer around it; -1 at unconnected sides."""
        wider = tuple(np.pad(block, 1, constant_values=-1) for block in self.blocks)

        def outside(number: int, side: Side) -> Indices:
            axis = PLACES[side][0]
            inside = tuple(slice(None) if k == axis else slice(1, -1) for k in range(3))
            return face_of(wider[number][inside], side)

        def inside(number: int, side: Side) -> Indices:
            return second_layer(self.blocks[number], side)

        exchange(self.connections, outside, inside)
        return wider

    def with_nodes(self, nodes: Floats) -> Self:
        """Return the mesh with other coordinates `nodes` (n, 3)."""
        return replace(self, nodes=nodes)


def corners_of(values: AnyArray) -> Iterator[AnyArray]:
    """Yield views (ni-1, nj-1, nk-1) of `values` (ni, nj, nk), one for each of the 8 corners of cells."""
    for corner in np.ndindex(2, 2, 2):
        yield values[tuple(slice(c, c + n - 1) for c, n in zip(corner, values.shape, strict=True))]  # type: ignore[misc]


def any_corner(nodes: Bools) -> Bools:
    """Return for each cell whether any of its corners is in the mask `nodes` (ni, nj, nk)."""
    cells = nodes
    for axis in range(3):
        ends = np.moveaxis(cells, axis, 0)
        cells = np.moveaxis(ends[1:] | ends[:-1], 0, axis)
    return np.asarray(cells)


def second_layer(values: AnyArray, side: Side) -> AnyArray:
    """Return a view of `values` (ni, nj, nk) in the layer of nodes next to a side."""
    axis, end = PLACES[side]
    return np.moveaxis(values, axis, 0)[1 if end == 0 else -2]


def exchange(
    connections: Sequence[Connection], outside: FaceValues, inside: FaceValues
) -> None:  # fmt: skip
    """For each pair of connected sides, copy values just inside one side to the layer outside the other side.

    `inside` and `outside` are functions of block and side that return views of these two layers.
    """
    for each in connections:
        own_out, donor_out = each.nodes(lambda block, side: outside(block, side)[..., None])
        own_in, donor_in = each.nodes(lambda block, side: inside(block, side)[..., None])
        own_out[...], donor_out[...] = donor_in, own_in


def hex_mesh_of(grid: Grid) -> HexMesh:
    """Return the mesh of a volume grid. Raises InputError: a left-handed or a two-dimensional block."""
    for number, block in enumerate(grid.blocks):
        if len(block.counts) != 3:
            sizes = " x ".join(map(str, block.counts))
            raise InputError(
                f"block {number} of {sizes} nodes is no volume", "give blocks of three directions"
            )
        if _left_handed(block.nodes):
            remedy = "reverse one of its directions"
            raise InputError("the block is left-handed", remedy, place=f"block {number}")
    joined = tuple(each for each in grid.connections if each.transform is None)
    return HexMesh(*_with_poles(*node_table(grid.blocks, joined)), joined)


def _left_handed(nodes: Floats) -> bool:
    """Return whether a block and most of its cells have negative volumes."""
    corner = nodes[:-1, :-1, :-1]
    with np.errstate(over="ignore", invalid="ignore"):
        if not signed_volume([nodes[..., axis] for axis in range(3)]) < 0:
            return False
        u, v, w = nodes[1:, :-1, :-1] - corner, nodes[:-1, 1:, :-1] - corner, nodes[:-1, :-1, 1:] - corner
        return bool(np.mean((u * np.cross(v, w)).sum(axis=-1) < 0) > _MOST)


def _with_poles(nodes: Floats, numbers: tuple[Indices, ...]) -> tuple[Floats, tuple[Indices, ...]]:
    """Return nodes and blocks, with coinciding nodes of lines of sides made one."""
    near = POLE * extent_of(nodes)
    pairs = [
        pair for number in numbers for side in PLACES for pair in _poles(face_of(number, side), nodes, near)
    ]
    if not pairs:
        return nodes, numbers
    first, second = (np.concatenate(ends) for ends in zip(*pairs, strict=True))
    label = joined_labels(len(nodes), [(first, second)])
    kept = np.unique(label, return_index=True)[1]
    return nodes[kept], tuple(label[number] for number in numbers)


def _poles(face: Indices, nodes: Floats, near: float) -> list[tuple[Indices, Indices]]:
    """Return pairs of nodes on lines of a side (n, m) whose nodes all coincide."""
    pairs = []
    for lines in (face, face.T):
        places = nodes[lines]
        collapsed = (np.abs(places - places[:1]) <= near).all(axis=(0, 2))
        if collapsed.any():
            among = lines[:, collapsed]
            pairs.append((np.broadcast_to(among[:1], among.shape).ravel(), among.ravel()))
    return pairs


def with_nodes(grid: Grid, mesh: HexMesh) -> Grid:
    """Return `grid` with the nodes of `mesh`, which was made from it; nodes of connected sides are equal."""
    return replace(grid, blocks=tuple(Block(mesh.nodes[block]) for block in mesh.blocks))
