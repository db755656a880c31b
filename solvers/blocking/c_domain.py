"""What is left of a domain outside C sheets and rings: an outer loop that follows fronts, and others."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.c_sheets import Sheet, march_sheet
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.cut_loop import CutLoop
from meshonet.solvers.blocking.even_line import Measures
from meshonet.solvers.blocking.free_wake import SHARP_DEG, free_wake
from meshonet.solvers.blocking.layer_rows import LayerSettings, last_layers, open_metric, ring_metric
from meshonet.solvers.blocking.near_field import NearField
from meshonet.solvers.blocking.size_metric import SizeMetric
from meshonet.solvers.blocking.wall_layers import COLUMNS, THICKNESS, WallLayers, rings_around


@dataclass(frozen=True, eq=False)
class Sheets(WallLayers):
    """Walls with their rings and C sheets; loops of `rest` are fewer than those of `domain`.

    `cut` is the first loop of `rest`; `numbers` are those that the loops of `rest` have in `domain`.
    """

    cut: CutLoop[Sheet]
    numbers: dict[int, int]

    @classmethod
    def along(cls, domain: Domain, loops: list[int], settings: LayerSettings) -> Sheets | None:
        """Return the sheets and rings around some loops of a domain, None where no sheet can be."""
        near = NearField.of(domain)
        outer = near.circle if near else domain.loops[0]
        sheets: list[Sheet] = []
        if 0 in loops or domain.periodic is not None:
            return None
        for number in loops:
            wake = free_wake(domain, number, outer)
            if wake is None:
                continue
            loop = domain.loops[number]
            sizes = THICKNESS * loop.length, loop.length / COLUMNS
            sheet = march_sheet(domain, number, wake, outer, settings.first, *sizes)
            if sheet is not None and not any(_close(sheet, earlier) for earlier in sheets):
                sheets.append(sheet)
        if not sheets:
            return None
        taken = {sheet.number for sheet in sheets}
        rings = rings_around(domain, [k for k in loops if k not in taken], settings)
        cut = CutLoop.of(outer, sheets)
        left = [k for k in range(1, len(domain.loops)) if k not in taken]
        rest = [cut.loop, *(rings[k].front if k in rings else domain.loops[k] for k in left)]
        numbers = {0: 0} | {i + 1: k for i, k in enumerate(left)}
        return cls(domain, rings, near, Domain(tuple(rest), domain.name), settings, cut, numbers)

    @property
    def notes(self) -> tuple[str, ...]:
        """What to say of bodies that have rings because their wakes are not free."""
        loops = self.domain.loops
        sharp = [loops[k].names[0] for k in self.rings if loops[k].corner_angles.max(initial=0.0) > SHARP_DEG]
        return (f"rings, not C sheets, around {', '.join(sharp)}: wakes are not free",) if sharp else ()

    @cached_property
    def _metric(self) -> SizeMetric:
        parts = [ring_metric(ring, self.settings) for ring in self.rings.values()]
        return SizeMetric.joined([*(_sheet_metric(s, self.settings) for s in self.cut.layers), *parts])

    @property
    def measures(self) -> dict[int, Measures]:
        """What steps are to be even in, besides arc length, along the fronts of rings, by loop of `rest`."""
        return {k: self.rings[of].along for k, of in self.numbers.items() if of in self.rings}

    def sheet_rows(self, sheet: Sheet) -> int:
        """Return the layers of a sheet."""
        wall = slice(sheet.edge, len(sheet.levels) - sheet.edge)
        return self.settings.rows(float(sheet.thickness[wall].max()))

    def attached_cells(self, chords: Chords, counts: Indices) -> int:
        """Return the cells of sheets, rings and of the rows to the far field, for counts (chords,)."""
        places, total, around = chords.layout.mesh.places, 0, 0
        for edge in np.flatnonzero(chords.wall):
            nodes, cells = chords.edges[edge], int(counts[chords.chord[edge]])
            number = self.numbers[int(places.loop[nodes[0]])]
            if number in self.rings:
                total += cells * self.rows(self.rings[number])
            elif number == 0:
                on = self.cut.front_at(float(places.arc[nodes[len(nodes) // 2]]))
                total += cells * self.sheet_rows(self.cut.layers[on]) if on is not None else 0
                around += cells if on is None else 0
        if self.near is not None:
            around += 2 * sum(self.sheet_rows(sheet) for sheet in self.cut.layers)
            total += around * self.near.cells(2.0 * np.pi * self.near.radius / max(around, 1))
        return total


def _close(first: Sheet, second: Sheet) -> bool:
    apart = first.levels[:, 0][:, None] - second.levels[:, 0][None]
    return bool(
        np.hypot(apart[..., 0], apart[..., 1]).min() < 2.0 * (first.thickness.max() + second.thickness.max())
    )


def _sheet_metric(sheet: Sheet, settings: LayerSettings) -> SizeMetric:
    """Return the sizes that the front of a sheet asks for: its columns and its last layer."""
    wall = slice(sheet.edge, len(sheet.levels) - sheet.edge)
    rows = settings.rows(float(sheet.thickness[wall].max()))
    thickness = np.maximum(sheet.thickness / sheet.opening, rows * settings.first)
    return open_metric(sheet.front, sheet.opening * last_layers(thickness, rows, settings))
