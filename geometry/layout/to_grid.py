"""From a fine layout, whose blocks share nodes, to a grid, whose blocks are connected.

Shared edges become connections of bitwise equal nodes, periodic pairs of edges connections with a motion,
and what is left patches, named by the loops of the domain.
"""

from __future__ import annotations

from itertools import groupby
from operator import itemgetter

import numpy as np

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection, Motion
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch, kind_of
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.polygon.corners import Indices

_SIDES: tuple[Side, ...] = ("south", "north", "west", "east")

Line = tuple[int, Side, Indices]
"""Number of a block, a side of it, and the nodes along that."""


def to_grid(layout: Layout, name: str = "") -> Grid:
    """Return the grid of a layout's blocks.

    Raises InputError: from `Grid`, for a layout whose blocks do not share what they should.
    """
    domain = layout.mesh.domain
    nodes = _with_partners(layout)
    lines = [
        (number, side, line)
        for number, block in enumerate(layout.blocks)
        for side, line in zip(_SIDES, (block[:, 0], block[:, -1], block[0], block[-1]), strict=True)
    ]
    connections, open_lines = _shared(lines)
    periodic, alone = _periodic(layout, open_lines)
    partly, walls = _shared_in_part(alone)
    connections += partly
    patches = [patch for line, start in walls for patch in _patches(layout, line, start)]
    patches += [
        Patch(f"periodic{2 - first}", side, 0, len(line) - 1, block=block, kind="periodic")
        for joined in periodic
        for first, (block, side, line) in ((1, joined[0]), (0, joined[1]))
    ]
    if periodic:
        shift = domain.periodic.shift if domain.periodic else (0.0, 0.0)
        partner = layout.mesh.places.partner
        connections += [
            _connection(own, (*donor[:2], partner[donor[2]]), Motion(shift)) for own, donor in periodic
        ]
    blocks = tuple(Block(nodes[block]) for block in layout.blocks)
    return Grid(blocks, tuple(patches), tuple(connections), name or domain.name)


def _with_partners(layout: Layout) -> Floats:
    """Return the nodes, those with a partner exactly where the period takes it."""
    nodes, partner, domain = layout.mesh.nodes, layout.mesh.places.partner, layout.mesh.domain
    moved = partner >= 0
    if not moved.any() or domain.periodic is None:
        return nodes
    nodes = nodes.copy()
    nodes[moved] = Motion(domain.periodic.shift)(nodes[partner[moved]])
    return nodes


def _shared(lines: list[Line]) -> tuple[list[Connection], list[Line]]:
    """Return the connections of lines with the same nodes, and the lines that are alone."""
    waiting: dict[tuple[int, ...], Line] = {}
    connections = []
    for line in lines:
        key = _key(line[2])
        if key in waiting:
            connections.append(_connection(waiting.pop(key), line))
        else:
            waiting[key] = line
    return connections, list(waiting.values())


def _key(nodes: Indices) -> tuple[int, ...]:
    line = tuple(nodes.tolist())
    return min(line, line[::-1])


def _connection(
    own: Line, donor: Line, transform: Motion | None = None, at: tuple[int, int] = (0, 0)
) -> Connection:
    """Return the connection of two sides with the same nodes, whichever way they run.

    Of parts of sides, `at` says with which nodes they begin.
    """
    (block, side, nodes), (other, other_side, others) = own, donor
    begin, end = (((first, first + len(nodes) - 1),) for first in at)
    same = int(nodes[0]) == int(others[0]) and int(nodes[1]) == int(others[1])
    return Connection(block, side, begin, other, other_side, end, (1 if same else -1,), transform)


def _shared_in_part(lines: list[Line]) -> tuple[list[Connection], list[tuple[Line, int]]]:
    """Return the connections of parts of lines, and the parts that are alone with their first nodes.

    Blocks of which one side meets those of several others share the nodes of a part of it with each.
    """
    places: dict[tuple[int, ...], list[tuple[int, int]]] = {}
    for number, (_, _, nodes) in enumerate(lines):
        for cell in range(len(nodes) - 1):
            places.setdefault(_key(nodes[cell : cell + 2]), []).append((number, cell))
    connections, alone = [], []
    for number, (block, side, nodes) in enumerate(lines):
        cells = [places[_key(nodes[cell : cell + 2])] for cell in range(len(nodes) - 1)]
        met = [next((at for at in each if at[0] != number), (-1, 0)) for each in cells]
        start = 0
        for other, run in groupby(met, key=itemgetter(0)):
            beside = [cell for _, cell in run]
            own: Line = (block, side, nodes[start : start + len(beside) + 1])
            if other < 0:
                alone.append((own, start))
            elif number < other:
                first, (donor, donor_side, others) = min(beside), lines[other]
                part = (donor, donor_side, others[first : first + len(beside) + 1])
                connections.append(_connection(own, part, at=(start, first)))
            start += len(beside)
    return connections, alone


def _periodic(layout: Layout, lines: list[Line]) -> tuple[list[tuple[Line, Line]], list[Line]]:
    """Return pairs of lines of which the second is the first moved, and the lines that are in none."""
    partner = layout.mesh.places.partner
    if not (partner >= 0).any():
        return [], lines
    own = {_key(line[2]): line for line in lines}
    pairs = []
    for line in lines:
        first = own.get(_key(partner[line[2]])) if (partner[line[2]] >= 0).all() else None
        if first is not None:
            pairs.append((first, line))
    taken = {id(line) for pair in pairs for line in pair}
    return pairs, [line for line in lines if id(line) not in taken]


def _patches(layout: Layout, line: Line, start: int) -> list[Patch]:
    """Return the patches of a wall from node `start` of a side on, cut where its name changes."""
    block, side, nodes = line
    places, domain = layout.mesh.places, layout.mesh.domain
    number, arcs = int(places.loop[nodes[0]]), places.arc[nodes]
    loop = domain.loops[number]
    step = np.mod(np.diff(arcs) + 0.5 * loop.length, loop.length) - 0.5 * loop.length
    names = [loop.name_at(float(arc)) for arc in arcs[:-1] + 0.5 * step]
    patches = []
    for name, cells in groupby(names):
        stop = start + len(list(cells))
        kind = kind_of(name)
        kind = "wall" if kind == "other" and number > 0 else kind
        patches.append(Patch(name, side, start, stop, block=block, kind=kind))
        start = stop
    return patches
