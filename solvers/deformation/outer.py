"""All nodes of a grid in one table, and the pieces of its outer boundary as indices into this table."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, norms
from meshonet.geometry.blocks.across import rows_at
from meshonet.geometry.blocks.block import Block, face_of, part_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.shared_nodes import node_table
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.lattice import lattice_quads

_BACKWARDS = ("north", "west")  # sides with the domain on the right, in the order of their indices


@dataclass(frozen=True, eq=False)
class Piece:
    """A piece of the outer boundary: its patch and the indices (n,) or (m, n) of its nodes.

    In the plane, the nodes are ordered so that the domain is on the left.
    """

    patch: Patch
    numbers: Indices


@dataclass(frozen=True, eq=False)
class NodeTable:
    """All nodes of a grid; a node shared by several blocks occurs once."""

    grid: Grid
    nodes: Floats  # (n, d) coordinates of the nodes
    numbers: tuple[Indices, ...]
    """For each block, the indices (ni, nj) or (ni, nj, nk) of its nodes in `nodes`."""

    @classmethod
    def of(cls, grid: Grid) -> Self:
        """Return the nodes of a planar grid or a volume. Raises InputError if the grid is a surface."""
        if grid.form == "surface":
            raise InputError("a surface has no cells that could follow it", "give a planar grid or a volume")
        return cls(grid, *node_table(grid.blocks, grid.connections))

    def with_nodes(self, nodes: Floats) -> tuple[Block, ...]:
        """Return the blocks of the grid with the node coordinates `nodes` (n, d)."""
        planes = np.moveaxis(nodes, -1, 0)
        blocks = []
        for number in self.numbers:
            filled = np.stack([plane[number] for plane in planes])
            blocks.append(Block(np.moveaxis(filled, 0, -1), finite=True))
        return tuple(blocks)

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """The whole outer boundary as pieces, one for each patch; on periodic sides the patch has no name."""
        periodic = [
            Patch("", side, *span[0], across=span[1] if span[1:] else None, block=block)
            for each in self.grid.connections
            if each.transform is not None
            for block, side, span in each.ends
        ]
        return tuple(self.piece(patch) for patch in (*self.grid.outer_patches(), *periodic))

    def piece(self, patch: Patch) -> Piece:
        """Return the piece of the boundary that `patch` covers."""
        face = face_of(self.numbers[patch.block], patch.side)
        span = patch.range(face.shape)
        numbers = part_of(face, span)
        if numbers.ndim == 1 and patch.side in _BACKWARDS:
            numbers = numbers[::-1]
        return Piece(patch, numbers)

    @cached_property
    def outer(self) -> Bools:
        """Mask (n,) of the nodes on the outer boundary."""
        on = np.zeros(len(self.nodes), dtype=bool)
        for piece in self.pieces:
            on[piece.numbers.ravel()] = True
        return on


def lines_of(pieces: Sequence[Piece]) -> list[Indices]:
    """Join boundary pieces of a planar grid to polylines of node indices (n,); closed ones repeat a node."""
    left = [piece.numbers for piece in pieces]
    lines = []
    while left:
        line = left.pop(0)
        joined = True
        while joined and line[0] != line[-1]:
            joined = False
            for k, other in enumerate(left):
                if other[0] == line[-1] or other[-1] == line[0]:
                    ends = (line, other) if other[0] == line[-1] else (other, line)
                    line, joined = np.concatenate([ends[0], ends[1][1:]]), True
                    del left[k]
                    break
        lines.append(line)
    return lines


def elements_of(pieces: Sequence[Piece], dimension: int) -> Indices:
    """Return the edges (m, 2) or, in volumes, the quadrilaterals (m, 4) of `pieces` of the outer boundary."""
    if dimension == 2:
        parts = [np.stack([p.numbers[:-1], p.numbers[1:]], axis=1) for p in pieces]
    else:
        parts = [lattice_quads([p.numbers for p in pieces])] if pieces else []
    return np.concatenate(parts) if parts else np.empty((0, 2 * (dimension - 1)), dtype=np.intp)


def first_heights(grid: Grid, pieces: Sequence[Piece]) -> Floats:
    """Return the distance (n,) of each node of `pieces` from the next inner node: the first-cell height."""
    heights = []
    for piece in pieces:
        own, beside = rows_at(grid, piece.patch, 2)
        heights.append(norms(beside - own).ravel())
    return np.concatenate(heights)
