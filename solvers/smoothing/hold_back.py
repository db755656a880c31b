"""Reduces the displacements of a smoothed grid where they would worsen a face."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, shortest_ways
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.layout.from_grid import with_nodes
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.quality.checkmesh import cells_beyond
from meshonet.solvers.smoothing.judge import PlaneMeasures, measures

_ROUNDS, _GENTLE = 30, 8
"""Largest number of rounds, and the number after which nodes of bad cells are reset at once."""

_SHARES = (0.5, 0.7, 0.85)
"""Factors per round of the displacement of a bad cell's nodes, and of nodes one and two cells away."""

_SMALL = 0.02  # fraction of the displacement below which a node is reset


def held_back(grid: Grid, original: Layout, layout: Layout, before: PlaneMeasures) -> Grid | None:
    """Return `grid`, whose layout is `original`, moved towards `layout` where that does not make it worse.

    `before` are the measures of `grid`. Return None if hardly any node would move.
    """
    part = np.ones(len(original.mesh.nodes))
    for number in range(_ROUNDS):
        made = with_nodes(grid, part_of_the_way(original, layout, part))
        now = measures(made)
        if now.no_worse(before):
            return made
        bad = np.zeros(len(part), dtype=bool)
        for block, i, j in cells_beyond(made, before.angle, before.skew):
            bad[original.blocks[block][i : i + 2, j : j + 2]] = True
        if not bad.any():  # the mean deviation, or folded cells
            bad[:] = True
        quads = original.mesh.quads
        for share in _SHARES:
            part[bad] *= share if number < _GENTLE else 0.0
            bad[quads[bad[quads].any(axis=1)].ravel()] = True  # and the nodes around them
        part[part < _SMALL] = 0.0
        if not part.any():
            break
    return None


def part_of_the_way(original: Layout, layout: Layout, part: Floats) -> Layout:
    """Return the layout with nodes at the fraction `part` (n,) between two layouts; boundary nodes slide."""
    old, mesh = original.mesh, layout.mesh
    nodes = old.nodes + part[:, None] * (mesh.nodes - old.nodes)
    arc = old.places.arc.copy()
    moved = (mesh.nodes != old.nodes).any(axis=1) & (old.places.partner < 0)
    moved[old.places.partner[old.places.partner >= 0]] = False
    on = (old.places.loop >= 0) & moved
    length = old.domain.lengths[old.places.loop[on]]
    way = shortest_ways(mesh.places.arc[on] - arc[on], length)
    arc[on] = np.mod(arc[on] + part[on] * way, length)
    nodes[on] = old.domain.at(old.places.loop[on], arc[on])
    return replace(layout, mesh=mesh.with_nodes(old.beside_partners(nodes), arc))
