"""The last steps of grids with layers: nodes placed anew across layers, cells evened, folds looked for."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.even_rows import evened_rows, guarded
from meshonet.solvers.blocking.folds import corner_jacobians, unfolded
from meshonet.solvers.blocking.layer_rows import LayerSettings
from meshonet.solvers.blocking.respace import respaced

RESPACED_SINE = 0.1
"""Of angles, that no node that is placed anew across layers may make smaller."""
MARGIN = 1.21
"""By how much cells may differ in the end, in logarithms, over the growth of layers."""


def respaced_layers(layout: Layout, settings: LayerSettings, joints: Collection[int] = ()) -> Layout:
    """Return the layout with nodes placed anew across layers, as far as cells stay as they should be.

    `joints` are the nodes at which fronts of several layers meet.
    """
    mesh = layout.mesh
    change = respaced(layout, settings, joints).mesh.nodes - mesh.nodes
    return replace(layout, mesh=mesh.with_nodes(guarded(mesh.nodes, change, mesh, RESPACED_SINE)))


def finished(layout: Layout, settings: LayerSettings, corners: Collection[int] = ()) -> Layout:
    """Return the layout with cells that grow evenly along its lines, and first cells exactly as high.

    `corners` are the numbers of blocks between the layers of two walls. Raises NoValidGridError: cells are
    folded; with the place.
    """
    layout = evened_rows(layout, MARGIN * float(np.log(settings.growth)), settings.constant)
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
