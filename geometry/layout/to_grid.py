"""From a fine layout, whose blocks share nodes, to a grid, whose blocks are connected.

Shared edges become connections with bitwise equal nodes, periodic pairs of edges connections with a motion,
and the other edges become patches with the names of the domain's loops.
"""

from __future__ import annotations

from itertools import groupby

import numpy as np

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Motion
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch, kind_of
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.shared_sides import Line, connection_of, key_of, shared, shared_in_part

_SIDES: tuple[Side, ...] = ("south", "north", "west", "east")


def to_grid(layout: Layout, name: str = "") -> Grid:
    """Return the grid of a layout's blocks.

    Raises InputError (from `Grid`): a layout whose neighbouring blocks do not share nodes.
    """
    domain = layout.mesh.domain
    nodes = _with_partners(layout)
    lines = [
        (number, side, line)
        for number, block in enumerate(layout.blocks)
        for side, line in zip(_SIDES, (block[:, 0], block[:, -1], block[0], block[-1]), strict=True)
    ]
    connections, open_lines = shared(lines)
    periodic, alone = _periodic(layout, open_lines)
    partly, walls = shared_in_part(alone)
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
            connection_of(own, (*donor[:2], partner[donor[2]]), Motion(shift)) for own, donor in periodic
        ]
    blocks = tuple(Block(nodes[block]) for block in layout.blocks)
    return Grid(blocks, tuple(patches), tuple(connections), name or domain.name)


def _with_partners(layout: Layout) -> Floats:
    """Return the nodes, with periodic partners moved to be an exact shift of each other."""
    nodes, partner, domain = layout.mesh.nodes, layout.mesh.places.partner, layout.mesh.domain
    moved = partner >= 0
    if not moved.any() or domain.periodic is None:
        return nodes
    nodes = nodes.copy()
    nodes[moved] = Motion(domain.periodic.shift)(nodes[partner[moved]])
    return nodes


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


def _patches(layout: Layout, line: Line, start: int) -> list[Patch]:
    """Return the patches of a wall from node `start` of a side on, split where its name changes."""
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
