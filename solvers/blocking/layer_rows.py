"""Layers in a ring: what their front asks of the cells beyond it, and the rows under the nodes of a front."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.spacing.growth import cells_for_growth
from meshonet.solvers.blocking.attach import Rows, loop_nodes, spaced
from meshonet.solvers.blocking.layer_law import layer_arcs
from meshonet.solvers.blocking.rings import Ring
from meshonet.solvers.blocking.size_metric import SizeMetric

JOIN = 1.1
"""Ratio of the first cell outside a ring to the last one inside."""


@dataclass(frozen=True)
class LayerSettings:
    """Layers of cells at walls.

    Parameters
    ----------
    first : height of the first cells, in the domain's unit.
    growth : largest ratio of neighbouring cells, on average along a column.
    constant : cells of that height.
    multiple : the number of layers is a multiple of it, so that coarser grids are nested.
    """

    first: float
    growth: float = 1.2
    constant: int = 1
    multiple: int = 1

    def rows(self, thickness: float) -> int:
        """Return how many layers fill a thickness."""
        rest = max(thickness - (self.constant - 1) * self.first, self.first)
        rows = self.constant - 1 + max(2, cells_for_growth(self.first, rest, self.growth))
        return -(-rows // self.multiple) * self.multiple


def ring_metric(ring: Ring, settings: LayerSettings) -> SizeMetric:
    """Return the sizes that the front of a ring asks for: its columns and its last layer."""
    points = ring.front.curve.points
    step = np.roll(points, -1, axis=0) - points
    length = np.hypot(*step.T)
    along = _smooth(0.5 * (length + np.roll(length, 1)))
    tangent = step + np.roll(step, 1, axis=0)
    tangent /= np.hypot(*tangent.T)[:, None]
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    thickness = np.hypot(*np.diff(ring.levels, axis=1).transpose(2, 0, 1)).sum(axis=1)
    rows = settings.rows(float(thickness.max()))
    arcs = layer_arcs(thickness, settings.first, np.full_like(thickness, np.inf), rows, settings.constant)
    across = JOIN * (arcs[:, -1] - arcs[:, -2])
    return SizeMetric(points, normal, across, along, np.inf)


def ring_rows(
    mesh: QuadMesh, loop: int, ring: Ring, rows: int, settings: LayerSettings, inner: Floats
) -> Rows:
    """Return the layers under the nodes of a front, `inner` (k,) the heights of the cells beyond it."""
    order = loop_nodes(mesh, loop)
    columns, starts = ring.columns(mesh.places.arc[order])
    part = arc_shares(columns)
    columns += part[..., None] * (mesh.nodes[order] - columns[:, -1])[:, None]

    def law(length: Floats) -> Floats:
        return layer_arcs(length, settings.first, inner / JOIN, rows, settings.constant, settings.growth)

    lines = spaced(columns, law)
    _exact(lines, settings.first)
    return Rows(loop, lines[:, ::-1], starts, True)


def heights_inside(layout: Layout, loop: int) -> Floats:
    """Return the lengths (k,) of the edges that leave the nodes of a loop for the inside, by arc length."""
    mesh = layout.mesh
    height = np.zeros(len(mesh.nodes))
    for block in layout.blocks:
        for side, next_row in (
            (block[:, 0], block[:, 1]), (block[:, -1], block[:, -2]),
            (block[0], block[1]), (block[-1], block[-2]),
        ):  # fmt: skip
            if (mesh.places.loop[side] == loop).all():
                height[side] = np.maximum(
                    height[side], np.hypot(*(mesh.nodes[next_row] - mesh.nodes[side]).T)
                )
    return height[loop_nodes(mesh, loop)]


def _smooth(values: Floats, window: int = 4) -> Floats:
    """Return the geometric running mean (n,) of values around a closed curve."""
    around = np.arange(-window, len(values) + window) % len(values)
    kernel = np.full(2 * window + 1, 1.0 / (2 * window + 1))
    return np.exp(np.convolve(np.log(values)[around], kernel, "valid"))


def arc_shares(lines: Floats) -> Floats:
    """Return how far (k, m) along their length the nodes of lines (k, m, 2) are, 0 to 1."""
    length = np.hypot(*np.diff(lines, axis=1).transpose(2, 0, 1))
    total = np.cumsum(length, axis=1)
    return np.concatenate([np.zeros((len(lines), 1)), total / total[:, -1:]], axis=1)


def _exact(lines: Floats, first: float) -> None:
    """Put the first node of each line (k, m, 2) exactly `first` from the wall, in place."""
    step = lines[:, 1] - lines[:, 0]
    lines[:, 1] = lines[:, 0] + step * (first / np.hypot(*step.T))[:, None]
