"""The grid of a volume marched from a surface: a block a patch, its sides named or connected."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import Block, face_of
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.surface.surface import Surface

_SIDES: tuple[Side, ...] = ("west", "east", "south", "north")
SYMMETRY, FREE = "symmetry", "free"


class _Edge(NamedTuple):
    """An edge at the side of a patch: it goes from node `k` of the side to the next."""

    block: int
    side: Side
    k: int


class _Pair(NamedTuple):
    """The same edge at two sides, and whether both go along it the same way."""

    own: _Edge
    across: _Edge
    alike: bool


class _Outer(NamedTuple):
    """A named stretch of a side, from a node to another."""

    name: str
    block: int
    side: Side
    start: int
    stop: int


def blocks_of(surface: Surface, lines: Floats) -> tuple[Block, ...]:
    """Return a block for each patch of a surface, of `lines` (3, n, levels)."""
    return tuple(Block(np.moveaxis(lines[:, lattice], 0, -1)) for lattice in surface.lattices)


def volume_grid(surface: Surface, blocks: tuple[Block, ...], in_plane: Indices) -> Grid:
    """Return the grid of `blocks` on a surface; `in_plane` says which (k,) open edges lie in planes."""
    top = blocks[0].counts[2] - 1
    runs, outer = _runs(surface, in_plane)
    connections = tuple(_connection(run, top) for run in runs)
    patches = []
    for number, (lattice, name) in enumerate(zip(surface.lattices, surface.names, strict=True)):
        ni, nj = lattice.shape
        patches += [
            Patch(name, "bottom", 0, ni - 1, (0, nj - 1), number, "wall"),
            Patch("farfield", "top", 0, ni - 1, (0, nj - 1), number),
        ]
        patches += [
            Patch(each.name, each.side, each.start, each.stop, (0, top), number)
            for each in outer
            if each.block == number
        ]
    return Grid(blocks, tuple(patches), connections)


def _runs(surface: Surface, in_plane: Indices) -> tuple[list[list[_Pair]], list[_Outer]]:
    """Return the stretches of pairs of edges that are the same, and named stretches of open ones."""
    table = _edges_of(surface)
    ends = np.sort(surface.open_edges, axis=1).tolist()
    plane = {(a, b): bool(flag) for (a, b), flag in zip(ends, in_plane, strict=True)}
    runs: list[list[_Pair]] = []
    outer: list[_Outer] = []
    for key, places in table.items():
        if len(places) == 1:
            _add_outer(outer, SYMMETRY if plane.get(key, False) else FREE, places[0][0])
        else:
            (own, way), (across, other) = places
            pair = _Pair(own, across, way == other)
            if runs and _goes_on(runs[-1][-1], pair):
                runs[-1].append(pair)
            else:
                runs.append([pair])
    return runs, outer


def _edges_of(surface: Surface) -> dict[tuple[int, int], list[tuple[_Edge, bool]]]:
    """Return the edges at sides of patches by their nodes, the lesser first, and whether they ascend."""
    table: dict[tuple[int, int], list[tuple[_Edge, bool]]] = {}
    for number, lattice in enumerate(surface.lattices):
        for side in _SIDES:
            line = face_of(lattice, side).tolist()
            for k, (a, b) in enumerate(pairwise(line)):
                table.setdefault((min(a, b), max(a, b)), []).append((_Edge(number, side, k), a < b))
    return table


def _add_outer(outer: list[_Outer], what: str, edge: _Edge) -> None:
    last = outer[-1] if outer else None
    if last and (last.name, last.block, last.side, last.stop) == (what, *edge):
        outer[-1] = last._replace(stop=edge.k + 1)
    else:
        outer.append(_Outer(what, edge.block, edge.side, edge.k, edge.k + 1))


def _goes_on(last: _Pair, pair: _Pair) -> bool:
    """Whether a pair of edges continues a run in its direction."""
    sides = (last.own[:2], last.across[:2], last.alike) == (pair.own[:2], pair.across[:2], pair.alike)
    step = 1 if pair.alike else -1
    return sides and pair.own.k == last.own.k + 1 and pair.across.k == last.across.k + step


def _connection(run: list[_Pair], top: int) -> Connection:
    """Return the connection of blocks along a run of edges of their patches; `top` is the last level."""
    first, last = run[0], run[-1]
    low, high = sorted((first.across.k, last.across.k))
    return Connection(
        first.own.block, first.own.side, ((first.own.k, last.own.k + 1), (0, top)),
        first.across.block, first.across.side, ((low, high + 1), (0, top)),
        (1 if first.alike else -1, 2),
    )  # fmt: skip
