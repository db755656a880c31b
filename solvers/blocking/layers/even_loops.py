"""Nodes along the loops of a layout whose cells grow evenly, in arc length and in that of walls beneath."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.layers.attach import loop_nodes
from meshonet.solvers.blocking.layers.even_line import Measures, evened_places


def evened_loops(layout: Layout, measures: Mapping[int, Measures], limit: float) -> Layout:
    """Return the layout with nodes moved along some loops, and less and less in the blocks beside them.

    Neighbouring steps of the measures of each loop differ by no more than the exponential of `limit`; corners
    stay.
    """
    mesh = layout.mesh
    nodes, arcs = mesh.nodes.copy(), mesh.places.arc.copy()
    for number, measure in measures.items():
        order = loop_nodes(mesh, number)
        fixed = mesh.places.cells[order] > 0
        if not fixed.any():
            fixed[0] = True  # else all may go round
        new = np.mod(evened_places(arcs[order], fixed, measure, limit, closed=True), measure.arcs[-1])
        arcs[order] = new
        nodes = followed(layout, nodes, number, order, mesh.domain.loops[number].at(new))
    fixed = mesh.places.cells > 0
    nodes[fixed] = mesh.nodes[fixed]
    return replace(layout, mesh=mesh.with_nodes(nodes, arcs))


def followed(layout: Layout, nodes: Floats, loop: int, moved: Indices, places: Floats) -> Floats:
    """Return `nodes` (n, 2) with some of a loop, `moved` (k,), put in `places` (k, 2), and others after them.

    Those in the blocks beside the loop follow less and less.
    """
    shift = np.zeros_like(nodes)
    shift[moved] = places - layout.mesh.nodes[moved]
    nodes = nodes + _spread(layout, loop, shift)
    nodes[moved] = places
    return nodes


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
