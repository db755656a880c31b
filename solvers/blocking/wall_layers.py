"""Walls with their layers, what these leave of a domain, and how fine cells there are to be."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.cut_loop import CutLoop
from meshonet.solvers.blocking.even_line import Measures
from meshonet.solvers.blocking.feature_sizes import feature_sizes
from meshonet.solvers.blocking.layer_rows import LayerSettings, last_layers, open_metric, ring_metric
from meshonet.solvers.blocking.near_field import NearField
from meshonet.solvers.blocking.padding import Span
from meshonet.solvers.blocking.rings import Ring, march_ring
from meshonet.solvers.blocking.size_metric import SizeMetric
from meshonet.solvers.blocking.stretches import Stretch
from meshonet.solvers.blocking.strips import Strip, joined_strips, march_strip
from meshonet.solvers.blocking.wanted_counts import WantedCounts

COLUMNS = 140
"""Cells around a loop, if all were as long as the longest."""
THICKNESS = 0.018
"""Thickness of layers where there is room, in lengths of their loop."""
INNER_THICKNESS = 0.12
"""The same of layers inside an outer loop, in hydraulic diameters: four times the area over the perimeter."""
MOST_OPTIMISED = 4000
"""Cells that are optimised at the most; finer grids are splines through these."""
_BISECTIONS = 12


@dataclass(frozen=True, eq=False)
class WallLayers:
    """Walls with their layers, and the domain that is left.

    `rings` are by number of their loop, which is the same in both domains, and so are the loops that strips
    of layers have cut; `near` stands in for a distant outer loop.
    """

    domain: Domain
    rings: Mapping[int, Ring]
    near: NearField | None
    rest: Domain
    settings: LayerSettings
    cuts: Mapping[int, CutLoop[Strip]] = field(default_factory=dict, kw_only=True)

    @classmethod
    def of(
        cls, domain: Domain, loops: Sequence[int], settings: LayerSettings, stretches: Sequence[Stretch] = ()
    ) -> WallLayers:
        """Return the rings around some loops of a domain, and the strips along stretches of others.

        Raises InputError: no room for layers; a wall that they fold at.
        """
        rings = rings_around(domain, loops, settings)
        cuts = {}
        for number in sorted({stretch.loop for stretch in stretches}):
            own = [stretch for stretch in stretches if stretch.loop == number]
            sizes = _sizes(domain, number)
            strips = joined_strips([march_strip(domain, each, settings.first, *sizes) for each in own])
            cuts[number] = CutLoop.of(domain.loops[number], strips)
        near = None if 0 in rings or 0 in cuts else NearField.of(domain)
        rest = list(domain.loops)
        if near is not None:
            rest[0] = near.circle
        for k, ring in rings.items():
            rest[k] = ring.front
        for k, cut in cuts.items():
            rest[k] = cut.loop
        return cls(domain, rings, near, Domain(tuple(rest), domain.name), settings, cuts=cuts)

    @property
    def fronts(self) -> tuple[int, ...]:
        """Numbers of the loops of which fronts have taken the place, or parts of it."""
        return (*self.rings, *self.cuts)

    @property
    def spans(self) -> list[Span]:
        """Stretches of the loops of `rest` that are fronts, but for whole loops."""
        cuts = ((k, cut) for k, cut in self.cuts.items() if len(cut.loop.corners) > 1)
        return [(k, *cut.span(i)) for k, cut in cuts for i in range(len(cut.layers))]

    @cached_property
    def _metric(self) -> SizeMetric:
        parts = [ring_metric(ring, self.settings) for ring in self.rings.values()]
        for strip in (strip for cut in self.cuts.values() for strip in cut.layers):
            across = last_layers(strip.thickness, self.rows(strip), self.settings)
            parts.append(open_metric(strip.front, across))
        return SizeMetric.joined(parts) if parts else feature_sizes(self.rest)

    def metric(self, scale: float, size: float = 0.0) -> SizeMetric:
        """Return the sizes of cells outside the layers: at most `size`, or `scale` times their columns."""
        if size:
            along = self._metric.along * max(size / self._metric.along.max(), 1.0) ** 0.5
            return replace(self._metric, along=np.minimum(along, size), largest=size)
        parts = self._metric
        finer = min(scale, 1.0)  # as sizes at walls are, so that sizes grow alike at any count of cells
        largest = self.rest.extent / 12.0 * scale**0.5
        return replace(parts, along=scale * parts.along, largest=largest, grading=finer * parts.grading)

    @property
    def measures(self) -> dict[int, Measures]:
        """What steps are to be even in, besides arc length, along the loops that stand in for others."""
        measures = {k: ring.along for k, ring in self.rings.items()}
        measures |= {k: _measure(cut) for k, cut in self.cuts.items()}
        if self.near is not None:
            ends = np.array([0.0, self.near.circle.length])
            measures[0] = Measures(ends, ends[None])
        return measures

    def rows(self, layers: Ring | Strip) -> int:
        """Return the layers of a ring or a strip."""
        return self.settings.rows(float(layers.thickness.max()))

    def attached_cells(self, chords: Chords, counts: Indices) -> int:
        """Return the cells of layers and of the rows to the far field, for counts (chords,)."""
        along = np.zeros(len(self.rest.loops), dtype=np.intp)
        places, total = chords.layout.mesh.places, 0
        for edge in np.flatnonzero(chords.wall):
            nodes, cells = chords.edges[edge], int(counts[chords.chord[edge]])
            number = int(places.loop[nodes[0]])
            along[number] += cells
            if number in self.cuts:
                cut = self.cuts[number]
                on = cut.front_at(float(places.arc[nodes[len(nodes) // 2]]))
                total += cells * self.rows(cut.layers[on]) if on is not None else 0
        total += sum(int(along[number]) * self.rows(ring) for number, ring in self.rings.items())
        if self.near is not None:
            first = 2.0 * np.pi * self.near.radius / max(int(along[0]), 1)
            total += int(along[0]) * self.near.cells(first, multiple=self.settings.multiple)
        return total


def rings_around(domain: Domain, loops: Sequence[int], settings: LayerSettings) -> dict[int, Ring]:
    """Return the rings around some loops of a domain, by number.

    Raises InputError: no room for layers; a wall that they fold at.
    """
    return {k: march_ring(domain, domain.loops[k], settings.first, *_sizes(domain, k)) for k in loops}


def _sizes(domain: Domain, number: int) -> tuple[float, float]:
    """Return the thickness of layers at a loop, and the length of the longest cells along it."""
    loop = domain.loops[number]
    thickness = THICKNESS * loop.length
    if number == 0:
        around = sum(each.length for each in domain.loops)
        thickness = min(thickness, INNER_THICKNESS * 2.0 * domain.area / around)
    return thickness, loop.length / COLUMNS


def _measure(cut: CutLoop[Strip]) -> Measures:
    """Return arc lengths of a cut loop, and what rises with them: those of walls where there are fronts."""
    arcs, rise = [np.zeros(1)], [np.zeros(1)]
    for k, strip in enumerate(cut.layers):
        index, wall = strip.along_wall
        begin = cut.span(k)[0]
        gap = begin - arcs[-1][-1]
        arcs.append(cut.front_arcs(k, index))
        rise.append(rise[-1][-1] + gap + wall)
    arcs.append(np.array([cut.loop.length]))
    rise.append(rise[-1][-1:] + cut.loop.length - arcs[-2][-1])
    at, value = np.concatenate(arcs), np.concatenate(rise)
    keep = np.concatenate([[True], np.diff(at) > 1e-12 * cut.loop.length])
    return Measures(at[keep], np.stack([at[keep], value[keep]]))


def wanted_counts(
    walls: WallLayers, chords: Chords, cells: int, size: float
) -> tuple[Indices, int, int, SizeMetric]:
    """Return coarse counts (chords,), and the sizes that they follow.

    Between these by how much counts are multiplied before cells are optimised, and after.
    """
    multiple = walls.settings.multiple
    low, high = math.log(0.1), math.log(8.0)
    wanted = WantedCounts(chords, walls.metric(1.0))
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        metric = walls.metric(math.exp(middle), 0.0 if cells else size)
        counts = wanted.counts(metric, multiple)
        total = chords.cells(counts) + walls.attached_cells(chords, counts)
        low, high = (middle, high) if total > cells else (low, middle)
    times = 1
    while chords.cells(counts) / times**2 > MOST_OPTIMISED:
        times += 1
    while times % multiple and multiple % times:  # either divides the other
        times -= 1
    stride = max(multiple // times, 1)
    counts = np.round(counts / (times * stride)).astype(np.intp)
    return np.maximum(chords.least, counts), stride, times, metric
