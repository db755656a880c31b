"""Attaches blocks to a loop of a layout: layers at a wall, or rows out to a distant far field."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh


@dataclass(frozen=True, eq=False)
class Rows:
    """Grid lines that lead from nodes on a boundary loop of a layout outwards, to a loop beyond it.

    Parameters
    ----------
    loop : index of the loop at which the lines begin. After `attach`, the loop beyond it has this index.
    nodes : (k, m, 2) x and y of m nodes on each of k lines, in the order in which they begin along the loop.
    arcs : (k,) arc lengths of the last nodes of the lines, on the loop at which they end.
    layers : whether the new cells are layers at a wall, which no later optimisation moves.
    """

    loop: int
    nodes: Floats
    arcs: Floats
    layers: bool


def attach(layout: Layout, domain: Domain, rows: Sequence[Rows]) -> Layout:
    """Return the layout, extended by a new block at each block side on the boundary loops in `rows`.

    For each such loop, `rows` has the grid lines in the new blocks. `domain` is the domain of the result.
    """
    mesh = layout.mesh
    nodes, places = [mesh.nodes], [replace(mesh.places, loop=mesh.places.loop.copy())]
    blocks, layers = list(layout.blocks), dict(layout.layers)
    count = len(mesh.nodes)
    for each in rows:
        order = mesh.places.along(each.loop)
        places[0].loop[order] = -1
        away = each.nodes.shape[1] - 1
        table = np.empty((len(order), away + 1), dtype=np.intp)
        table[:, 0] = order
        table[:, 1:] = count + np.arange(len(order) * away).reshape(len(order), away)
        count += len(order) * away
        nodes.append(each.nodes[:, 1:].reshape(-1, 2))
        places.append(_places(each, domain))
        position = np.full(len(mesh.nodes), -1, dtype=np.intp)
        position[order] = np.arange(len(order))
        for block in beside(layout.blocks, position, len(order)):
            if each.layers:
                layers[len(blocks)] = away
            blocks.append(table[block][:, ::-1] if each.layers else table[block[::-1]])
    joined = places[0].and_then(*places[1:])
    joined.arc[joined.loop < 0] = 0.0
    joined.cells[joined.loop < 0] = 0
    whole = QuadMesh(domain, np.concatenate(nodes), lattice_quads(blocks), joined)
    return Layout(whole, tuple(blocks), layers)


def _places(rows: Rows, domain: Domain) -> Places:
    """Return the places of the new nodes: the last of each line is on the loop."""
    k, away = len(rows.nodes), rows.nodes.shape[1] - 1
    places = Places.inside(k * away)
    last = np.arange(k) * away + away - 1
    loop = domain.loops[rows.loop]
    places.loop[last], places.arc[last] = rows.loop, rows.arcs
    for arc, cells in zip(loop.corner_arcs, loop.corner_cells, strict=True):
        places.cells[last[rows.arcs == arc]] = cells
    return places


def beside(blocks: Sequence[Indices], position: Indices, count: int) -> list[Indices]:
    """Return, for each block side on a loop of `count` nodes, the positions (n,) of its nodes along the loop.

    `position` gives, for each node of the mesh, its position along the loop; it is negative for nodes off the
    loop. Along a side the positions ascend by one.
    """
    along = []
    for block in blocks:
        for side in (block[:, 0], block[-1], block[::-1, -1], block[0, ::-1]):
            at = position[side]  # counter-clockwise around the block: the domain is on the left, as of a loop
            if (at >= 0).all() and ((at[1:] - at[:-1]) % count == 1).all():
                along.append(at)
    return along
