"""Nodes along the loops of a layout whose cells grow evenly, in arc length or in any index along the loop."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.attach import loop_nodes
from meshonet.solvers.blocking.even_growth import evened

Measure = tuple[Floats, Floats]
"""Arc lengths (m,) along a loop, from 0 to its length, and what rises with them from 0."""
HELD = False
"""Whether steps go on across corners; nodes far from short edges would have to move for it."""
TURNS = 4
"""Arc length and the other measure are evened in turn so often."""


def evened_loops(layout: Layout, measures: Mapping[int, Measure], limit: float) -> Layout:
    """Return the layout with nodes moved along some loops, and less and less in the blocks beside them.

    Neighbouring steps of the measure of each loop differ by no more than the exponential of `limit`; corners
    stay.
    """
    mesh = layout.mesh
    nodes, arcs = mesh.nodes.copy(), mesh.places.arc.copy()
    for number, measure in measures.items():
        order = loop_nodes(mesh, number)
        new = _evened_arcs(mesh, order, measure, limit)
        shift = np.zeros_like(nodes)
        shift[order] = mesh.domain.loops[number].at(new) - mesh.nodes[order]
        arcs[order] = new
        nodes += _spread(layout, number, shift)
        nodes[order] = mesh.domain.loops[number].at(new)
    fixed = mesh.places.cells > 0
    nodes[fixed] = mesh.nodes[fixed]
    return replace(layout, mesh=mesh.with_nodes(nodes, arcs))


def _evened_arcs(mesh: QuadMesh, order: Indices, measure: Measure, limit: float) -> Floats:
    """Return new arc lengths (k,) of the nodes `order` (k,) of a loop."""
    old = mesh.places.arc[order]
    corners = np.flatnonzero(mesh.places.cells[order] > 0)
    kept = corners if len(corners) else np.zeros(1, dtype=np.intp)
    begin, arcs = int(kept[0]), old
    for turn in range(TURNS):
        table = measure if turn % 2 == 0 else (measure[0], measure[0])
        index, whole = np.interp(arcs, *table), float(table[1][-1])
        ahead = np.mod(np.diff(index, append=index[0]), whole)  # the first ones may have passed the start
        steps = _evened_steps(ahead, corners, limit)
        around = np.concatenate([[0.0], np.cumsum(np.roll(steps, -begin)[:-1])])
        at = np.mod(index[begin] + np.roll(around, begin), whole)
        arcs = np.interp(at, table[1], table[0])
        arcs[kept] = old[kept]
    return np.asarray(arcs)


def _evened_steps(steps: Floats, corners: Indices, limit: float) -> Floats:
    """Return steps (k,) around a loop with the same sums between corners, those of short ones first."""
    if not len(corners):
        return np.asarray(evened(steps[None], limit, closed=True)[0])
    k, new = len(steps), steps.copy()
    ends = np.append(corners[1:], corners[0] + k)
    pieces = [np.arange(start, stop) % k for start, stop in zip(corners, ends, strict=True)]
    done = np.zeros(k, dtype=bool)
    for piece in sorted(pieces, key=lambda each: float(steps[each].mean())):
        before, after = (piece[0] - 1) % k, (piece[-1] + 1) % k
        held = HELD and done[before] and len(pieces) > 1, HELD and done[after] and len(pieces) > 1
        line = np.concatenate([new[[before]] if held[0] else [], new[piece], new[[after]] if held[1] else []])
        line = evened(line[None], limit, False, int(held[0]), int(held[1]))[0]
        new[piece] = line[int(held[0]) : len(line) - int(held[1])]
        done[piece] = True
    return new


def _spread(layout: Layout, loop: int, shift: Floats) -> Floats:
    """Return what nodes (n, 2) move by, when those on a loop do by `shift` (n, 2)."""
    moved = np.zeros_like(shift)
    on = layout.mesh.places.loop == loop
    for block in layout.blocks:
        for lines in (block, block[:, ::-1], block.T, block.T[:, ::-1]):
            if on[lines[:, 0]].all():
                left = np.linspace(1.0, 0.0, lines.shape[1]) ** 2
                moved[lines] = left[None, :, None] * shift[lines[:, 0]][:, None]
    return moved
