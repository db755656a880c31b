"""Blocks in space of a file of others as grids: volumes that touch are one, all patches of surface one.

A file may say where blocks are joined and what is a boundary. What it does not say is found by position.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from meshonet.formats.mesh.gather import Piece, groups_of, joined_grid
from meshonet.formats.mesh.motions import like_others, matched
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection, Motion, check_connections
from meshonet.geometry.blocks.find_connections import find_connections, order
from meshonet.geometry.blocks.grid import Grid


def grids_in_space(pieces: Sequence[Piece], joined: Sequence[Connection], name: str) -> Iterator[Grid]:
    """Yield the grids that the pieces of a file called `name` make, in the order of their first blocks.

    Nodes of pieces are (ni, nj, nk, 3), right-handed, or (ni, nj, 3), and not checked here.
    `joined` are the connections that the file states, without transforms. Several grids are called by their
    piece where that has a name, else by `name` and a number.

    Raises InputError: stated connections that connect nothing.
    """
    blocks = [Block(piece.nodes, finite=True) for piece in pieces]
    check_connections(joined, [block.counts for block in blocks])
    stated = _stated(joined, blocks)
    known = [(each.block, each.side, each.range) for each in stated]
    known += [(each.donor, each.donor_side, each.donor_range) for each in stated]
    known += [
        (k, patch.side, patch.range(blocks[k].face(patch.side).shape[:-1]))
        for k, piece in enumerate(pieces)
        for patch in piece.patches
        if patch.kind != "interface"
    ]
    connections = sorted((*stated, *find_connections(blocks, without=known)), key=order)
    groups = _groups(blocks, connections)
    for count, group in enumerate(groups, start=1):
        own_name = pieces[group[0]].name if len(group) == 1 else ""
        title = name if len(groups) == 1 else own_name or f"{name}-{count}"
        own = [each for each in connections if each.block in group]
        yield joined_grid([pieces[k] for k in group], [blocks[k] for k in group], own, group, title)


def _stated(joined: Sequence[Connection], blocks: Sequence[Block]) -> list[Connection]:
    """Return each of the connections that a file states once, most of which stand there twice."""
    stated: dict[object, Connection] = {}
    motions: list[Motion] = []
    for each in joined:
        first = each if order(each) <= order(each.reversed()) else each.reversed()
        ends = (first.block, first.side, first.range), (first.donor, first.donor_side, first.donor_range)
        if ends in stated:
            continue
        connection = matched(first, blocks)
        stated[ends] = connection if connection.transform is None else like_others(connection, motions)
    return list(stated.values())


def _groups(blocks: Sequence[Block], connections: Sequence[Connection]) -> list[list[int]]:
    """Return the numbers of the blocks of each grid; all patches of surface are one."""
    surface = [k for k, block in enumerate(blocks) if len(block.counts) == 2]
    volumes = [group for group in groups_of(len(blocks), connections) if group[0] not in surface]
    return sorted([*volumes, *([surface] if surface else [])])
