"""What is left of a domain outside C sheets and rings: an outer loop that follows fronts, and others."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking import layered
from meshonet.solvers.blocking.c_sheets import Sheet, march_sheet
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.cut_loop import CutLoop
from meshonet.solvers.blocking.even_loops import Measure
from meshonet.solvers.blocking.free_wake import SHARP_DEG, free_wake
from meshonet.solvers.blocking.layer_law import layer_arcs
from meshonet.solvers.blocking.layer_rows import JOIN, LayerSettings, ring_metric
from meshonet.solvers.blocking.near_field import NearField
from meshonet.solvers.blocking.rings import march_ring
from meshonet.solvers.blocking.size_metric import SizeMetric


@dataclass(frozen=True, eq=False)
class Sheets(layered.Rings):
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
            sizes = layered.THICKNESS * loop.length, loop.length / layered.COLUMNS
            sheet = march_sheet(domain, number, wake, outer, settings.first, *sizes)
            if sheet is not None and not any(_close(sheet, other) for other in sheets):
                sheets.append(sheet)
        if not sheets:
            return None
        taken = {sheet.number for sheet in sheets}
        rings = {
            k: march_ring(
                domain, domain.loops[k], settings.first, layered.THICKNESS * domain.loops[k].length,
                domain.loops[k].length / layered.COLUMNS,
            )
            for k in loops if k not in taken
        }  # fmt: skip
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
    def measures(self) -> dict[int, Measure]:
        """What steps are to be even in, besides arc length, along the fronts of rings, by loop of `rest`."""
        return {k: self.rings[of].along_wall for k, of in self.numbers.items() if of in self.rings}

    def sheet_rows(self, sheet: Sheet) -> int:
        """Return the layers of a sheet."""
        wall = slice(sheet.edge, len(sheet.levels) - sheet.edge)
        return self.settings.rows(float(sheet.thickness[wall].max()))

    def attached_cells(self, chords: Chords, counts: Indices) -> int:
        """Return the cells of sheets, rings and of the rows to the far field, for counts (chords,)."""
        places, total, around = chords.layout.mesh.places, 0, 0
        spans = [self.cut.span(k) for k in range(len(self.cut.layers))]
        for edge in np.flatnonzero(chords.wall):
            nodes, cells = chords.edges[edge], int(counts[chords.chord[edge]])
            number = self.numbers[int(places.loop[nodes[0]])]
            if number in self.rings:
                total += cells * self.rows(self.rings[number])
            elif number == 0:
                arc = places.arc[nodes[len(nodes) // 2]]
                on = [k for k, (start, stop) in enumerate(spans) if start < arc < stop]
                total += cells * self.sheet_rows(self.cut.layers[on[0]]) if on else 0
                around += 0 if on else cells
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
    points = sheet.front
    length = np.hypot(*np.diff(points, axis=0).T)
    length = np.concatenate([length[:1], np.sqrt(length[1:] * length[:-1]), length[-1:]])
    around = np.pad(np.log(length), 4, mode="reflect")
    along = np.exp(np.convolve(around, np.full(9, 1.0 / 9.0), "valid"))
    tangent = np.gradient(points, axis=0)
    tangent /= np.hypot(*tangent.T)[:, None]
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    thickness = sheet.thickness / sheet.opening
    wall = slice(sheet.edge, len(points) - sheet.edge)
    rows = settings.rows(float(sheet.thickness[wall].max()))
    none = np.full_like(thickness, np.inf)
    arcs = layer_arcs(
        np.maximum(thickness, rows * settings.first), settings.first, none, rows, settings.constant
    )
    across = JOIN * sheet.opening * (arcs[:, -1] - arcs[:, -2])
    return SizeMetric(points, normal, across, along, np.inf)
