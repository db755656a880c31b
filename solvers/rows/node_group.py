"""Nodes of a row that are computed together, from polynomials along the span to positions in space.

::

    polynomials --arcs of each line--> heights --(s, theta, h)--> nodes of the blade put on it
        --> first cells exact at blade, hub, tip and casing --> x, y, z

A group consists of complete columns of layers, or of other nodes; it is small enough for the cache.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, norms
from meshonet.geometry.rows.row import Row
from meshonet.solvers.rows.span_lines import SpanLines, key_heights
from meshonet.solvers.rows.span_spacing import SAMPLES, LineArcs, Spacing
from meshonet.solvers.rows.zones import Zone

_IN_GAP = 5
"""Number of heights in a gap at which lines are measured."""
_EXACT = 12
"""Largest number of rounds that make first cells of nodes next to two walls exact."""
_CLOSE = 1e-13


@dataclass(frozen=True, eq=False)
class NodeGroup:
    """Some nodes of a row.

    Parameters
    ----------
    row : the row.
    zones : zones of the span, from hub to casing.
    ids : (m,) numbers of the nodes.
    lines : s and theta of the nodes as functions of the height.
    around : places u on the blade at which columns begin, as functions of the height; None: no columns.
    first : height of first cells at the blade.
    """

    row: Row
    zones: Sequence[Zone]
    ids: Indices
    lines: SpanLines
    around: SpanLines | None
    first: float

    @property
    def columns(self) -> int:
        """Number of columns of layers; the nodes of each follow those of the one before."""
        return self.around.coefficients.shape[1] if self.around else 0

    def arcs(self) -> list[LineArcs]:
        """Return the arc lengths of the lines along the span through the nodes, for each zone."""
        out = []
        for zone in self.zones:
            at = zone.low + (zone.high - zone.low) * key_heights(_IN_GAP if zone.gap else SAMPLES)
            samples = np.empty((len(at), len(self.ids), 3))
            samples[..., :2], samples[..., 2] = self.lines.at(at[:, None]), at[:, None]
            out.append(LineArcs.through(self.row.channel.in_space(samples)))
        return out

    def values(self, arcs: Sequence[LineArcs], spacings: Sequence[Spacing]) -> Floats:
        """Return s, theta, h (levels, m, 3) of the nodes for the spacing in each zone.

        `arcs` are from `arcs()`.
        """
        values = self.at(self._heights(arcs, spacings))
        self._exact_along_span(values)
        if self.around:
            self._exact_in_corners(values.reshape(len(values), self.columns, -1, 3))
        return values

    def at(self, heights: Floats) -> Floats:
        """Return s, theta, h (levels, m, 3) at heights (levels, m).

        Columns have exact first cells at the blade.
        """
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
        """Return heights (levels, m)."""
        parts: list[Floats] = []
        for zone, line, spacing in zip(self.zones, arcs, spacings, strict=True):
            part = zone.low + (zone.high - zone.low) * line.parts(spacing)
            part[0], part[-1] = zone.low, zone.high
            parts.append(part[1:] if parts else part)
        return np.concatenate(parts)

    @property
    def _ends(self) -> tuple[Indices, Indices, Floats]:
        """Levels that bound zones, the levels next to them, and the heights of the cells between."""
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
        """Make both first cells exact of nodes next to the blade and to hub, tip or casing.

        In each round a node moves along both lines, by what is missing of both lengths if the lines stay
        straight.
        """
        walls, beside, sizes = self._ends
        begins = own[beside][:, :, 0], own[walls][:, :, 1]
        starts = [self.row.channel.in_space(begin) for begin in begins]
        node = own[beside][:, :, 1]
        for _ in range(_EXACT):
            at = self.row.channel.in_space(node)
            one, other = (at - start for start in starts)
            lengths = norms(one), norms(other)
            off = self.first - lengths[0], sizes[:, None] - lengths[1]
            if max(np.abs(off[0]).max() / self.first, (np.abs(off[1]) / sizes[:, None]).max()) < _CLOSE:
                break
            cosine = (one * other).sum(axis=-1) / (lengths[0] * lengths[1])
            rest = 1.0 - cosine * cosine
            ways = (off[0] - cosine * off[1]) / rest, (off[1] - cosine * off[0]) / rest
            moves = [
                (way / length)[..., None] * (node - begin)
                for way, length, begin in zip(ways, lengths, begins, strict=True)
            ]
            node = node + moves[0] + moves[1]
        own[beside, :, 1] = node
