"""From a fine layout, whose blocks share nodes, to a grid, whose blocks are connected.

Shared edges become connections with bitwise equal nodes, periodic pairs of edges connections with a motion,
and the other edges become patches with the names of the domain's loops.
"""

from collections.abc import Collection
from dataclasses import replace
from itertools import groupby
from operator import itemgetter
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Indices, Side, shortest_ways
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch, kind_of, may_be_wall
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.periodic_sides import matched_nodes, sides_of

Line: TypeAlias = tuple[int, Side, Indices]
"""Number of a block, one of its sides, and the node numbers along this side."""


def shared(lines: list[Line]) -> tuple[list[Connection], list[Line]]:
    """Return the connections of lines with the same nodes, and the lines that no other line matches."""
    waiting: dict[tuple[int, ...], Line] = {}
    connections = []
    for line in lines:
        key = key_of(line[2])
        if key in waiting:
            connections.append(connection_of(waiting.pop(key), line))
        else:
            waiting[key] = line
    return connections, list(waiting.values())


def key_of(nodes: Indices) -> tuple[int, ...]:
    """Return a key of a line's nodes that does not depend on their direction."""
    line = tuple(nodes.tolist())
    return min(line, line[::-1])


def connection_of(
    own: Line, donor: Line, transform: Motion | None = None, at: tuple[int, int] = (0, 0)
) -> Connection:
    """Return the connection of two sides with the same nodes, in either direction.

    For parts of sides, `at` is the index of the first node of each part in its side.
    """
    (block, side, nodes), (other, other_side, others) = own, donor
    begin, end = (((first, first + len(nodes) - 1),) for first in at)
    same = int(nodes[0]) == int(others[0]) and int(nodes[1]) == int(others[1])
    return Connection(block, side, begin, other, other_side, end, (1 if same else -1,), transform)


def shared_in_part(lines: list[Line]) -> tuple[list[Connection], list[tuple[Line, int]]]:
    """Return the connections of parts of lines, and the remaining parts with the index of their first node.

    A side next to several other blocks, or to itself, shares a part of its nodes with each.
    """
    places: dict[tuple[int, ...], list[tuple[int, int]]] = {}
    for number, (_, _, nodes) in enumerate(lines):
        for cell in range(len(nodes) - 1):
            places.setdefault(key_of(nodes[cell : cell + 2]), []).append((number, cell))
    connections, alone = [], []
    for number, (block, side, nodes) in enumerate(lines):
        met = []
        for k in range(len(nodes) - 1):
            edge = nodes[k : k + 2]
            other, cell = next((at for at in places[key_of(edge)] if at != (number, k)), (-1, 0))
            alike = bool((lines[other][2][cell : cell + 2] == edge).all())
            step = 0 if other < 0 else cell - k if alike else cell + k
            met.append((cell, (other, (number, k) < (other, cell), step)))
        start = 0
        for (other, ahead, _), run in groupby(met, key=itemgetter(1)):
            beside = [cell for cell, _ in run]
            own: Line = (block, side, nodes[start : start + len(beside) + 1])
            if other < 0:
                alone.append((own, start))
            elif ahead:
                first, (donor, donor_side, others) = min(beside), lines[other]
                part = (donor, donor_side, others[first : first + len(beside) + 1])
                connections.append(connection_of(own, part, at=(start, first)))
            start += len(beside)
    return connections, alone


_SIDES: tuple[Side, ...] = ("south", "north", "west", "east")


