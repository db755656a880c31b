"""The blocks of C sheets under the nodes of their fronts; the two sides of a wake share its nodes."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.attach import beside, spaced
from meshonet.solvers.blocking.c_sheets import Sheet
from meshonet.solvers.blocking.cut_loop import CutLoop
from meshonet.solvers.blocking.layer_law import layer_arcs
from meshonet.solvers.blocking.layer_rows import JOIN, LayerSettings, arc_shares, heights_inside


def attach_sheets(
    layout: Layout, cut: CutLoop[Sheet], domain: Domain, numbers: dict[int, int], settings: LayerSettings,
    rows: list[int],
) -> Layout:  # fmt: skip
    """Return the layout with the blocks of C sheets, of so many `rows` each, in `domain`.

    `numbers` are those of the layout's loops in that domain.
    """
    mesh, old = layout.mesh, layout.mesh.places
    loop, arc, cells = old.loop.copy(), old.arc.copy(), old.cells.copy()
    for number, renamed in numbers.items():
        loop[old.loop == number] = renamed
    nodes = mesh.nodes.copy()
    heights = _heights(layout)
    on_fronts = np.zeros(len(nodes), dtype=bool)
    fronts = [cut.front_nodes(mesh, 0, k) for k in range(len(cut.layers))]
    for order, _ in fronts:
        on_fronts[order] = True
    rest = np.flatnonzero((old.loop == 0) & ~on_fronts)
    arc[rest] = cut.outer_arcs(old.arc[rest])
    nodes[rest] = cut.outer.at(arc[rest])
    parts = [Places(loop, arc, cells, old.partner.copy())]
    coordinates = [nodes]
    count = len(nodes)
    blocks, layers = list(layout.blocks), dict(layout.layers)
    for k, (order, index) in enumerate(fronts):
        sheet = cut.layers[k]
        loop[order], cells[order], arc[order] = -1, 0, 0.0
        loop[order[[0, -1]]], arc[order[[0, -1]]] = 0, np.mod(sheet.ends, cut.outer.length)
        lines, starts = _lines(sheet, index, nodes[order], heights[order], settings, rows[k])
        table, new, places = _numbered(sheet, cut, order, starts, lines, count)
        count += len(new)
        coordinates.append(new)
        parts.append(places)
        position = np.full(len(nodes), -1, dtype=np.intp)
        position[order] = np.arange(len(order))
        for block in beside(layout.blocks, position, 1 << 40):
            layers[len(blocks)] = rows[k]
            blocks.append(table[block][:, ::-1])
    joined = Places(*(np.concatenate([vars(p)[name] for p in parts]) for name in vars(parts[0])))
    whole = QuadMesh(domain, np.concatenate(coordinates), lattice_quads(blocks), joined)
    return Layout(whole, tuple(blocks), layers)


def _heights(layout: Layout) -> Floats:
    """Return the lengths (n,) of edges that leave the nodes of loop 0, at other nodes 0."""
    mesh = layout.mesh
    on = np.flatnonzero(mesh.places.loop == 0)
    order = on[np.argsort(mesh.places.arc[on], kind="stable")]
    heights = np.zeros(len(mesh.nodes))
    heights[order] = heights_inside(layout, 0)
    return heights


def _lines(
    sheet: Sheet, index: Floats, ends: Floats, inner: Floats, settings: LayerSettings, rows: int
) -> tuple[Floats, Floats]:
    """Return lines (k, rows + 1, 2) from wake and wall to the front, and where they start, (k,) columns."""
    start, last = index.copy(), len(sheet.levels) - 1.0
    inner[[0, -1]] = inner[[1, -2]]  # at the outer loop, what leaves it was measured
    edge = int(np.flatnonzero(index == sheet.edge)[0])
    mean = 0.5 * (index[: edge + 1] + last - index[::-1][: edge + 1])
    start[: edge + 1], start[::-1][: edge + 1] = mean, last - mean
    columns, opening = sheet.columns(index, start)
    opening[: edge + 1] = opening[::-1][: edge + 1] = np.sqrt(opening[: edge + 1] * opening[::-1][: edge + 1])
    columns += arc_shares(columns)[..., None] * (ends - columns[:, -1])[:, None]

    def law(length: Floats) -> Floats:
        arcs = layer_arcs(
            length / opening, settings.first, inner / opening / JOIN, rows, settings.constant, settings.growth
        )
        return np.asarray(opening[:, None] * arcs)

    lines = spaced(columns, law)
    step = lines[:, 1] - lines[:, 0]
    lines[:, 1] = lines[:, 0] + step * (settings.first * opening / np.hypot(*step.T))[:, None]
    return lines, start


def _numbered(
    sheet: Sheet, cut: CutLoop[Sheet], order: Indices, starts: Floats, lines: Floats, count: int
) -> tuple[Indices, Floats, Places]:
    """Return numbers (k, rows + 1) from the front to wake and wall, and new nodes with their places."""
    k, rows = len(order), lines.shape[1] - 1
    edge = int(np.flatnonzero(starts == sheet.edge)[0])
    own = k - 1 - edge  # the first columns have nodes of their own on wake and wall
    inner = (rows - 1) * k
    table = np.empty((k, rows + 1), dtype=np.intp)
    table[:, 0] = order
    table[:, 1:-1] = count + np.arange(inner).reshape(k, rows - 1)
    table[:own, -1] = count + inner + np.arange(own)
    table[own:, -1] = table[: edge + 1, -1][::-1]
    wall = lines[:own, 0].copy()
    places = Places.inside(inner + own)
    for column, way in ((0, -1.0), (k - 1, 1.0)):
        away = np.hypot(*(lines[column, 1:-1] - lines[column, 0]).T)
        at = np.mod(sheet.out + way * away, cut.outer.length)
        lines[column, 1:-1] = cut.outer.at(at)
        new = table[column, 1:-1][::-1] - count
        places.loop[new], places.arc[new] = 0, at
    wall[0] = cut.outer.at(np.array([sheet.out]))[0]
    places.loop[inner], places.arc[inner] = 0, sheet.out
    body = np.arange(edge, own)
    arcs = sheet.wall_arcs(starts[body])
    places.loop[inner + body], places.arc[inner + body] = sheet.number, arcs
    places.arc[inner + edge] = sheet.wall.corner_arcs[0]
    wall[body] = sheet.wall.at(places.arc[inner + body])
    places.cells[inner + edge] = 4
    nodes = np.concatenate([lines[:, 1:-1][:, ::-1].reshape(-1, 2), wall])
    return table, nodes, places
