"""Grids of blocks whose cells grow evenly along their lines, across interfaces as inside of blocks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.attach import sampled
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.even_growth import Bools, evened
from meshonet.solvers.blocking.grid_lines import Row, rows_of
from meshonet.solvers.blocking.on_loops import on_loops

ROUNDS = 1
FILTERS = 3
"""How often what lines beside each other want is averaged."""
MOST = 1.5
"""Cells by which nodes may move at once."""
LEAST_SINE = 0.5
"""Of angles, that no move may make smaller."""
_ATTEMPTS = 6
_SPREAD = 0.15


def evened_rows(layout: Layout, limit: float, held: int = 1, rounds: int = ROUNDS) -> Layout:
    """Return the layout with nodes moved along grid lines, where cells differ by more than a ratio.

    `limit` is the logarithm of the ratio; nodes of walls with layers, of lines along layers and of the first
    `held` cells from such walls stay, those of others slide along them.
    """
    mesh = layout.mesh
    walls = np.zeros(len(mesh.nodes), dtype=bool)
    for number in layout.layers:
        walls[layout.blocks[number][:, 0]] = True
    rows = [
        _Held(row, *(held if walls[row.nodes[:, k]].all() else 0 for k in (0, -1)))
        for row in rows_of(Chords.of(layout))
        if not _along_layers(layout, row)
    ]
    nodes = mesh.nodes
    sliding = mesh.wall_nodes & ~walls & (mesh.places.cells == 0) & (mesh.places.partner < 0)
    for _ in range(rounds):
        change = np.zeros_like(nodes)
        for row in rows:
            _add_moves(change, nodes, row, limit, mesh.wall_nodes)
        change[mesh.wall_nodes & ~sliding] = 0.0
        if not change.any():
            break
        mesh = on_loops(mesh.with_nodes(guarded(nodes, change, mesh, LEAST_SINE)), sliding)
        nodes = mesh.nodes
    return replace(layout, mesh=mesh)


@dataclass(frozen=True, eq=False)
class _Held:
    row: Row
    start: int
    stop: int


def _along_layers(layout: Layout, row: Row) -> bool:
    """Return whether the lines of a row run along layers anywhere."""
    sides = row.nodes[0], row.nodes[-1]
    for number in row.blocks:
        if number in layout.layers:
            wall = layout.blocks[number][:2, 0]
            if any(np.isin(wall, side).all() for side in sides):
                return True
    return False


def _add_moves(change: Floats, nodes: Floats, each: _Held, limit: float, on_wall: Bools) -> None:
    """Add to `change` (n, 2) where the nodes of a row of blocks want to go."""
    row, lines = each.row, each.row.nodes
    step = np.diff(nodes[lines], axis=1)
    cells = np.hypot(step[..., 0], step[..., 1])
    logs = np.log(cells)
    worst = np.abs(np.diff(logs, axis=1)).max(axis=1, initial=0.0)
    if row.closed:
        worst = np.maximum(worst, np.abs(logs[:, 0] - logs[:, -1]))
    uneven = worst > limit
    if not uneven.any():
        return
    arc = np.concatenate([np.zeros((len(lines), 1)), np.cumsum(cells, axis=1)], axis=1)
    new = np.cumsum(evened(cells[uneven], limit, row.closed, each.start, each.stop), axis=1)
    unit = np.minimum(np.pad(cells, ((0, 0), (1, 0)), "edge"), np.pad(cells, ((0, 0), (0, 1)), "edge"))
    part = np.zeros_like(arc)
    part[uneven, 1:-1] = ((new - arc[uneven, 1:]) / unit[uneven, 1:])[:, :-1]
    part[np.abs(part) < 1e-9] = 0.0
    part = np.clip(part, -MOST, MOST)
    for _ in range(FILTERS):
        part[1:-1] = 0.25 * part[:-2] + 0.5 * part[1:-1] + 0.25 * part[2:]
    some = (part != 0.0).any(axis=1)
    if not some.any():
        return
    share = np.ones((len(lines), 1, 1))
    for side in (0, -1):  # sides belong to two rows, but for walls
        share[side] = 1.0 if on_wall[lines[side]].all() else 0.5
    lines, arc, part, unit, share = lines[some], arc[some], part[some], unit[some], share[some]
    at = np.maximum.accumulate(np.clip(arc + part * unit, 0.0, arc[:, -1:]), axis=1)
    moves = share * np.where((part != 0.0)[..., None], sampled(nodes[lines], arc, at) - nodes[lines], 0.0)
    last = lines.shape[1] - 1 if row.closed else lines.shape[1]
    np.add.at(change, lines[:, :last], moves[:, :last])


def guarded(nodes: Floats, change: Floats, mesh: QuadMesh, least_sine: float) -> Floats:
    """Return nodes (n, 2) moved by `change` (n, 2), or less where cells would become too skew."""
    bound = np.minimum(least_sine, 0.95 * _sines(nodes, mesh.quads))
    part = np.ones(len(nodes))
    for _ in range(_ATTEMPTS):
        moved = nodes + part[:, None] * change
        bad = _sines(moved, mesh.quads) < bound
        if not bad.any():
            return moved
        part[mesh.quads[bad]] *= 0.3
        for _ in range(round(1.0 / _SPREAD)):
            least = part[mesh.edges].min(axis=1) + _SPREAD
            np.minimum.at(part, mesh.edges[:, 0], least)
            np.minimum.at(part, mesh.edges[:, 1], least)
    return nodes


def _sines(nodes: Floats, quads: Indices) -> Floats:
    """Return the smallest sine (m,) of the angles of quads, negative where they are folded."""
    z = nodes[quads]
    edge = np.roll(z, -1, axis=1) - z
    edge /= np.hypot(edge[..., 0], edge[..., 1])[..., None]
    before = np.roll(edge, 1, axis=1)
    return np.asarray((before[..., 0] * edge[..., 1] - before[..., 1] * edge[..., 0]).min(axis=1))
