"""Blocks of a file of others as grids: those that touch are one grid, others one each.

A file may say where blocks are joined and what is a boundary. Where it says neither, interfaces are found
by position. So is the motion of a periodic interface: conventions of files differ in its sign.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from meshonet.formats.mesh.loop_names import with_loop_names
from meshonet.formats.mesh.motions import like_others, matched
from meshonet.formats.mesh.recover_topology import is_left_handed, recovered, usable
from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection, Motion
from meshonet.geometry.blocks.equal_nodes import with_equal_nodes
from meshonet.geometry.blocks.find_connections import AROUND, find_connections, order
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch, kind_of
from meshonet.geometry.blocks.transform import turned_patch

Stretch: TypeAlias = tuple[int, Side, int, int]
"""Block, side, first and last node, the first the smaller."""


class Joint(NamedTuple):
    """Two stretches that a file joins node by node, and what it calls that."""

    own: Stretch
    donor: Stretch
    name: str = ""


_FLIPPED: dict[Side, Side] = {"west": "east", "east": "west"}
_WAYS = dict(AROUND)


@dataclass(frozen=True)
class Piece:
    """A block of a file: nodes as they stand there, what it is called, its named patches.

    `iblank` says how many nodes have which mark, where there are marks.
    """

    nodes: Floats
    name: str = ""
    patches: tuple[Patch, ...] = ()
    iblank: Mapping[str, int] = field(default_factory=dict)

    def right_handed(self) -> Piece:
        """Return it with i reversed where its area is negative."""
        if not is_left_handed(self.nodes):
            return self
        last = len(self.nodes) - 1
        patches = tuple(
            replace(patch, side=_FLIPPED[patch.side])
            if patch.side in _FLIPPED
            else replace(patch, start=last - patch.stop, stop=last - patch.start)
            for patch in self.patches
        )
        return replace(self, nodes=self.nodes[::-1], patches=patches)


def grids_of(pieces: Sequence[Piece], joints: Sequence[Joint], name: str) -> Iterator[Grid]:
    """Yield the grids that the pieces of a file called `name` make, in the order of their first blocks.

    Several grids are called by their piece where that has a name, else by `name` and a number. Outer edges of
    a grid of several blocks that have no name get one (`meshonet.formats.mesh.loop_names`).

    Raises InputError: nodes that are not usable, joints that join nothing.
    """
    if not pieces:
        return
    for piece in pieces:
        usable(piece.nodes)
    turned = [piece.right_handed() for piece in pieces]
    flipped = [new is not piece for new, piece in zip(turned, pieces, strict=True)]
    joints = [
        Joint(_flipped(own, pieces, flipped), _flipped(donor, pieces, flipped), title)
        for own, donor, title in joints
    ]
    blocks = [Block(piece.nodes) for piece in turned]
    said = _joined(blocks, joints)
    turned = _with_periodic_names(turned, said, joints)
    known = [end for joint in joints for end in joint[:2]]
    known += [
        (k, patch.side, patch.start, patch.stop)
        for k, piece in enumerate(turned)
        for patch in piece.patches
        if patch.kind != "interface"
    ]
    connections = sorted((*said, *find_connections(blocks, without=known)), key=order)
    groups = groups_of(len(blocks), connections)
    for count, group in enumerate(groups, start=1):
        title = name if len(groups) == 1 else (len(group) == 1 and turned[group[0]].name) or f"{name}-{count}"
        own = [each for each in connections if each.block in group]
        several = joined_grid([turned[k] for k in group], [blocks[k] for k in group], own, group, title)
        yield _alone(several, turned[group[0]]) if len(group) == 1 else with_loop_names(several)


def _flipped(end: Stretch, pieces: Sequence[Piece], flipped: Sequence[bool]) -> Stretch:
    block, side, first, last = end
    if not flipped[block]:
        return end
    if side in _FLIPPED:
        return block, _FLIPPED[side], first, last
    count = len(pieces[block].nodes) - 1
    return block, side, count - last, count - first


def _joined(blocks: Sequence[Block], joints: Sequence[Joint]) -> list[Connection]:
    """Return the connections that `joints`, of which most stand in a file twice, say there are.

    Periodic ones of one motion, or its inverse, get the very same one, so that they agree where they meet.
    """
    connections: dict[tuple[Stretch, Stretch], Connection] = {}
    motions: list[Motion] = []
    for joint in joints:
        first, second = sorted(joint[:2], key=lambda end: (end[0], list(_ORDER).index(end[1]), end[2]))
        if (first, second) in connections:
            continue
        connection = _connection(blocks, first, second)
        if connection.transform is not None:
            connection = like_others(connection, motions)
        connections[first, second] = connection
    return list(connections.values())


def _with_periodic_names(
    pieces: Sequence[Piece], connections: Sequence[Connection], joints: Sequence[Joint]
) -> list[Piece]:
    """Return `pieces` with patches on periodic sides whose joints are called so."""
    named = {joint.own: joint.name for joint in joints if kind_of(joint.name) == "periodic"}
    patches: dict[int, list[Patch]] = {}
    for each in connections:
        if each.transform is not None:
            for way in (each, each.reversed()):
                first, last = way.range[0]
                name = named.get((way.block, way.side, first, last), "")
                if name:
                    patches.setdefault(way.block, []).append(Patch(name, way.side, first, last))
    return [replace(piece, patches=(*piece.patches, *patches.get(k, ()))) for k, piece in enumerate(pieces)]


_ORDER: tuple[Side, ...] = ("west", "east", "south", "north")


def _connection(blocks: Sequence[Block], first: Stretch, second: Stretch) -> Connection:
    way = -_WAYS[first[1]] * _WAYS[second[1]]  # right-handed blocks run along an interface in opposite ways
    connection = Connection(first[0], first[1], ((first[2:]),), second[0], second[1], ((second[2:]),), (way,))
    return matched(connection, blocks)


def groups_of(count: int, connections: Sequence[Connection]) -> list[list[int]]:
    """Return the numbers of blocks that are connected, directly or through others."""
    label = list(range(count))
    for connection in connections:
        a, b = label[connection.block], label[connection.donor]
        label = [min(a, b) if each in (a, b) else each for each in label]
    return [[k for k in range(count) if label[k] == first] for first in sorted(set(label))]


def _alone(grid: Grid, piece: Piece) -> Grid:
    """Return the grid of a block that touches no other, its topology recovered, its patches along."""
    if any(each.transform for each in grid.connections):
        return with_loop_names(grid)
    alone = replace(recovered(grid.blocks[0].nodes, grid.name), provenance=grid.provenance)
    if grid.connections and not alone.connections:
        return with_loop_names(grid)
    nodes, patches = grid.blocks[0].nodes, piece.patches
    for _ in range(4):
        if nodes.shape == alone.nodes.shape and np.array_equal(nodes, alone.nodes):
            return replace(alone, patches=patches or alone.patches)
        patches = tuple(turned_patch(patch, len(nodes) - 1) for patch in patches)
        nodes = np.swapaxes(nodes, 0, 1)[:, ::-1]
    return alone


def joined_grid(
    pieces: Sequence[Piece],
    blocks: Sequence[Block],
    connections: Sequence[Connection],
    group: Sequence[int],
    name: str,
) -> Grid:
    """Return the grid of the pieces that are `group` of a file's `blocks`, with their connections, named."""
    number = {block: k for k, block in enumerate(group)}
    own = tuple(replace(each, block=number[each.block], donor=number[each.donor]) for each in connections)
    patches = tuple(replace(patch, block=k) for k, piece in enumerate(pieces) for patch in piece.patches)
    facts = facts_of_pieces([(piece.name, piece.iblank) for piece in pieces])
    return Grid(with_equal_nodes(blocks, own), patches, own, name, facts)


def facts_of_pieces(pieces: Sequence[tuple[str, Mapping[str, int]]]) -> dict[str, Any]:
    """Return the provenance of a grid made of the blocks of a file: their names, and the counts of iblank."""
    titles = [title for title, _ in pieces]
    facts: dict[str, Any] = {"zones": titles} if all(titles) and len(titles) > 1 else {}
    marks: Counter[str] = Counter()
    for _, iblank in pieces:
        marks.update(iblank)
    if marks:
        facts["iblank"] = dict(marks)
    return facts
