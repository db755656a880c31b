"""Key sections stacked along the span: each node is on a polynomial of the height."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, wrapped
from meshonet.geometry.cached import cached_property
from meshonet.geometry.rows.row import Row
from meshonet.geometry.threads import in_threads, run_in_threads
from meshonet.solvers.rows.columns import respaced_columns
from meshonet.solvers.rows.key_sections import KeySection
from meshonet.solvers.rows.key_tables import KeyTables
from meshonet.solvers.rows.node_group import NodeGroup
from meshonet.solvers.rows.raised import Rise, rises_of
from meshonet.solvers.rows.span_lines import SpanLines
from meshonet.solvers.rows.span_spacing import LineArcs, Spacing
from meshonet.solvers.rows.zones import Zone

DEGREE = 5  # degree of the polynomials along the span; optima of neighbouring sections contain noise
_AT_ONCE = 1 << 18  # number of nodes that are computed together: few calls, and arrays of some megabytes


@dataclass(frozen=True, eq=False)
class RowNodes:
    """Nodes of a blade row: x, y, z of all, and s, theta, h (see `Channel`) of those on the blade."""

    space: Floats  # (levels, n, 3) x, y, z
    blade: Floats  # (levels, k, 3) s, theta, h of the blade's nodes, clockwise


class StackedRow:
    """The nodes of a row, stacked along the span.

    Parameters
    ----------
    row, keys : the row, and its key sections, between which nodes are interpolated.
    zones : zones of the span (the blade, and gaps), from hub to casing.
    first, growth : first-cell height at the blade, and largest ratio of neighbouring cells.

    Attributes
    ----------
    columns : (k, layers + 1) node indices on k lines from the blade through its layers, in order around it.
    """

    def __init__(self, row: Row, keys: KeyTables, zones: Sequence[Zone], first: float, growth: float) -> None:
        self.row, self.zones, self.first, self.growth = row, zones, first, growth
        self.layout, self.plan, self.columns = keys.sections[0].layout, keys.plan, keys.plan.columns
        u = np.array([section.places for section in keys.sections])
        steps = wrapped(np.diff(u, axis=0))
        around = u[0] + np.cumsum(np.concatenate([np.zeros((1, u.shape[1])), steps]), axis=0)
        self.around = SpanLines.through(around, DEGREE)
        self.lines = SpanLines.through(np.stack(in_threads(self._key, keys.sections)), DEGREE)

    def _key(self, section: KeySection) -> Floats:
        """Return s, theta (n, 2) of a key section with exact layers in space."""
        plane = section.plane
        nodes = self.plan.bent(plane, section.layout.mesh.nodes)
        values = np.stack([plane.map.back(nodes[:, 0]), nodes[:, 1]], axis=1)
        np.clip(values[:, 0], 0.0, 1.0, out=values[:, 0])
        column = values[self.columns]
        heights = np.full((*column.shape[:-1], 1), plane.height)
        space = self.row.channel.in_space(np.concatenate([column, heights], axis=-1))
        values[self.columns] = respaced_columns(column, space, self.first)
        return values

    @cached_property
    def levels(self) -> tuple[int, ...]:
        """Indices of the levels that bound the zones of the span (blade and gaps), from hub to casing."""
        return tuple(np.cumsum([0, *(zone.cells for zone in self.zones)]).tolist())

    @cached_property
    def _rises(self) -> list[Rise]:
        lines = self.lines.of(self.columns.ravel())
        return rises_of(self.row, self.zones, self.around, lines, self.first)

    @property
    def bounds(self) -> list[tuple[int, int]]:
        """First and last level (index along the span) of each zone, which is a gap or the blade."""
        return list(zip(self.levels[:-1], self.levels[1:], strict=True))

    @property
    def twins(self) -> tuple[Indices, Indices]:
        """Indices (k,) of nodes on the second periodic side, and of their partners (k,) on the first side."""
        partner = self.layout.mesh.places.partner
        second = np.flatnonzero(partner >= 0)
        return second, partner[second]

    def nodes(self) -> tuple[RowNodes, list[Callable[[], None]]]:
        """Return the row's nodes, and functions that must be called to fill in those in the wall layers.

        Until then, x, y, z there are undefined. The nodes of the second periodic side are not computed.
        """
        groups = self._groups()
        arcs = in_threads(NodeGroup.arcs, groups)
        spacings = in_threads(self._spacing, list(zip(self.zones, zip(*arcs, strict=True), strict=True)))
        count, levels = len(self.layout.mesh.nodes), self.levels[-1] + 1
        made = RowNodes(np.empty((levels, count, 3)), np.empty((levels, len(self.columns), 3)))
        jobs: list[Callable[[], Floats | None]] = [
            partial(self._layers if group.columns else self._fill, made, group, own, spacings)
            for group, own in zip(groups, arcs, strict=True)
        ]
        values = zip(groups, run_in_threads(jobs), strict=True)
        return made, [partial(self._store, made, group, own) for group, own in values if group.columns]

    def _spacing(self, lines: tuple[Zone, tuple[LineArcs, ...]]) -> Spacing:
        zone, arcs = lines
        shortest = min(float(each.lengths.min()) for each in arcs)
        longest = max(float(each.lengths.max()) for each in arcs)
        return Spacing.of((shortest, longest), zone.ends, self.growth, zone.cells)

    def _groups(self) -> list[NodeGroup]:
        """Return the groups of all nodes but the second periodic side, first those of layers."""
        count, levels = len(self.layout.mesh.nodes), self.levels[-1] + 1
        own = max(1, _AT_ONCE // (levels * self.columns.shape[1]))
        groups = []
        for start in range(0, len(self.columns), own):
            part = slice(start, start + own)
            groups.append(self._group(self.columns[part].ravel(), self.around.of(part)))
        others = np.ones(count, dtype=bool)
        others[self.columns] = others[self.twins[0]] = False
        ids, own = np.flatnonzero(others), max(1, _AT_ONCE // levels)
        groups += [self._group(ids[start : start + own], None) for start in range(0, len(ids), own)]
        return groups

    def _group(self, ids: Indices, around: SpanLines | None) -> NodeGroup:
        return NodeGroup(self.row, self.zones, ids, self.lines.of(ids), around, self.first)

    def _layers(
        self, made: RowNodes, group: NodeGroup, arcs: Sequence[LineArcs], spacings: Sequence[Spacing]
    ) -> Floats:
        """Return s, theta, h of a group of layers, and store those of the blade."""
        values = group.values(arcs, spacings)
        made.blade[:, self._part(group)] = values.reshape(len(values), group.columns, -1, 3)[:, :, 0]
        return values

    def _part(self, group: NodeGroup) -> slice:
        start = int(np.flatnonzero(self.columns[:, 0] == group.ids[0])[0])
        return slice(start, start + group.columns)

    def _fill(
        self, made: RowNodes, group: NodeGroup, arcs: Sequence[LineArcs], spacings: Sequence[Spacing]
    ) -> None:
        self._store(made, group, group.values(arcs, spacings))

    def _store(self, made: RowNodes, group: NodeGroup, values: Floats) -> None:
        rises = [rise.of_columns(self._part(group)) for rise in self._rises] if group.columns else []
        group.store(values, [rise for rise in rises if rise.moves.any()], made.space)
