"""Key sections stacked along the span: nodes of the same number follow a polynomial of the height.

::

    key sections --layers exact in space--> polynomials --heights along each line--> (s, theta, h)
        --nodes of the blade put on it--> --first cells exact at blade, hub, tip and casing--> RowNodes
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.rows.row import Row
from meshonet.solvers.rows.columns import respaced_columns
from meshonet.solvers.rows.key_sections import KeySection
from meshonet.solvers.rows.key_tables import KeyTables
from meshonet.solvers.rows.row_nodes import RowNodes, in_space
from meshonet.solvers.rows.span_lines import SpanLines, key_heights
from meshonet.solvers.rows.span_spacing import SAMPLES, line_parts
from meshonet.solvers.rows.zones import Zone

DEGREE = 5
"""Of polynomials along the span: optima of neighbouring sections differ by noise, and the rest is smooth."""
_EXACT = 40
"""Rounds in which first cells are made exact at most."""
_CLOSE = 1e-13


class StackedRow:
    """The nodes of a row.

    Parameters
    ----------
    row : the row.
    keys : its key sections.
    zones : of the span, from hub to casing.
    first : height of first cells at the blade.
    growth : largest ratio of neighbouring cells.

    Attributes
    ----------
    columns : (k, rows + 1) nodes of the layers, from the blade, clockwise around it.
    leading : which of these columns starts nearest to the leading edge.
    """

    def __init__(self, row: Row, keys: KeyTables, zones: Sequence[Zone], first: float, growth: float) -> None:
        self.row, self.zones, self.first, self.growth = row, zones, first, growth
        self.layout, self.plan, self.columns = keys.sections[0].layout, keys.plan, keys.plan.columns
        u = np.array([section.places for section in keys.sections])
        steps = np.mod(np.diff(u, axis=0) + 0.5, 1.0) - 0.5
        around = u[0] + np.cumsum(np.concatenate([np.zeros((1, u.shape[1])), steps]), axis=0)
        self.leading = int(np.abs(np.mod(around[0] + 0.5, 1.0) - 0.5).argmin())
        self.around = SpanLines.through(around, DEGREE)
        self.lines = SpanLines.through(np.stack([self._key(section) for section in keys.sections]), DEGREE)

    def _key(self, section: KeySection) -> Floats:
        """Return s, theta (n, 2) of a key section, its layers exact in space."""
        plane = section.plane
        nodes = self.plan.bent(plane, section.layout.mesh.nodes)
        values = np.stack([plane.map.back(nodes[:, 0]), nodes[:, 1]], axis=1)
        np.clip(values[:, 0], 0.0, 1.0, out=values[:, 0])
        column = values[self.columns]
        space = self._space(column, plane.height)
        values[self.columns] = respaced_columns(column, space, self.first)
        return values

    def _space(self, values: Floats, height: float) -> Floats:
        heights = np.full((*values.shape[:-1], 1), height)
        return in_space(self.row.channel, np.concatenate([values, heights], axis=-1))

    @cached_property
    def levels(self) -> tuple[int, ...]:
        """Numbers of the levels that bound the zones."""
        return tuple(np.cumsum([0, *(zone.cells for zone in self.zones)]).tolist())

    @property
    def bounds(self) -> list[tuple[int, int]]:
        """Numbers of the first and the last level of each zone."""
        return list(zip(self.levels[:-1], self.levels[1:], strict=True))

    @property
    def twins(self) -> tuple[Indices, Indices]:
        """Nodes (k,) of the second periodic side, and those of the first that they are turned from."""
        partner = self.layout.mesh.places.partner
        second = np.flatnonzero(partner >= 0)
        return second, partner[second]

    def nodes(self) -> RowNodes:
        """Return the nodes of all levels."""
        heights = self._heights()
        values = np.concatenate([self.lines.at(heights), heights[..., None]], axis=-1)
        np.clip(values[..., 0], 0.0, 1.0, out=values[..., 0])
        self._put_on_blade(values)
        made = RowNodes(self.row.channel, values)
        self._tie(values)
        self._exact_off_blade(made, near_ends=False)
        self._exact_along_span(made, near_blade=False)
        for _ in range(_EXACT):  # nodes next to two walls
            off = self._exact_off_blade(made, near_ends=True)
            self._exact_along_span(made, near_blade=True)
            if off < _CLOSE:
                break
        self._tie(values)
        return made

    def _heights(self) -> Floats:
        """Return heights (levels, n)."""
        parts: list[Floats] = []
        for zone in self.zones:
            at = zone.low + (zone.high - zone.low) * key_heights(SAMPLES)
            samples = self.lines.at(at[:, None])
            space = np.stack([self._space(own, h) for own, h in zip(samples, at, strict=True)])
            part = zone.low + (zone.high - zone.low) * line_parts(space, zone.ends, self.growth, zone.cells)
            part[0], part[-1] = zone.low, zone.high
            parts.append(part if not parts else part[1:])
        heights = np.concatenate(parts)
        second, first = self.twins
        heights[:, second] = heights[:, first]
        return heights

    def _put_on_blade(self, values: Floats) -> None:
        """Put the first nodes of columns on the blade; the others are moved by less and less."""
        wall = self.columns[:, 0]
        heights = values[:, wall, 2]
        u = np.mod(self.around.at(heights), 1.0)
        move = self.row.surface.at(u, heights) - values[:, wall, :2]
        m = self.columns.shape[1]
        share = (1.0 - (np.arange(m) / (m - 1)) ** 2) ** 2
        for j in range(m - 1):
            values[:, self.columns[:, j], :2] += share[j] * move

    def _tie(self, values: Floats) -> None:
        second, first = self.twins
        values[:, second] = values[:, first]
        values[:, second, 1] += self.row.pitch

    def _exact_off_blade(self, made: RowNodes, *, near_ends: bool) -> float:
        """Make first cells at the blade exact; return by how much the worst was not.

        With `near_ends` only those of the levels next to walls.
        """
        levels = self._near_levels if near_ends else np.arange(len(made.values))
        wall, above = self.columns[:, 0], self.columns[:, 1]
        values = made.values
        begin = values[np.ix_(levels, wall)]
        start = in_space(made.channel, begin)
        end = values[np.ix_(levels, above)]
        worst = 0.0
        for k in range(3):
            size = norms(in_space(made.channel, end) - start) / self.first
            if k == 0:
                worst, factor = float(np.abs(size - 1.0).max()), 1.0 / size
            end = begin + (end - begin) / size[..., None]
        m = self.columns.shape[1]
        if not near_ends:
            for j in range(2, m - 1):
                share = (1.0 - (j - 1) / (m - 2)) ** 2
                own = values[np.ix_(levels, self.columns[:, j])]
                values[np.ix_(levels, self.columns[:, j])] = (
                    begin + (own - begin) * (1.0 + share * (factor - 1.0))[..., None]
                )
        values[np.ix_(levels, above)] = end
        return worst

    @cached_property
    def _near_levels(self) -> Indices:
        """Levels next to hub, tip and casing."""
        levels = self.levels
        return np.array(sorted({*(k + 1 for k in levels[:-1]), *(k - 1 for k in levels[1:])}))

    def _exact_along_span(self, made: RowNodes, *, near_blade: bool) -> None:
        """Make first cells exact at hub, tip and casing; with `near_blade` only those next to the blade."""
        nodes = self.columns[:, 1] if near_blade else np.arange(made.values.shape[1])
        for zone, low, high in zip(self.zones, self.levels[:-1], self.levels[1:], strict=True):
            for end, level, size in ((low, low + 1, zone.ends[0]), (high, high - 1, zone.ends[1])):
                begin, own = made.values[end][nodes], made.values[level][nodes]
                start = in_space(made.channel, begin)
                for _ in range(3):
                    own = begin + (own - begin) * (size / norms(in_space(made.channel, own) - start))[:, None]
                made.values[level][nodes] = own
