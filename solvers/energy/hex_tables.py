"""Tables of a hexahedral mesh for the compiled minimisation (``kernels/hexes/energy.h``).

Only the part of each block around free nodes is stored, with its longest direction last.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.elementary import exp
from meshonet.geometry.volume.hex_mesh import HexMesh, any_corner, corners_of

BlockTargets: TypeAlias = tuple[Floats, Floats, Floats]
Targets = Sequence[BlockTargets]
"""For each block, logarithms of target lengths of edges along xi, eta and zeta.

The shape along xi is (ni + 1, nj, nk), with one edge beyond either end, and likewise for the others; values
without an edge are arbitrary.
"""


@dataclass(frozen=True, eq=False)
class HexTables:
    """A hexahedral mesh as flat arrays over the positions (i, j, k) of all blocks, for compiled code."""

    blocks: NDArray[np.int64]  # (b, 6) node counts, and starts of positions, cells and rows
    node: NDArray[np.int32]  # (p,) index of the node at each position, -1 for none
    target: NDArray[np.float32]  # (3, p) log target lengths of the three edges that start at each position
    inverse: Floats  # (3, c) inverse target lengths of cells
    skip: NDArray[np.uint8]  # (c,) for each cell, bits that say which of its corners are ignored
    busy: Bools  # for each row of cells, whether it has a corner that is not ignored
    free: Indices  # (k,) free nodes
    start: Indices  # (k + 1,) first of the positions in `place` whose forces act on each free node
    place: NDArray[np.int32]


def tables_of(
    mesh: HexMesh, moves: Bools, targets: Targets, lengths: Sequence[Floats], turned: bool = True
) -> HexTables:
    """Return the arrays of a mesh for the compiled minimisation, which moves the nodes in the mask `moves`.

    `lengths`: target lengths of the cells, by block. `turned`: store the direction with the most nodes last.
    """
    parts = [
        _part(wider, np.append(moves, False), wanted, sizes, turned)
        for wider, wanted, sizes in zip(mesh.beyond, targets, lengths, strict=True)
    ]
    rows: list[list[int]] = []
    starts = np.zeros(3, dtype=np.int64)
    own: list[NDArray[Any]] = [np.empty(0, np.intp)]
    places: list[NDArray[Any]] = [np.empty(0, np.intp)]
    for part in parts:
        if part is None:
            continue
        node, skip, busy = part[0], part[3], part[4]
        rows.append([*node.shape, *starts.tolist()])
        inner = (slice(1, -1),) * 3
        own.append(node[inner].ravel())
        places.append(starts[0] + np.arange(node.size).reshape(node.shape)[inner].ravel())
        starts += node.size, skip.size, busy.size
    tables = [[each[k] for each in parts if each is not None] for k in range(5)]
    shapes = ((0,), (3, 0), (3, 0), (0,), (0,))
    kinds = np.int32, np.float32, np.float64, np.uint8, np.bool_
    joined: list[Any] = [
        np.concatenate([np.reshape(part, (*shape[:-1], -1)) for part in each], axis=-1)
        if each
        else np.empty(shape, kind)
        for each, shape, kind in zip(tables, shapes, kinds, strict=True)
    ]
    free, start, place = _forces(moves, np.concatenate(own), np.concatenate(places))
    node, target, inverse, skip, busy = joined
    blocks = np.array(rows, dtype=np.int64).reshape(-1, 6)
    return HexTables(blocks, node, target, inverse, skip, busy, free, start, place)


def cell_lengths(edges: Sequence[Floats]) -> Floats:
    """Return target lengths (3, ni-1, nj-1, nk-1) of cells: geometric means over edges (`BlockTargets`)."""
    means = []
    for d, values in enumerate(edges):
        inner = np.moveaxis(values, d, 0)[1:-1]
        mean = 0.25 * (inner[:, 1:, 1:] + inner[:, 1:, :-1] + inner[:, :-1, 1:] + inner[:, :-1, :-1])
        means.append(np.moveaxis(mean, 0, d))
    return exp(np.stack(means))


_Part: TypeAlias = tuple[NDArray[np.int32], Floats, Floats, NDArray[np.uint8], Bools]


def _part(
    lattice: Indices, free: Bools, wanted: BlockTargets, lengths: Floats, turned: bool
) -> _Part | None:  # fmt: skip
    """Return the tables of a block around its free nodes, None if it has none; `free` of node -1 is False."""
    last = int(np.argmax(lattice.shape)) if turned else 2
    axes = [(last + 1) % 3, (last + 2) % 3, last]
    lattice = lattice.transpose(axes)
    edges = [wanted[axis].transpose(axes) for axis in axes]
    lengths = lengths[axes].transpose(0, *(axis + 1 for axis in axes))
    moving = any_corner(free[lattice[1:-1, 1:-1, 1:-1]])
    where = [np.flatnonzero(moving.any(axis=tuple({0, 1, 2} - {axis}))) for axis in range(3)]
    if not len(where[0]):
        return None
    cells = tuple(slice(at[0], at[-1] + 1) for at in where)
    target = np.full((3, *lattice.shape), np.nan, np.float32)
    for d, values in enumerate(edges):
        into = tuple(slice(0, -1) if k == d else slice(1, -1) for k in range(3))
        ends = np.moveaxis(lattice[tuple(slice(None) if k == d else slice(1, -1) for k in range(3))], d, 0)
        none = (ends[1:] == ends[:-1]) | (ends[1:] < 0) | (ends[:-1] < 0)
        target[d][into] = np.where(np.moveaxis(none, 0, d), np.nan, values)
    inside = tuple(slice(at[0], at[-1] + 4) for at in where)
    node = lattice[inside]
    skip = np.where(moving[cells], _collapsed(node[1:-1, 1:-1, 1:-1]), 255).astype(np.uint8)
    some = (skip != 255).any(axis=2).ravel()
    busy = np.zeros((node.shape[0] - 2) * (node.shape[1] - 2), dtype=bool)
    busy[: len(some)] = some
    return (
        node.astype(np.int32),
        target[(slice(None), *inside)],
        1.0 / lengths[(slice(None), *cells)],
        skip,
        busy,
    )


def _collapsed(nodes: Indices) -> NDArray[np.uint8]:
    """Return the bits of corners of cells (ni-1, nj-1, nk-1) at which an edge has no length."""
    bits = np.zeros([n - 1 for n in nodes.shape], dtype=np.uint8)
    if not any((np.diff(nodes, axis=axis) == 0).any() for axis in range(3)):
        return bits
    corners = list(corners_of(nodes))
    for number, own in enumerate(corners):
        out = (own == corners[number ^ 1]) | (own == corners[number ^ 2]) | (own == corners[number ^ 4])
        bits |= np.where(out, np.uint8(1 << number), np.uint8(0))
    return bits


def _forces(moves: Bools, own: Indices, places: Indices) -> tuple[Indices, Indices, NDArray[np.int32]]:
    """Return the free nodes, the starts of their positions (k+1,), and the positions of forces on them."""
    on = moves[own]
    free = np.flatnonzero(moves)
    of = (np.cumsum(moves) - 1)[own[on]]
    start = np.concatenate([[0], np.cumsum(np.bincount(of, minlength=len(free)))])
    return free, start.astype(np.intp), places[on][np.argsort(of, kind="stable")].astype(np.int32)
