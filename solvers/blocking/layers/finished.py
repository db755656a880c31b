"""The last steps of grids with layers: cells made to grow evenly, folds looked for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.errors import NoValidGridError, SolverError
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.decomposition.collapse.score import deviations
from meshonet.solvers.blocking.layers.even_mesh import evened_mesh
from meshonet.solvers.blocking.layers.folds import smallest_corners, unfolded
from meshonet.solvers.blocking.layers.layer_rows import LayerSettings

MARGIN = 1.21
"""By how much cells may differ in the end, in logarithms, over the growth of layers."""
MOST_GROWTH = 1.25
"""Ratio of neighbouring cells that is allowed in any case."""

DEARER, DEARER_DEG = 1.25, 0.25
"""By how much even growth may raise the mean deviation of angles from 90 degrees: a factor, and degrees."""

Bools = NDArray[np.bool_]


def finished(layout: Layout, settings: LayerSettings, held: Bools) -> Layout:
    """Return the layout with its cells made to grow evenly.

    Nodes `held` (n,) stay. Raises NoValidGridError: cells are folded; with the place.
    """
    layout = evened(layout, settings, held)
    held = held.copy()
    for number in layout.layers:
        block = layout.blocks[number]
        held[block[:, : 2 * block.shape[1] // 3]] = True
    layout = unfolded(layout, held)
    corner = smallest_corners(layout.mesh)
    if corner.min() <= 0.0:
        x, y = layout.mesh.nodes[layout.mesh.quads[int(corner.argmin())]].mean(axis=0)
        raise NoValidGridError(f"layers or cells beside them are folded at ({x:.6g}, {y:.6g})")
    return layout


def evened(layout: Layout, settings: LayerSettings, held: Bools | None = None) -> Layout:
    """Return the layout with cells that grow by no more than a limit, as far as first cells allow it.

    Nodes `held` (n,) stay.
    """
    held = np.zeros(len(layout.mesh.nodes), dtype=bool) if held is None else held.copy()
    for number in layout.layers:
        held[layout.blocks[number][:, : settings.constant + 1]] = True
    limit = max(MARGIN * math.log(settings.growth), math.log(MOST_GROWTH))
    try:
        mesh = evened_mesh(layout.mesh, held, limit)
    except SolverError:  # nodes that coincide
        return layout
    before, after = (float(deviations(each).mean()) for each in (layout.mesh, mesh))
    return replace(layout, mesh=mesh) if after <= DEARER * before + DEARER_DEG else layout
