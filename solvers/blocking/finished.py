"""The last steps of grids with layers: nodes placed anew across layers, cells evened, folds looked for."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import percentiles_of
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.even_rows import evened_rows, guarded
from meshonet.solvers.blocking.folds import corner_jacobians, smallest_corner, unfolded
from meshonet.solvers.blocking.grid_lines import rows_of
from meshonet.solvers.blocking.layer_rows import LayerSettings
from meshonet.solvers.blocking.respace import respaced
from meshonet.solvers.blocking.score import deviations

RESPACED_SINE = 0.1
"""Of angles, that no node that is placed anew across layers may make smaller."""
MARGIN = 1.21
"""By how much cells may differ in the end, in logarithms, over the growth of layers."""

MOST_GROWTH, UNEVEN = 1.25, 4.0
"""Ratio of neighbouring cells beyond which they are uneven, and degrees that a percent of these costs."""


def best_of(layouts: Sequence[Layout]) -> Layout:
    """Return the layout of several, with the same blocks, whose cells are best in angles and growth.

    That is the least of the mean deviation of corners from 90 degrees, a twentieth of what one cell in a
    hundred exceeds, and `UNEVEN` for each percent of ratios of neighbouring cells beyond `MOST_GROWTH`.
    """
    return min(layouts, key=lambda layout: _price(layout))


def _price(layout: Layout) -> float:
    if smallest_corner(layout.mesh) <= 0.0:
        return np.inf
    off = deviations(layout.mesh)
    return float(
        off.mean() + 0.05 * percentiles_of(off.max(axis=1), (99,))[0] + UNEVEN * uneven_percent(layout)
    )


def uneven_percent(layout: Layout) -> float:
    """Return the percentage of ratios of neighbouring cells, along grid lines, beyond `MOST_GROWTH`."""
    count = beyond = 0
    for row in rows_of(Chords.of(layout)):
        step = np.diff(layout.mesh.nodes[row.nodes], axis=1)
        change = np.abs(np.diff(np.log(np.hypot(step[..., 0], step[..., 1])), axis=1))
        count, beyond = count + change.size, beyond + int((change > np.log(MOST_GROWTH)).sum())
    return 100.0 * beyond / max(count, 1)


def respaced_layers(layout: Layout, settings: LayerSettings, joints: Collection[int] = ()) -> Layout:
    """Return the layout with nodes placed anew across layers, as far as cells stay as they should be.

    `joints` are the nodes at which fronts of several layers meet.
    """
    mesh = layout.mesh
    change = respaced(layout, settings, joints).mesh.nodes - mesh.nodes
    return replace(layout, mesh=mesh.with_nodes(guarded(mesh.nodes, change, mesh, RESPACED_SINE)))


def finished(ways: Sequence[Layout], settings: LayerSettings, corners: Collection[int] = ()) -> Layout:
    """Return the best of several ways to place the nodes of a layout, its cells evened or as they are.

    `corners` are the numbers of blocks between the layers of two walls. Raises NoValidGridError: cells are
    folded; with the place.
    """
    limit = MARGIN * float(np.log(settings.growth))
    with np.errstate(invalid="ignore"):  # cells that shrink to nothing have no angles, and are not the best
        evened = [evened_rows(layout, limit, settings.constant) for layout in ways]
    layout = best_of([*ways, *evened])
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
