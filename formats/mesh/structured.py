"""Grids from the structured blocks, named faces and interfaces of a file, planar or in space.

Interfaces that the file does not state are found by position; motions are computed from nodes.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import Any

import numpy as np

from meshonet.formats.mesh.loops import with_loop_names
from meshonet.formats.mesh.metadata import Facts
from meshonet.formats.mesh.metadata_read import grid_of_blocks, grid_with, nodes_by_facts, number_of_grid
from meshonet.formats.mesh.motions import like_others, matched
from meshonet.formats.mesh.recover_topology import recovered, usable
from meshonet.formats.mesh.slices import IndexedNodes, lattices
from meshonet.formats.mesh.windows import Face, Pair, connection_of, patch_of
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection, check_connections
from meshonet.geometry.blocks.find_connections import find_connections, order
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch, kind_of
from meshonet.geometry.blocks.shared_nodes import joined_labels, with_equal_nodes
from meshonet.geometry.blocks.transform import turned_patch
from meshonet.geometry.errors import in_place


@dataclass(frozen=True)
class FileBlock:
    """A block of a file: its name and coordinates x, y[, z], each of shape (n1, n2, n3).

    `place` names it in messages. `iblank` has the number of nodes by iblank value; `facts`: see `facts_of`.
    """

    coordinates: Sequence[Floats]
    name: str = ""
    place: str = ""
    iblank: Mapping[str, int] = field(default_factory=dict)
    facts: Facts = field(default_factory=dict)


def described_grids(blocks: Iterable[FileBlock], name: str) -> Iterator[Grid]:
    """Yield the grids of blocks whose metadata state the topology; blocks of a grid must be consecutive."""
    for number, group in groupby(blocks, key=lambda block: number_of_grid(block.facts)):
        read = ((block, in_place(block.place)(_described)(block)) for block in group)
        if number is not None:
            yield grid_of_blocks([(nodes, block.facts) for block, nodes in read], name)
            continue
        for block, nodes in read:
            with in_place(block.place):
                yield grid_with(nodes, block.facts, block.name)


def _described(block: FileBlock) -> Floats:
    return usable(nodes_by_facts(block.coordinates, block.facts))


def grid_of_block(coordinates: Sequence[Floats], facts: Facts, name: str) -> Grid:
    """Return the grid of a file with one block, using its metadata `facts` if there are any.

    Raises InputError as `grids_of_file`, and if the metadata do not match the nodes.
    """
    if facts.get("topology"):
        return grid_with(nodes_by_facts(coordinates, facts), facts, name)
    (lattice,) = lattices([coordinates])
    if lattice.nodes.shape[-1] == 2:
        return grid_with(lattice.nodes, facts, name)
    (grid,) = _grids([lattice], [FileBlock(coordinates)], (), (), name)
    return grid


def grids_of_file(
    blocks: Sequence[FileBlock], faces: Sequence[Face], pairs: Sequence[Pair], name: str
) -> Iterator[Grid]:
    """Yield the grids of a file, given its blocks, its named faces and its pairs of connected faces.

    Blocks that touch form one grid, and so do all surface patches. A single grid is called `name`. Of several
    grids, those of one named block are called like this block, the others `name` and a number. Unnamed outer
    edges of planar blocks get names. Raises InputError: no cells, unusable nodes, unmatched interfaces.
    """
    if blocks:
        read = lattices([block.coordinates for block in blocks], [block.place for block in blocks])
        yield from _grids(read, blocks, faces, pairs, name)


def _grids(
    read: Sequence[IndexedNodes],
    blocks: Sequence[FileBlock],
    faces: Sequence[Face],
    pairs: Sequence[Pair],
    name: str,
) -> Iterator[Grid]:
    for lattice, block in zip(read, blocks, strict=True):
        with in_place(block.place):
            usable(lattice.nodes)
    made = [Block(lattice.nodes, finite=True) for lattice in read]
    patches = [patch for face in faces if (patch := patch_of(face, read))]
    stated, named = _stated(pairs, read, made)
    planar = read[0].nodes.shape[-1] == 2
    if planar:
        patches += named
    known = [end for each in stated for end in each.ends]
    known += [
        (p.block, p.side, p.range(made[p.block].face(p.side).shape[:-1]))
        for p in patches
        if p.kind != "interface"
    ]
    without = [(*end[:2], *end[2][0]) if planar else end for end in known]
    connections = sorted((*stated, *find_connections(made, without=without)), key=order)
    groups = _groups(made, connections)
    for count, group in enumerate(groups, start=1):
        own_name = blocks[group[0]].name if len(group) == 1 else ""
        grid = _joined(group, made, blocks, connections, patches)
        grid = replace(grid, name=name if len(groups) == 1 else own_name or f"{name}-{count}")
        if planar:
            grid = _alone(grid) if len(group) == 1 else with_loop_names(grid)
        yield grid


def _stated(
    pairs: Sequence[Pair], read: Sequence[IndexedNodes], blocks: Sequence[Block]
) -> tuple[list[Connection], list[Patch]]:
    """Return the connections that a file states, once, and patches of named periodic sides."""
    stated: dict[object, Connection] = {}
    names: dict[object, str] = {}
    motions: list[Motion] = []
    for pair in pairs:
        each = connection_of(pair, read)
        if each is None:
            continue
        if kind_of(pair.name) == "periodic":
            names[each.ends[0]] = pair.name
        first = each if order(each) <= order(each.reversed()) else each.reversed()
        if first.ends not in stated:
            check_connections([first], [block.counts for block in blocks])
            connection = matched(first, blocks)
            stated[first.ends] = (
                connection if connection.transform is None else like_others(connection, motions)
            )
    patches = [
        Patch(names[end], end[1], end[2][0][0], end[2][0][1], block=end[0])
        for each in stated.values()
        for end in each.ends
        if each.transform is not None and end in names
    ]
    return list(stated.values()), patches


def _groups(blocks: Sequence[Block], connections: Sequence[Connection]) -> list[list[int]]:
    """Return the indices of the blocks of each grid: connected ones, and all surface patches."""
    surface = [k for k, block in enumerate(blocks) if block.nodes.shape[2:] == (3,)]
    joined = [(each.block, each.donor) for each in connections] + [(surface[0], k) for k in surface]
    label = joined_labels(len(blocks), [(np.array(a), np.array(b)) for a, b in joined])
    return [np.flatnonzero(label == number).tolist() for number in range(int(label.max()) + 1)]


def _joined(
    group: Sequence[int],
    blocks: Sequence[Block],
    of_file: Sequence[FileBlock],
    connections: Sequence[Connection],
    patches: Sequence[Patch],
) -> Grid:
    """Return the grid of a `group` of blocks, with their names and iblank counts as provenance."""
    number = {block: k for k, block in enumerate(group)}
    own = tuple(
        replace(each, block=number[each.block], donor=number[each.donor])
        for each in connections
        if each.block in number
    )
    ordered = sorted((p for p in patches if p.block in number), key=lambda p: p.block)
    titles, marks = [of_file[k].name for k in group], Counter[str]()
    for k in group:
        marks.update(of_file[k].iblank)
    facts: dict[str, Any] = {"zones": titles} if all(titles) and len(titles) > 1 else {}
    facts |= {"iblank": dict(marks)} if marks else {}
    named = tuple(replace(p, block=number[p.block]) for p in ordered)
    return Grid(with_equal_nodes([blocks[k] for k in group], own), named, own, provenance=facts)


def _alone(grid: Grid) -> Grid:
    """Return the grid of a block without neighbours, with recovered topology."""
    if any(each.transform for each in grid.connections):
        return with_loop_names(grid)
    nodes, patches = grid.blocks[0].nodes, grid.patches
    alone = replace(recovered(nodes, grid.name), provenance=grid.provenance)
    if grid.connections and not alone.connections:
        return with_loop_names(grid)
    for _ in range(4):
        if nodes.shape == alone.nodes.shape and np.array_equal(nodes, alone.nodes):
            return replace(alone, patches=patches or alone.patches)
        patches = tuple(turned_patch(patch, len(nodes) - 1) for patch in patches)
        nodes = np.swapaxes(nodes, 0, 1)[:, ::-1]
    return alone
