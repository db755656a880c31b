"""Last step of grids with layers: limitation of growth ratios."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Bools, Indices, norms
from meshonet.geometry.errors import NoValidGridError, SolverError
from meshonet.geometry.layout.lattice import smallest_jacobians
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.decomposition.symmetry.images import made_symmetric
from meshonet.solvers.blocking.layers.even_mesh import NO_PAIRS, evened_mesh
from meshonet.solvers.blocking.layers.growth_lines import GrowthLines
from meshonet.solvers.blocking.layers.marched import AT_SHARP_EDGE
from meshonet.solvers.blocking.unfolded import unfolded
from meshonet.solvers.layers.layer_settings import LayerSettings


def finished(layout: Layout, settings: LayerSettings, held: Bools, following: Indices = NO_PAIRS) -> Layout:
    """Return the layout with folded cells unfolded, and with limited growth of its cells.

    Nodes in the mask `held` (n,) are fixed. `following` (k, 2) has pairs: a wall node, and a node that moves
    with it. Raises NoValidGridError, with the position, if cells stay folded.
    """
    inner = held.copy()
    for number in layout.layers:
        block = layout.blocks[number]
        inner[block[:, : 2 * block.shape[1] // 3]] = True
    inner[following[:, 1]] = True
    layout = unfolded(layout, inner)
    layout = evened(layout, settings, held, following)  # which moves nothing near folded cells
    corner = smallest_jacobians(layout.mesh.nodes, layout.mesh.quads)
    if corner.min() <= 0.0:
        x, y = layout.mesh.nodes[layout.mesh.quads[int(corner.argmin())]].mean(axis=0)
        where = f"at ({x:.6g}, {y:.6g})"
        raise NoValidGridError(f"layers or cells beside them are folded {where}; {AT_SHARP_EDGE}")
    return layout


def evened(
    layout: Layout, settings: LayerSettings, held: Bools | None = None, following: Indices = NO_PAIRS
) -> Layout:
    """Return the layout with growth ratios of cells limited; `held` and `following` are as in `finished`."""
    places = layout.mesh.places
    held = np.zeros(len(places.loop), dtype=bool) if held is None else held.copy()
    for number in layout.layers:
        held[layout.blocks[number][:, : settings.constant + 1]] = True
    sliding = np.zeros(len(places.loop), dtype=bool)
    sliding[following[:, 0]] = True
    walls = (places.loop > 0) | ((held | sliding) & (places.loop == 0) & ~layout.mesh.tied)
    try:
        if settings.limit:
            lines = GrowthLines.from_walls(layout, walls, settings.steepest, settings.elsewhere, sliding)
        else:
            lines = GrowthLines.of(layout.mesh, settings.elsewhere)
        mesh = evened_mesh(layout.mesh, held, lines, following)
    except SolverError:  # nodes that coincide
        return layout
    mesh = made_symmetric(mesh)
    if len(following):  # the means of images are too near if the loop is not exactly symmetric
        mesh = made_symmetric(_as_far(mesh, layout.mesh, following))
    return replace(layout, mesh=mesh)


def _as_far(mesh: QuadMesh, before: QuadMesh, pairs: Indices) -> QuadMesh:
    """Return the mesh with the distances between pairs (k, 2) of nodes that they had `before`."""
    first, second = pairs.T
    nodes, away = mesh.nodes.copy(), mesh.nodes[second] - mesh.nodes[first]
    far = norms(before.nodes[second] - before.nodes[first])
    nodes[second] = nodes[first] + away * (far / norms(away))[:, None]
    return mesh.with_nodes(nodes)
