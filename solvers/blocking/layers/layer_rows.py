"""Layers of a ring between its wall and its front (outer edge), and cell sizes beyond the front."""

from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats, norms, running_sums, turned_left
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.layers.attach import Rows
from meshonet.solvers.blocking.layers.rings import Ring
from meshonet.solvers.layers.layer_law import layer_arcs
from meshonet.solvers.layers.layer_settings import LayerSettings, layer_lines
from meshonet.solvers.refinement.size_metric import SizeMetric

_WINDOW = 4  # columns to either side over which lengths along fronts are averaged


def ring_metric(ring: Ring, settings: LayerSettings, factors: Floats | float = 1.0) -> SizeMetric:
    """Return the target sizes of the cells just outside the layers around a wall.

    `factors` (n,) multiply the first-cell height from `settings` at the n lines of nodes across the layers.
    """
    points = ring.front.curve.points
    step = np.roll(points, -1, axis=0) - points
    length = np.hypot(*step.T)
    along = _smooth(0.5 * (length + np.roll(length, 1)))
    tangent = step + np.roll(step, 1, axis=0)
    rows = settings.rows(float((ring.thickness / factors).max()))
    across = last_layers(ring.thickness, rows, settings, settings.first * factors)
    normals = turned_left(tangent / norms(tangent)[:, None])
    return SizeMetric(points, normals, across, along, np.inf)


def last_layers(
    thickness: Floats, rows: int, settings: LayerSettings, first: float | Floats | None = None
) -> Floats:
    """Return the heights (n,) of the cells just outside the layers: `settings.join` times the last layer's.

    The `rows` layers are `thickness` (n,) thick together, the first one `first` (default: `settings.first`).
    """
    none = np.full_like(thickness, np.inf)
    arcs = layer_arcs(thickness, settings.first if first is None else first, none, rows, settings.constant)
    return np.asarray(settings.join * (arcs[:, -1] - arcs[:, -2]))


def ring_rows(
    mesh: QuadMesh, loop: int, ring: Ring, rows: int, settings: LayerSettings, beyond: Floats,
    factors: Callable[[Floats], Floats] | None = None,
) -> Rows:  # fmt: skip
    """Return the layers of a ring, between its wall and the nodes of `mesh` on its outer edge.

    `beyond` (k,) are the heights of the first cells beyond the layers. First-cell heights of the settings are
    multiplied by `factors`, a function of arc lengths (k,) of the wall.
    """
    order = mesh.places.along(loop)
    columns, starts = ring.columns(mesh.places.arc[order])
    first = settings.first * (factors(starts) if factors else np.ones(len(starts)))
    lines = layer_lines(columns, mesh.nodes[order], beyond, rows, settings, first)
    return Rows(loop, lines[:, ::-1], starts, True)


def heights_inside(layout: Layout, loop: int) -> Floats:
    """Return the lengths (k,) of the edges from a loop into the domain, in the order of its nodes."""
    mesh, height = layout.mesh, np.zeros(len(layout.mesh.nodes))
    for table in layout.beside(mesh.places.loop == loop):
        side = table[:, 0]
        height[side] = np.maximum(height[side], norms(mesh.nodes[table[:, 1]] - mesh.nodes[side]))
    return height[mesh.places.along(loop)]


def _smooth(values: Floats, window: int = _WINDOW) -> Floats:
    """Return the geometric running mean (n,) of values around a closed curve."""
    around = np.arange(-window, len(values) + window) % len(values)
    return exp(running_sums(log(values)[around], 2 * window + 1) / (2 * window + 1))
