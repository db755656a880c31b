"""From a fine layout, whose blocks share nodes, to a grid, whose blocks are connected.

Shared edges become connections, periodic pairs of edges connections with a motion, other edges patches.
"""

from collections.abc import Collection
from dataclasses import replace
from itertools import groupby

import numpy as np

from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch, kind_of, may_be_wall
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.periodic_sides import matched_nodes, sides_of
from meshonet.geometry.layout.shared_sides import Line, connection_of, key_of, shared, shared_in_part

_SIDES: tuple[Side, ...] = ("south", "north", "west", "east")


def to_grid(layout: Layout, name: str = "", walls: Collection[str] = ()) -> Grid:
    """Return the grid of a layout's blocks.

    Holes, and the sides named in `walls`, are of the kind "wall" unless their names suggest another kind.
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
        own, opposite = (
            [line for line in rest if np.isin(line[2], chain).all()] for chain in (first, second)
        )
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
    steps = loop.steps(arcs, 1.0 if side in ("south", "east") else -1.0)  # with the block on the left
    names = [loop.name_at(float(arc)) for arc in arcs[:-1] + 0.5 * steps]
    patches = []
    for name, cells in groupby(names):
        stop = start + len(list(cells))
        is_wall = name in walls or (number in domain.layered_loops and may_be_wall(name))
        kind = kind_of(name, "wall" if is_wall else "other")
        patches.append(Patch(name, side, start, stop, block=block, kind=kind))
        start = stop
    return patches
