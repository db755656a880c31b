"""Cell lengths along walls, and thickness of the layers there, for layers in rows of a layout."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, distinct, norms, shortest_ways, turned_left
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import gaps_in_front, wall_points
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.wall_turning import SAMPLES, sizes_by_bend
from meshonet.geometry.spacing.gradual_sizes import graded
from meshonet.solvers.blocking.layers.layer_rows import last_layers
from meshonet.solvers.blocking.layers.marched import GAP_PART, SLOPE, check_room
from meshonet.solvers.blocking.layers.rings import COLUMNS, place
from meshonet.solvers.blocking.layers.stretches import Stretch
from meshonet.solvers.layers.layer_settings import LayerSettings
from meshonet.solvers.refinement.size_metric import SizeMetric

TURN = np.radians(3.5)  # largest angle by which a wall turns along one cell, for the default number of cells
CELLS_IN_GAP = 15.0  # smallest ratio of the gap in front of a wall to the length of cells along the wall
ALONG = 0.2  # growth of sizes along walls per length
UNEVEN = 2.0  # largest ratio of thickest to thinnest layers of a loop, which have the same number of cells
THINNEST = 8.0  # smallest thickness of layers in first cells
SPREAD = 0.1  # growth of the thickness of layers along a wake per distance from the sharp edge
AROUND_CORNER = 2.5  # ratio of arc length to distance up to which a wall point is around a corner: no gap


@dataclass(frozen=True, eq=False)
class RowSizes:
    """Cell sizes at points along a boundary loop; some parts of the loop have layers.

    Parameters
    ----------
    loop : the wall.
    arcs : (n,) ascending arc lengths of the points.
    length : (n,) cell length along the wall at each point; methods multiply it by their factor `scale`.
    gap : (n,) distance from each point to the nearest wall in front of it.
    on : (n,) mask of points with layers.
    first : (n,) first-cell heights.
    """

    loop: Loop
    arcs: Floats
    length: Floats
    gap: Floats
    on: np.ndarray
    first: Floats

    @classmethod
    def of(cls, domain: Domain, number: int, stretches: Sequence[Stretch], settings: LayerSettings) -> Self:
        """Return cell sizes along loop `number`, which has layers on `stretches` or, if empty, all around."""
        loop = domain.loops[number]
        arcs, length = sizes_by_bend(loop, loop.length / COLUMNS, TURN)
        gap = _gaps(domain, number, arcs)
        length = graded(np.minimum(length, gap / CELLS_IN_GAP), arcs, loop.length, ALONG)
        on = np.full(len(arcs), not stretches)
        first = np.full(len(arcs), settings.first if stretches else settings.at(loop.names).first)
        for each in stretches:
            begin, end = each.span(loop)
            here = np.mod(arcs - begin, loop.length) <= end - begin
            first[here] = settings.at(each.names(loop)).first
            on |= here
        return cls(loop, arcs, length, gap, on, first)

    def thickness(self, scale: float, settings: LayerSettings) -> Floats:
        """Return the total thickness (n,) of all layers at each point of the wall.

        Cells grow until square, or less in narrow gaps. `scale` multiplies cell lengths along the wall.
        """
        last = scale * self.length * settings.growth
        full = np.maximum((last - self.first) / (settings.growth - 1.0), THINNEST * self.first)
        full = np.minimum(full, GAP_PART * self.gap)
        full = np.minimum(full, UNEVEN * full[self.on].min())
        return graded(full, self.arcs, self.loop.length, SLOPE)

    def thickness_at(self, arcs: Floats, scale: float, settings: LayerSettings) -> Floats:
        """Return the thickness (k,) of layers at arc lengths `arcs` (k,), interpolated from `thickness`."""
        return np.interp(arcs, self.arcs, self.thickness(scale, settings), period=self.loop.length)

    def thickness_behind(self, away: Floats, scale: float, settings: LayerSettings) -> Floats:
        """Return the thickness (k,) of layers along a wake, at distances `away` (k,) from the sharp edge."""
        edge = self.thickness_at(self.loop.corner_arcs[:1], scale, settings)
        return edge + SPREAD * away

    def rows(self, scale: float, settings: LayerSettings) -> int:
        """Return the approximate number of layers; `scale` multiplies the cell lengths along the wall."""
        on = self.on & (self.first == settings.first)
        return settings.rows(float(self.thickness(scale, settings)[on if on.any() else self.on].max()))

    def check_room(self) -> None:
        """Raise InputError, with the position, if a gap is too narrow for layers."""
        for first in distinct(self.first):
            room = np.where(self.on & (self.first == first), GAP_PART * self.gap, np.inf)
            check_room(room, float(first), lambda k: place(self.loop, self.arcs[k]))

    def metric(self, scale: float, settings: LayerSettings) -> SizeMetric:
        """Return sizes of cells just outside the layers; `scale` multiplies cell lengths along the wall."""
        on, along = self.on, np.maximum(scale * self.length, self.first)
        thick, normals = self.thickness(scale, settings), turned_left(self.loop.tangent(self.arcs))
        across = np.minimum(last_layers(thick, self.rows(scale, settings), settings, self.first), along)
        points = self.loop.at(self.arcs) + thick[:, None] * normals
        return SizeMetric(points[on], normals[on], across[on], along[on], np.inf)

    def wake_metric(self, wake: Floats, scale: float, settings: LayerSettings) -> SizeMetric:
        """Return the target sizes of cells next to a `wake` (k, 2), the line behind a sharp trailing edge."""
        tangent = np.gradient(wake, axis=0)
        normals = turned_left(tangent) / np.hypot(*tangent.T)[:, None]
        away = np.hypot(*(wake - wake[0]).T)
        across = self.thickness_behind(away, scale, settings) * (1.0 - 1.0 / settings.growth) * settings.join
        edge = np.interp(self.loop.corner_arcs[0], self.arcs, self.length)
        along = scale * edge + settings.grading * min(scale, 1.0) * away
        return SizeMetric(wake, normals, across, np.maximum(along, across), np.inf)


def _gaps(domain: Domain, number: int, arcs: Floats) -> Floats:
    """Return the distance (n,) to the next wall in front, without the loop's own wall around a corner."""
    loop = domain.loops[number]
    points, along = loop.at(arcs), loop.tangent(arcs)
    others = [each for k, each in enumerate(domain.loops) if k != number]
    gap = gaps_in_front(wall_points(others), points, along) if others else np.full(len(arcs), np.inf)
    own, walls = np.linspace(0.0, loop.length, 2 * SAMPLES, endpoint=False), loop.sample(2 * SAMPLES)
    for k, arc in enumerate(arcs.tolist()):
        way = np.abs(shortest_ways(own - arc, loop.length))
        there = walls[way > AROUND_CORNER * norms(walls - points[k])]
        if len(there):
            gap[k] = min(gap[k], float(gaps_in_front(there, points[k : k + 1], along[k : k + 1])[0]))
    return gap
