"""Cells that grow evenly from a wall through its layers and the ring of blocks around them.

A front that has two blocks at each of its nodes has a ring of blocks around it, with as many cells across it
everywhere, whatever the room. At others, layers are placed anew up to the front.
Nodes are placed anew along the lines from the wall to the outer side of that
ring: the first cell stays what it is, the last one becomes about as large as the one beyond.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.attach import spaced
from meshonet.solvers.blocking.layer_law import layer_arcs
from meshonet.solvers.blocking.layer_rows import LayerSettings

SMOOTHINGS = 200
"""How often the cells that lines are to end with are averaged along the front."""


def respaced(layout: Layout, settings: LayerSettings, joints: Collection[int] = ()) -> Layout:
    """Return the layout with nodes moved along the lines that leave the walls of its layers.

    The layers of each wall must go round it, or end on walls, or at `joints`: nodes where fronts meet.
    """
    strips = _strips(layout, joints)
    if not strips:
        return layout
    nodes = layout.mesh.nodes.copy()
    beyond = _beyond(layout, strips)
    for strip in strips:
        lines = layout.mesh.nodes[strip]
        last, cells = beyond[strip[:, -1]], strip.shape[1] - 1
        opening = np.hypot(*(lines[:, 1] - lines[:, 0]).T) / settings.first  # 1 at walls, more along wakes
        opening = np.where(opening > 1.0 + 1e-6, opening, 1.0)

        def law(length: Floats, last: Floats = last, cells: int = cells, scale: Floats = opening) -> Floats:
            arcs = layer_arcs(
                length / scale, settings.first, last / scale, cells, settings.constant, settings.growth
            )
            return np.asarray(scale[:, None] * arcs)

        moved = spaced(lines, law)
        step = moved[:, 1] - moved[:, 0]
        moved[:, 1] = moved[:, 0] + step * (opening * settings.first / np.hypot(*step.T))[:, None]
        nodes[strip[:, 1:-1]] = moved[:, 1:-1]
    return replace(layout, mesh=layout.mesh.with_nodes(nodes))


def _strips(layout: Layout, joints: Collection[int]) -> list[Indices]:
    """Return the nodes (n, m) of the lines from wall to outer side, for each block of layers."""
    ends = {}
    for number, block in enumerate(layout.blocks):
        if number not in layout.layers:
            for turned in (block, block[::-1, ::-1], block.T[:, ::-1], block.T[::-1]):
                ends[int(turned[0, 0]), int(turned[1, 0]), int(turned[-1, 0])] = turned
    outers: dict[int, Indices] = {}
    for number in layout.layers:
        front = layout.blocks[number][:, -1]
        outer = ends.get((int(front[0]), int(front[1]), int(front[-1])))
        if outer is not None and np.array_equal(outer[:, 0], front):
            outers[number] = outer
    alone = _without_ring(layout, joints, outers)
    strips = []
    for number in layout.layers:
        block = layout.blocks[number]
        beyond = outers[number][:, 1:] if number in outers and number not in alone else block[:, :0]
        strips.append(np.concatenate([block, beyond], axis=1))
    return strips


def _without_ring(layout: Layout, joints: Collection[int], outers: Mapping[int, Indices]) -> set[int]:
    """Return the numbers of blocks of layers on whose front, or farther along it, lie irregular nodes.

    And of those beyond which, in `outers` by number, other layers follow.
    """
    mesh = layout.mesh
    ends = {number: set(layout.blocks[number][[0, -1], -1].tolist()) for number in layout.layers}
    irregular = set(np.flatnonzero(mesh.irregular & ~mesh.wall_nodes).tolist()) | set(joints)
    fronts = np.zeros(len(mesh.nodes), dtype=bool)
    for number in layout.layers:
        fronts[layout.blocks[number][:, -1]] = True
    alone = {number for number, nodes in ends.items() if nodes & irregular}
    alone |= {number for number, outer in outers.items() if fronts[outer[1:-1, -1]].any()}
    reached = set().union(*(ends[number] for number in alone))
    while more := {number for number, nodes in ends.items() if nodes & reached} - alone:
        alone |= more
        reached |= set().union(*(ends[number] for number in more))
    return alone


def _beyond(layout: Layout, strips: list[Indices]) -> Floats:
    """Return the mean length (n,) of the edges that leave the outer side of the strips for the outside."""
    mesh = layout.mesh
    inside = np.zeros(len(mesh.nodes), dtype=bool)
    outer = np.zeros(len(mesh.nodes), dtype=bool)
    for strip in strips:
        inside[strip] = True
        outer[strip[:, -1]] = True
    total, count = np.zeros(len(mesh.nodes)), np.zeros(len(mesh.nodes))
    length = np.hypot(*(mesh.nodes[mesh.edges[:, 1]] - mesh.nodes[mesh.edges[:, 0]]).T)
    for here, there in ((0, 1), (1, 0)):
        a, b = mesh.edges[:, here], mesh.edges[:, there]
        leaving = outer[a] & ~inside[b]
        np.add.at(total, a[leaving], log(length[leaving]))
        np.add.at(count, a[leaving], 1.0)
    mean, known = total / np.maximum(count, 1.0), count > 0
    sides = np.concatenate([np.stack([strip[:-1, -1], strip[1:, -1]], axis=1) for strip in strips])
    while True:  # between two strips nothing leaves: they end as those beside them do
        reached = known[sides].sum(axis=1) == 1
        if not reached.any():
            break
        pair = sides[reached]
        source = pair[known[pair]]
        new = pair.sum(axis=1) - source
        mean[new], known[new] = mean[source], True
    values = _smoothed(mean, sides[known[sides].all(axis=1)])
    return np.where(known, exp(values), np.inf)  # a constant ratio where nothing leaves at all


def _smoothed(values: Floats, pairs: Indices) -> Floats:
    """Return values (n,) averaged with those of their neighbours, `pairs` (m, 2), again and again.

    What leaves a side changes at once where a block ends, and lines beside each other are to be alike.
    """
    first, second = pairs.T
    beside = np.bincount(pairs.ravel(), minlength=len(values))
    for _ in range(SMOOTHINGS):
        step = values[second] - values[first]
        rise = np.bincount(first, step, len(values)) - np.bincount(second, step, len(values))
        values = values + 0.5 * rise / np.maximum(beside, 1)
    return values