def to_grid(layout: Layout, name: str = "", walls: Collection[str] = ()) -> Grid:
    """Return the grid of a layout's blocks.

    Holes, and the sides named in `walls`, are of the kind "wall" unless their names suggest another one.
    Raises InputError (from `Grid`): a layout whose neighbouring blocks do not share nodes.
    """
    domain = layout.mesh.domain
    lines = [
        (number, side, line)
        for number, block in enumerate(layout.blocks)
        for side, line in zip(_SIDES, (block[:, 0], block[:, -1], block[0], block[-1]), strict=True)
    ]
    patches: list[Patch] = []
    connections, open_lines = shared(lines)
    partner = layout.mesh.places.partner
    nodes = layout.mesh.beside_partners(layout.mesh.nodes)
    periodic, alone = _periodic(layout, open_lines)
    if any((partner[line[2][1:-1]] >= 0).any() for line in alone):  # blocks on both sides end elsewhere
        nodes, periodic = matched_nodes(layout.mesh), []
        across, sides, alone = _across(layout, open_lines)
        connections, patches = connections + across, patches + sides
    partly, single = shared_in_part(alone)
    connections += partly
    patches += [patch for line, start in single for patch in _patches(layout, line, start, walls)]
    patches += [
        Patch(f"periodic{2 - first}", side, 0, len(line) - 1, block=block, kind="periodic")
        for joined in periodic
        for first, (block, side, line) in ((1, joined[0]), (0, joined[1]))
    ]
    if periodic:
        shift = domain.periodic[0].shift if domain.periodic else (0.0, 0.0)
        connections += [
            connection_of(own, (*donor[:2], partner[donor[2]]), Motion(shift)) for own, donor in periodic
        ]
    blocks = tuple(Block(nodes[block]) for block in layout.blocks)
    return Grid(blocks, tuple(patches), tuple(connections), name or domain.name)


def _across(layout: Layout, lines: list[Line]) -> tuple[list[Connection], list[Patch], list[Line]]:
    """Return the connections and patches of periodic sides, part by part, and the lines of other sides."""
    connections, patches, rest = [], [], lines
    for each, first, second in sides_of(layout.mesh):
        own, opposite = (_along(rest, chain) for chain in (first, second))
        of = np.full(len(layout.mesh.nodes), -1, dtype=np.intp)
        of[second] = first
        moved = [(block, side, of[nodes]) for block, side, nodes in opposite]
        joined, _ = shared_in_part([*own, *moved])
        connections += [replace(one, transform=Motion(each.shift)) for one in joined]
        patches += [
            Patch(name, side, 0, len(nodes) - 1, block=block, kind="periodic")
            for name, along in zip(each.names, (own, opposite), strict=True)
            for block, side, nodes in along
        ]
        taken = {id(line) for line in (*own, *opposite)}
        rest = [line for line in rest if id(line) not in taken]
    return connections, patches, rest


def _along(lines: list[Line], chain: Indices) -> list[Line]:
    """Return the lines of which all nodes are in a chain of them."""
    return [line for line in lines if np.isin(line[2], chain).all()]


def _periodic(layout: Layout, lines: list[Line]) -> tuple[list[tuple[Line, Line]], list[Line]]:
    """Return pairs of lines that are periodic, and the lines that are not."""
    partner = layout.mesh.places.partner
    if not (partner >= 0).any():
        return [], lines
    own = {key_of(line[2]): line for line in lines}
    pairs = []
    for line in lines:
        first = own.get(key_of(partner[line[2]])) if (partner[line[2]] >= 0).all() else None
        if first is not None:
            pairs.append((first, line))
    taken = {id(line) for pair in pairs for line in pair}
    return pairs, [line for line in lines if id(line) not in taken]


def _patches(layout: Layout, line: Line, start: int, walls: Collection[str]) -> list[Patch]:
    """Return the patches of a wall from node `start` of a side on, split where its name changes."""
    block, side, nodes = line
    places, domain = layout.mesh.places, layout.mesh.domain
    number, arcs = int(places.loop[nodes[0]]), places.arc[nodes]
    loop = domain.loops[number]
    step = shortest_ways(np.diff(arcs), loop.length)
    names = [loop.name_at(float(arc)) for arc in arcs[:-1] + 0.5 * step]
    patches = []
    for name, cells in groupby(names):
        stop = start + len(list(cells))
        is_wall = name in walls or (number in domain.layered_loops and may_be_wall(name))
        kind = kind_of(name, "wall" if is_wall else "other")
        patches.append(Patch(name, side, start, stop, block=block, kind=kind))
        start = stop
    return patches
