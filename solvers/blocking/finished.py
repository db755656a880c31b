"""The last steps of grids with layers: nodes placed anew across layers, cells evened, folds looked for."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, percentiles_of
from meshonet.geometry.elementary import log
from meshonet.geometry.errors import NoValidGridError, SolverError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.ties import first_least
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.even_mesh import evened_mesh
from meshonet.solvers.blocking.folds import corner_jacobians, smallest_corner, unfolded
from meshonet.solvers.blocking.grid_lines import rows_of
from meshonet.solvers.blocking.layer_rows import LayerSettings
from meshonet.solvers.blocking.respace import respaced
from meshonet.solvers.blocking.score import deviations

RESPACED_SINE = 0.1
"""Of angles, that no node that is placed anew across layers may make smaller."""
_ATTEMPTS = 6
_SPREAD = 0.15
MARGIN = 1.21
"""By how much cells may differ in the end, in logarithms, over the growth of layers."""

MOST_GROWTH, UNEVEN = 1.25, 4.0
"""Ratio of neighbouring cells beyond which they are uneven, and degrees that a percent of these costs."""


def best_of(layouts: Sequence[Layout]) -> Layout:
    """Return the layout of several, with the same blocks, whose cells are best in angles and growth.

    That is the least of the mean deviation of corners from 90 degrees, a twentieth of what one cell in a
    hundred exceeds, and `UNEVEN` for each percent of ratios of neighbouring cells beyond `MOST_GROWTH`.
    """
    return first_least(layouts, key=_price)


def _price(layout: Layout) -> float:
    if smallest_corner(layout.mesh) <= 0.0:
        return np.inf
    off = deviations(layout.mesh)
    return float(
        off.mean() + 0.05 * percentiles_of(off.max(axis=1), (99,))[0] + UNEVEN * uneven_percent(layout)
    )


def uneven_percent(layout: Layout) -> float:
    """Return the percentage of ratios of neighbouring cells, along grid lines, beyond `MOST_GROWTH`.

    Those below its square count in part: as many times `MOST_GROWTH` as they are beyond it, in logarithms.
    """
    count, beyond, limit = 0, 0.0, math.log(MOST_GROWTH)
    for row in rows_of(Chords.of(layout)):
        step = np.diff(layout.mesh.nodes[row.nodes], axis=1)
        change = np.abs(np.diff(log(np.hypot(step[..., 0], step[..., 1])), axis=1))
        count, beyond = count + change.size, beyond + float(np.clip(change / limit - 1.0, 0.0, 1.0).sum())
    return 100.0 * beyond / max(count, 1)


def respaced_layers(layout: Layout, settings: LayerSettings, joints: Collection[int] = ()) -> Layout:
    """Return the layout with nodes placed anew across layers, as far as cells stay as they should be.

    `joints` are the nodes at which fronts of several layers meet.
    """
    mesh = layout.mesh
    change = respaced(layout, settings, joints).mesh.nodes - mesh.nodes
    return replace(layout, mesh=mesh.with_nodes(_guarded(mesh.nodes, change, mesh)))


def finished(ways: Sequence[Layout], settings: LayerSettings, corners: Collection[int] = ()) -> Layout:
    """Return the best of several ways to place the nodes of a layout, its cells made to grow evenly.

    `corners` are the numbers of blocks between the layers of two walls. Raises NoValidGridError: cells are
    folded; with the place.
    """
    layout = best_of(ways)
    layout = best_of([layout, evened(layout, settings, corners)])
    held = np.zeros(len(layout.mesh.nodes), dtype=bool)
    for number in layout.layers:
        block = layout.blocks[number]
        held[block[:, : 2 * block.shape[1] // 3]] = True
    for number in corners:
        held[layout.blocks[number]] = True
    layout = unfolded(layout, held)
    corner = corner_jacobians(layout.mesh)
    if corner.min() <= 0.0:
        x, y = layout.mesh.nodes[layout.mesh.quads[int(corner.argmin())]].mean(axis=0)
        raise NoValidGridError(f"layers or cells beside them are folded at ({x:.6g}, {y:.6g})")
    return layout


def evened(layout: Layout, settings: LayerSettings, corners: Collection[int] = ()) -> Layout:
    """Return the layout with cells that grow by no more than a limit, as far as first cells allow it.

    Nodes of blocks with the numbers `corners` stay.
    """
    held = np.zeros(len(layout.mesh.nodes), dtype=bool)
    for number in layout.layers:
        held[layout.blocks[number][:, : settings.constant + 1]] = True
    for number in corners:
        held[layout.blocks[number]] = True
    limit = max(MARGIN * math.log(settings.growth), math.log(MOST_GROWTH))
    try:
        return replace(layout, mesh=evened_mesh(layout.mesh, held, limit))
    except SolverError:  # nodes that coincide
        return layout


def _guarded(nodes: Floats, change: Floats, mesh: QuadMesh) -> Floats:
    """Return nodes (n, 2) moved by `change` (n, 2), or less where cells would become too skew."""
    bound = np.minimum(RESPACED_SINE, 0.95 * _sines(nodes, mesh.quads))
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
    with np.errstate(invalid="ignore"):  # edges of no length have no angles
        edge /= np.hypot(edge[..., 0], edge[..., 1])[..., None]
    before = np.roll(edge, 1, axis=1)
    return np.asarray((before[..., 0] * edge[..., 1] - before[..., 1] * edge[..., 0]).min(axis=1))
