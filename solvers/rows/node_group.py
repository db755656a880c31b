"""Nodes of a row that are computed together, from polynomials along the span to positions in space.

Groups are complete columns of layers, or other nodes, and fit the cache.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.rows.row import Row
from meshonet.solvers.rows.exact_cells import exact_in_corners
from meshonet.solvers.rows.raised import Rise, raise_layers
from meshonet.solvers.rows.span_lines import SpanLines, key_heights
from meshonet.solvers.rows.span_spacing import SAMPLES, LineArcs, Spacing
from meshonet.solvers.rows.zones import Zone

_IN_GAP = 5  # number of heights in a gap at which lines are measured


@dataclass(frozen=True, eq=False)
class NodeGroup:
    """Some grid nodes of a blade row that are computed together."""

    row: Row  # the row
    zones: Sequence[Zone]  # zones of the span, from hub to casing
    ids: Indices  # (m,) indices of the nodes
    lines: SpanLines  # s and theta of the nodes as functions of the height
    around: SpanLines | None  # places (0 to 1) of columns of layers around the blade; None without columns
    first: float  # height of first cells at the blade

    @property
    def columns(self) -> int:
        """Number of lines of nodes from the blade through the layers; nodes on a line are consecutive."""
        return self.around.coefficients.shape[1] if self.around else 0

    def arcs(self) -> list[LineArcs]:
        """Return arc lengths along the lines from hub to casing, for each zone (the blade, or a gap)."""
        out = []
        for zone in self.zones:
            at = zone.low + (zone.high - zone.low) * key_heights(_IN_GAP if zone.gap else SAMPLES)
            samples = np.empty((len(at), len(self.ids), 3))
            samples[..., :2], samples[..., 2] = self.lines.at(at[:, None]), at[:, None]
            out.append(LineArcs.through(self.row.channel.in_space(samples)))
        return out

    def values(self, arcs: Sequence[LineArcs], spacings: Sequence[Spacing]) -> Floats:
        """Return the coordinates s, theta, h (see `Channel`) of the nodes, (levels, m, 3)."""
        values = self.at(self._heights(arcs, spacings))
        self._exact_along_span(values)
        if self.around:
            self._exact_in_corners(values.reshape(len(values), self.columns, -1, 3))
        return values

    def at(self, heights: Floats) -> Floats:
        """Return channel coordinates (levels, m, 3), see `Channel`, of the nodes at `heights` (levels, m)."""
        values = np.empty((*heights.shape, 3))
        values[..., :2], values[..., 2] = self.lines.at(heights), heights
        np.clip(values[..., 0], 0.0, 1.0, out=values[..., 0])
        if self.around:
            own = values.reshape(len(values), self.columns, -1, 3)
            u = np.mod(self.around.at(heights[:, :: own.shape[2]]), 1.0)
            wall = self.row.surface.at(u, own[:, :, 0, 2])
            self.row.channel.put_on_blade(own, wall, self.first)
        return values

    def _heights(self, arcs: Sequence[LineArcs], spacings: Sequence[Spacing]) -> Floats:
        parts: list[Floats] = []
        for zone, line, spacing in zip(self.zones, arcs, spacings, strict=True):
            part = zone.low + (zone.high - zone.low) * line.parts(spacing)
            part[0], part[-1] = zone.low, zone.high
            parts.append(part[1:] if parts else part)
        return np.concatenate(parts)

    @property
    def _ends(self) -> tuple[Indices, Indices, Floats]:
        """Levels that bound zones, levels next to them, and heights of the cells between."""
        walls: list[int] = []
        beside: list[int] = []
        sizes: list[float] = []
        low = 0
        for zone in self.zones:
            high = low + zone.cells
            walls += [low, high]
            beside += [low + 1, high - 1]
            sizes += zone.ends
            low = high
        return np.array(walls), np.array(beside), np.array(sizes)

    def _exact_along_span(self, values: Floats) -> None:
        """Make first cells exact at hub, tip and casing."""
        walls, beside, sizes = self._ends
        begin, end = values[walls], values[beside]
        self.row.channel.lengthen(begin, end, np.repeat(sizes, begin.shape[1]))
        values[beside] = end

    def _exact_in_corners(self, own: Floats) -> None:
        """Make both first cells of nodes in corners exact."""
        walls, beside, sizes = self._ends
        begins = own[beside][:, :, 0], own[walls][:, :, 1]
        lengths = self.first, sizes[:, None]
        own[beside, :, 1] = exact_in_corners(own[beside][:, :, 1], begins, lengths, self.row.channel.in_space)

    def store(self, values: Floats, rises: Sequence[Rise], space: Floats) -> None:
        """Write x, y, z of the group's nodes into the array `space` (levels, n, 3) of all nodes of the row.

        `values` (levels, m, 3) are the nodes' coordinates s, theta, h (see `Channel`). `rises` are small
        displacements of nodes in the blade's wall layers next to gaps at hub or casing.
        """
        self.row.channel.store(values, self.ids, space)
        if rises:
            shape = len(values), self.columns, -1, 3
            own = space[:, self.ids].reshape(shape)
            raise_layers(rises, own, values.reshape(shape)[:, :, 0, 2], self._ends, self.first)
            space[:, self.ids] = own.reshape(values.shape)
