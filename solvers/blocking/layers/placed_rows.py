"""Layers in rows of a layout at walls: the number of layers, and their nodes along lines from walls."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import compress

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, norms, percentiles_of
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import exp, log, power
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.algebraic.tfi import between
from meshonet.solvers.blocking.layers.wall_rows import WallRows
from meshonet.solvers.layers.layer_settings import LayerSettings, exact, spaced

GROWING_COLUMNS = 75  # percentage of the columns of a row that the layers must fill without growing too fast
SHORT_COLUMNS = 20  # percentage that may be too short for layers; cells there become lower away from the wall
OPENS = 0.15  # distance behind a sharp edge, over the loop's length, within which first cells of a wake grow
_STEPS = 50  # of bisection, to round-off


def layers_of(layout: Layout, rows: WallRows, row: int, settings: LayerSettings) -> int:
    """Return how many layers a row of blocks needs so that cells grow within the limit along most lines."""
    alone = rows.across[np.nonzero(rows.across == row)[0]].min(axis=1) < 0  # blocks of no other row
    columns = np.concatenate(list(compress(rows.columns(layout, row), alone)))
    first, extra = settings.first, settings.constant - 1
    room = norms(np.diff(layout.mesh.nodes[columns], axis=1)).sum(axis=1) / first
    on = layout.mesh.places.loop[columns[:, 0]] == rows.loops[row]  # not of the wake, which has as many
    rise = math.log(settings.growth)
    wanted = extra + log(1.0 + math.expm1(rise) * np.maximum(room[on] - extra, 1.0)) / rise
    count = int(np.ceil(percentiles_of(wanted, (GROWING_COLUMNS,))[0]))
    count = min(count, int(percentiles_of(room, (SHORT_COLUMNS,))[0]))
    return -(-max(count, 2 + extra) // settings.multiple) * settings.multiple


def with_layers(layout: Layout, rows: WallRows, settings: Sequence[LayerSettings]) -> Layout:
    """Return the layout with layers in `rows`, the rows of blocks at walls, each with its own `settings`.

    Nodes move along the lines that cross a row. First cells have exactly the given height; cells grow to the
    size of the cells beyond the layers.
    """
    mesh = layout.mesh
    moved = np.zeros(len(mesh.nodes), dtype=bool)
    for row in range(len(rows.loops)):
        tables = rows.columns(layout, row)
        beyond = _beyond(replace(layout, mesh=mesh), tables)
        nodes = mesh.nodes.copy()
        for table in tables:
            opened = _opened(mesh, table[:, 0], rows.loops[row])
            lines = _lines(mesh.nodes[table], beyond[table[:, -1]], opened, settings[row])
            nodes[table[:, 1:-1]] = lines[:, 1:-1]
            moved[table[:, 1:-1]] = True
        mesh = mesh.with_nodes(nodes)
    mesh = mesh.on_loops(moved & mesh.wall_nodes)
    nodes, arcs = mesh.nodes.copy(), mesh.places.arc.copy()
    for corner, across in _corners(layout, rows):
        loop = mesh.domain.loops[mesh.places.loop[corner[0, 0]]]
        south, west = (settings[row] for row in across)
        for wall, beside, own in ((corner[:, 0], corner[:, -1], west), (corner[0], corner[-1], south)):
            arcs[wall] = _wall_arcs(loop, arcs[wall], nodes[beside], own)
            nodes[wall] = loop.at(arcs[wall])
        nodes[corner] = _between(nodes[corner], south.first, west.first)
    return replace(layout, mesh=mesh.with_nodes(nodes, arcs))


def held_nodes(layout: Layout, rows: WallRows, settings: LayerSettings, sharp: int) -> tuple[Bools, Indices]:
    """Return a mask (n,) of the fixed nodes in rows of layers, and pairs (k, 2) of nodes that move together.

    A pair is a wall node and a node on the grid line from there, at the top of a cell of first-cell height.
    Both are fixed instead at corners, at periodic sides, and in the rows around sharp edges. These rows
    come first; their number is `sharp`.
    """
    mesh, cells = layout.mesh, settings.constant + 1
    held, pairs = np.zeros(len(mesh.nodes), dtype=bool), []
    for row in range(len(rows.loops)):
        for table in rows.columns(layout, row):
            on = mesh.places.loop[table[:, 0]] == rows.loops[row]
            stays = on & ((mesh.places.cells[table[:, 0]] > 0) | mesh.tied[table[:, 0]] | (row < sharp))
            held[table[stays, :cells]] = True
            wall = table[on & ~stays, :cells]
            pairs += [np.stack([wall[:, 0], wall[:, k]], axis=1) for k in range(1, cells)]
    for corner, _ in _corners(layout, rows):
        held[corner[:cells, :cells]] = True
    every = np.unique(np.concatenate([np.empty((0, 2), dtype=np.intp), *pairs]), axis=0)
    stay = held[every].any(axis=1)
    held[every[stay]] = True
    return held, every[~stay]


def _corners(layout: Layout, rows: WallRows) -> list[tuple[Indices, list[int]]]:
    """Return, for blocks where two rows cross: their nodes from the corner on; the south and the west row."""
    corners = []
    for block, across in zip(layout.blocks, rows.across.tolist(), strict=True):
        if min(across) >= 0:
            on = [layout.mesh.places.cells[block[i, j]] > 0 for i, j in ((0, 0), (-1, 0), (-1, -1), (0, -1))]
            walls = [
                layout.mesh.wall_nodes[line].all()
                for line in (block[:, 0], block[-1], block[:, -1], block[0])
            ]
            k = next(k for k in range(4) if on[k] and walls[k] and walls[k - 1])
            corners.append(((block, block[::-1], block[::-1, ::-1], block[:, ::-1])[k], across))
    return corners


def _beyond(layout: Layout, tables: list[Indices]) -> Floats:
    """Return the height (n,) of the cells beyond the front of a row, infinite elsewhere."""
    mesh = layout.mesh
    inside, front = (np.zeros(len(mesh.nodes), dtype=bool) for _ in range(2))
    for table in tables:
        inside[table] = True
        front[table[:, -1]] = True
    length, beyond = mesh.edge_lengths, np.zeros(len(mesh.nodes))
    for here, there in ((0, 1), (1, 0)):
        leaving = front[mesh.edges[:, here]] & ~inside[mesh.edges[:, there]]
        np.maximum.at(beyond, mesh.edges[leaving, here], length[leaving])
    return np.where(beyond > 0.0, beyond, np.inf)


def _opened(mesh: QuadMesh, base: Indices, loop: int) -> Floats:
    """Return 0 for columns (k,) on the wall, up to 1 along wakes; at 1, first cells are not prescribed."""
    on = mesh.places.loop[base] == loop
    if on.all():
        return np.zeros(len(base))
    edge = mesh.domain.loops[loop].at(mesh.domain.loops[loop].corner_arcs[:1])[0]
    share = np.hypot(*(mesh.nodes[base] - edge).T) / (OPENS * mesh.domain.loops[loop].length)
    return np.where(on, 0.0, np.clip(share, 1e-9, 1.0))


def _lines(columns: Floats, beyond: Floats, opened: Floats, settings: LayerSettings) -> Floats:
    """Return the nodes (k, n, 2) of layers along columns (k, n, 2).

    `beyond` (k,) are the cell sizes beyond the layers. Where `opened` (k,) is 1, cells grow by one ratio.
    """
    rows, first = columns.shape[1] - 1, settings.first

    def law(length: Floats) -> Floats:
        short = length < 1.02 * rows * first
        arcs = settings.arcs(
            np.where(short, 1.05 * rows * first, length), first, beyond / settings.join, rows
        )
        if short.any():
            arcs[short] = _by_one_ratio(length[short], np.full(int(short.sum()), first), rows)
        wide = opened > 0.0
        if wide.any():
            last = np.minimum(beyond[wide] / settings.join, (1.0 - 1.0 / settings.growth) * length[wide])
            even = np.diff(_by_one_ratio(length[wide], last, rows), axis=1)[:, ::-1]
            steps = log(np.diff(arcs[wide], axis=1))
            steps = exp(steps + opened[wide, None] * (log(even) - steps))
            places = np.cumsum(steps, axis=1)
            arcs[wide, 1:] = length[wide, None] * places / places[:, -1:]
        return arcs

    lines = spaced(columns, law)
    on = opened == 0.0
    walls = lines[on]
    exact(walls, first)
    lines[on] = walls
    return lines


def _by_one_ratio(length: Floats, first: Floats, rows: int) -> Floats:
    """Return distances (k, rows + 1), to `length` (k,), of cells that grow from `first` (k,) by one ratio."""
    low, high = np.zeros(len(length)), np.full(len(length), 2.0)
    powers = np.arange(float(rows))
    for _ in range(_STEPS):
        ratio = 0.5 * (low + high)
        less = first * power(ratio[:, None], powers).sum(axis=1) < length
        low, high = np.where(less, ratio, low), np.where(less, high, ratio)
    arcs = np.cumsum(power(high[:, None], powers), axis=1)
    return np.pad(length[:, None] * arcs / arcs[:, -1:], ((0, 0), (1, 0)))


def _wall_arcs(loop: Loop, arcs: Floats, beside: Floats, settings: LayerSettings) -> Floats:
    """Return arc lengths (n,) of wall nodes from a corner on, in layers like those `beside` (n, 2)."""
    way = arcs[-1] - arcs[0]
    way -= loop.length * np.round(way / loop.length)
    column = np.hypot(*np.diff(beside, axis=0).T)
    length = np.array([abs(way)])
    last = length * column[-1] / column.sum()
    away = settings.arcs(length, settings.first, last, len(arcs) - 1)[0]
    return np.concatenate([np.mod(arcs[0] + np.copysign(away[:-1], way), loop.length), arcs[-1:]])


def _between(nodes: Floats, south: float, west: float) -> Floats:
    """Return nodes (n, m, 2) between the sides of a block, with first cells of heights `south` and `west`."""
    sides = nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1]
    block = between(sides)
    block[:, 0], block[:, -1], block[0], block[-1] = sides
    for wall, first in ((block[1:-1], south), (block.transpose(1, 0, 2)[1:-1], west)):
        exact(wall, first)
    block[1, 1] = block[1, 0] + block[0, 1] - block[0, 0]
    return np.asarray(block)
