"""Layers in a ring: cell sizes that its front requires, and rows below the nodes of the front."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats, arc_parts, norms, running_sums, turned_left
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.spacing.growth import cells_for_growth
from meshonet.solvers.blocking.layers.attach import Rows, spaced
from meshonet.solvers.blocking.layers.rings import Ring
from meshonet.solvers.layers.layer_law import STEEPER, layer_arcs
from meshonet.solvers.refinement.size_metric import GRADING, SizeMetric

JOIN = 1.1
"""Ratio of the first cell outside a ring to the last one inside."""
NOMINAL, STEEPEST = 0.9, 0.97
"""Mean and largest growth of layers over the limit, in logarithms: the rest is left for what follows."""
ELSEWHERE, MOST_GROWTH = 1.21, 1.25
"""By how much cells may differ along walls, in logarithms, over the limit, and ratio that is allowed in any
case there.
"""
SPREAD = 0.65
"""Largest growth of edge lengths per distance, over the growth from one cell to the next."""
_WINDOW = 4  # columns to either side over which lengths along fronts are averaged


@dataclass(frozen=True)
class LayerSettings:
    """Layers of cells at walls.

    Parameters
    ----------
    first : first-cell height in the domain's unit; without `heights` that of all walls.
    growth : largest mean ratio of neighbouring cells along a column.
    constant : number of cells with the height of the first one.
    multiple : divisor of the number of layers, so that coarser grids are nested.
    heights : first-cell heights of walls by name.
    limit : largest ratio of neighbouring cells along lines from walls; 0 for that of layers, `growth`, and
        a fifth more, in logarithms, where columns differ.
    """

    first: float
    growth: float = 1.2
    constant: int = 1
    multiple: int = 1
    heights: Mapping[str, float] = field(default_factory=dict)
    limit: float = 0.0

    @classmethod
    def limited(cls, first: float, limit: float, **others: Any) -> LayerSettings:
        """Return layers whose cells, and those beyond, do not grow faster than a limit."""
        return cls(first, math.exp(NOMINAL * math.log(limit)), limit=limit, **others)

    def at(self, names: Collection[str]) -> LayerSettings:
        """Return the layers of a wall that consists of stretches with some `names`.

        Raises InputError: stretches of one wall with different heights.
        """
        if not self.heights:
            return self
        first = {self.heights[name]: name for name in reversed(list(names))}
        if len(first) > 1:
            one, other = list(first.values())[:2]
            raise InputError(
                f"first cells of {self.heights[other]:g} at {other!r} and {self.heights[one]:g} at {one!r}, "
                "which are parts of one wall with layers",
                "give both the same: heights change at corners of about 90 degrees only",
                parameter="first_cell",
            )
        return replace(self, first=next(iter(first)), heights={})

    @property
    def steepest(self) -> float:
        """Logarithm of the ratio by which neighbouring cells along lines from walls may differ in the end."""
        return math.log(self.limit) if self.limit else self.elsewhere

    @property
    def elsewhere(self) -> float:
        """The same along walls."""
        return max(ELSEWHERE * math.log(self.limit or self.growth), math.log(MOST_GROWTH))

    @property
    def join(self) -> float:
        """Ratio of the first cell beyond the layers to the last one of them."""
        return min(JOIN, math.sqrt(self.limit)) if self.limit else JOIN

    @property
    def grading(self) -> float:
        """Growth of cells outside of layers with the distance from walls."""
        return min(GRADING, SPREAD * (self.limit - 1.0)) if self.limit else GRADING

    def below(self, growth: float) -> float:
        """Return a growth of cells outside of layers, `growth` unless that is too close to the limit."""
        return min(growth, 1.0 + NOMINAL * (self.limit - 1.0)) if self.limit else growth

    def arcs(self, length: Floats, first: float | Floats, last: Floats, cells: int) -> Floats:
        """Return distances (k, cells + 1) from walls, as `layer_arcs`, that grow no faster than the limit."""
        most, steeper = self.growth, STEEPER
        if self.limit:
            most, steeper = math.exp(STEEPEST * math.log(self.limit)), STEEPEST / NOMINAL - 1.0
        return layer_arcs(length, first, last, cells, self.constant, most, steeper)

    def rows(self, thickness: float) -> int:
        """Return the number of layers that fill a thickness."""
        rest = max(thickness - (self.constant - 1) * self.first, self.first)
        rows = self.constant - 1 + max(2, cells_for_growth(self.first, rest, self.growth))
        return -(-rows // self.multiple) * self.multiple


def ring_metric(ring: Ring, settings: LayerSettings, factors: Floats | float = 1.0) -> SizeMetric:
    """Return the cell sizes that the front of a ring requires: those of its columns and its last layer.

    First cells are higher than those of the settings by `factors` (n,) at the columns.
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
    """Return the heights (n,) of the first cells beyond `rows` layers with the total `thickness` (n,)."""
    none = np.full_like(thickness, np.inf)
    arcs = layer_arcs(thickness, settings.first if first is None else first, none, rows, settings.constant)
    return np.asarray(settings.join * (arcs[:, -1] - arcs[:, -2]))


def ring_rows(
    mesh: QuadMesh, loop: int, ring: Ring, rows: int, settings: LayerSettings, inner: Floats,
    factors: Callable[[Floats], Floats] | None = None,
) -> Rows:  # fmt: skip
    """Return the layers below the nodes of a front; `inner` (k,) are the heights of the cells beyond it.

    First cells are higher than those of the settings by `factors` of arc lengths (k,) of the wall, if given.
    """
    order = mesh.places.along(loop)
    columns, starts = ring.columns(mesh.places.arc[order])
    first = settings.first * (factors(starts) if factors else np.ones(len(starts)))
    lines = layer_lines(columns, mesh.nodes[order], inner, rows, settings, first)
    return Rows(loop, lines[:, ::-1], starts, True)


def layer_lines(
    columns: Floats, ends: Floats, inner: Floats, rows: int, settings: LayerSettings, first: Floats
) -> Floats:
    """Return the nodes (k, rows + 1, 2) of layers along columns (k, m, 2), from the wall to `ends` (k, 2).

    `inner` (k,) are the heights of the cells beyond, `first` (k,) those of the first ones.
    """
    columns = columns + arc_parts(columns)[..., None] * (ends - columns[:, -1])[:, None]

    lines = spaced(columns, lambda length: settings.arcs(length, first, inner / settings.join, rows))
    exact(lines, first)
    return lines


def heights_inside(layout: Layout, loop: int) -> Floats:
    """Return the lengths (k,) of the edges that leave the nodes of a loop into the domain, by arc length."""
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
    return height[mesh.places.along(loop)]


def _smooth(values: Floats, window: int = _WINDOW) -> Floats:
    """Return the geometric running mean (n,) of values around a closed curve."""
    around = np.arange(-window, len(values) + window) % len(values)
    return exp(running_sums(log(values)[around], 2 * window + 1) / (2 * window + 1))


def exact(lines: Floats, first: float | Floats) -> None:
    """Move the first node of each line (k, m, 2) exactly to the distance `first` from the wall, in place."""
    step = lines[:, 1] - lines[:, 0]
    lines[:, 1] = lines[:, 0] + step * (first / np.hypot(*step.T))[:, None]
