"""A mesh of hexahedra as the compiled descent takes it: bricks of cells, and where forces on its nodes are.

Bricks (``kernels/hexes/energy.h``) are parts of blocks that fit into cache, their longest direction last.
They never reach over the end of a connection, so that a side of theirs has cells beyond it everywhere or
nowhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.elementary import exp
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.volume.hex_mesh import Bools, HexMesh, any_corner
from meshonet.kernels._native import BRICK

Targets = Sequence[tuple[Floats, Floats, Floats]]
"""Of each block the logarithms of wanted lengths of edges along xi, eta and zeta: (ni+1, nj, nk) with one
edge beyond either end, and so on."""


@dataclass(frozen=True, eq=False)
class Bricks:
    """Tables of the bricks that have something to do with nodes that move."""

    bricks: NDArray[np.int64]
    """(b, 8) cells along each direction, starts in the tables, and whether it is ragged."""
    lattices: NDArray[np.int32]
    inverse: Floats
    targets: NDArray[np.float32]
    own: NDArray[np.int32]
    """Numbers of the nodes of each brick, where their forces are."""


def bricks_of(mesh: HexMesh, moves: Bools, targets: Targets) -> Bricks:
    """Return the bricks of a mesh of which nodes `moves` (n,) are free."""
    rows: list[list[int]] = []
    tables: tuple[list[NDArray[Any]], ...] = ([], [], [], [])
    starts = [0] * len(tables)
    for brick in _bricks(mesh, moves, targets):
        counts = [n - 1 for n in brick.own.shape]
        rows.append([*counts, *starts[:3], 3 * starts[3], brick.ragged])
        parts: list[list[NDArray[Any]]] = [[brick.nodes], [brick.inverse], [*brick.targets], [brick.own]]
        for k, values in enumerate(parts):
            tables[k].extend(value.ravel() for value in values)
            starts[k] += sum(value.size for value in values)
    kinds = np.int32, np.float64, np.float32, np.int32
    joined = [
        np.concatenate([np.empty(0, kind), *table]).astype(kind, copy=False)
        for kind, table in zip(kinds, tables, strict=True)
    ]
    return Bricks(np.array(rows, dtype=np.int64).reshape(-1, 8), *joined)


@dataclass(frozen=True, eq=False)
class _Brick:
    """Node numbers with those beyond, reciprocal lengths, wanted edges, and its own node numbers."""

    nodes: Indices
    inverse: Floats
    targets: list[Floats]
    own: Indices
    ragged: bool


def _bricks(mesh: HexMesh, moves: Bools, targets: Targets) -> Iterator[_Brick]:
    free = np.append(moves, False)  # of -1, where there is no node
    for number, (wider, wanted) in enumerate(zip(mesh.beyond, targets, strict=True)):
        last = int(np.argmax(wider.shape))
        axes = [(last + 1) % 3, (last + 2) % 3, last]
        lattice = wider.transpose(axes)
        edges = [wanted[axis].transpose(axes) for axis in axes]
        moving = free[lattice]
        inverse = 1.0 / cell_lengths(edges)
        cuts = _cuts(mesh, number)
        pieces = [_pieces(cuts[axis], most) for axis, most in zip(axes, BRICK, strict=True)]
        for spans in product(*pieces):
            wide = tuple(slice(a, b + 3) for a, b in spans)
            if not moving[wide].any():
                continue
            inner = lattice[tuple(slice(a + 1, b + 2) for a, b in spans)]
            parts = [
                edges[d][tuple(slice(a, b + (2 if d == k else 1)) for k, (a, b) in enumerate(spans))]
                for d in range(3)
            ]
            cells = inverse[(slice(None), *(slice(a, b) for a, b in spans))]
            yield _Brick(lattice[wide], cells, parts, inner, _ragged(inner, free[inner]))


def cell_lengths(edges: Sequence[Floats]) -> Floats:
    """Return the wanted lengths (3, ni-1, nj-1, nk-1) of cells from `Targets` of their block."""
    means = []
    for d, values in enumerate(edges):
        inner = np.moveaxis(values, d, 0)[1:-1]
        mean = 0.25 * (inner[:, 1:, 1:] + inner[:, 1:, :-1] + inner[:, :-1, 1:] + inner[:, :-1, :-1])
        means.append(np.moveaxis(mean, 0, d))
    return exp(np.stack(means))


def _cuts(mesh: HexMesh, number: int) -> list[list[int]]:
    """Return the nodes along each direction of a block at which connections begin or end."""
    cuts = [{0, n - 1} for n in mesh.blocks[number].shape]
    for each in mesh.connections:
        for block, side, spans in each.ends:
            along = [axis for axis in range(3) if axis != PLACES[side][0]]
            for axis, span in zip(along, spans, strict=True):
                if block == number:
                    cuts[axis] |= set(span)
    return [sorted(each) for each in cuts]


def _pieces(cuts: list[int], most: int) -> list[tuple[int, int]]:
    """Return first and last nodes of pieces of `most` cells at the most between cuts."""
    pieces = []
    for a, b in pairwise(cuts):
        ends = np.linspace(a, b, -(-(b - a) // most) + 1).round().astype(int).tolist()
        pieces += list(pairwise(ends))
    return pieces


def _ragged(nodes: Indices, moving: Bools) -> bool:
    """Say whether edges have no length, or no node of a cell moves."""
    if any((np.diff(nodes, axis=axis) == 0).any() for axis in range(3)):
        return True
    return not any_corner(moving).all()


def forces_of(bricks: Bricks, moves: Bools) -> tuple[Indices, Indices, NDArray[np.int32]]:
    """Return the nodes that move, where each one's places start (k+1,), and the places of forces on them."""
    free = np.flatnonzero(moves)
    rank = np.cumsum(moves) - 1
    at = np.flatnonzero(moves[bricks.own])
    of = rank[bricks.own[at]]
    start = np.concatenate([[0], np.cumsum(np.bincount(of, minlength=len(free)))])
    return free, start.astype(np.intp), at[np.argsort(of, kind="stable")].astype(np.int32)
