"""Walls with their layers, the remaining domain, and the numbers of cells in it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.cached import cached_property
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import wall_points
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.spacing.gradual_sizes import graded
from meshonet.kernels._native import nearest_points
from meshonet.solvers.blocking.chord_cells import WantedCounts
from meshonet.solvers.blocking.decomposition.side_counts import nearer, suited
from meshonet.solvers.blocking.decomposition.symmetry.images import images_of, made_symmetric
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import Mirror, mirrors_of
from meshonet.solvers.blocking.layers.layer_rows import ring_metric
from meshonet.solvers.blocking.layers.marched import GAP_PART
from meshonet.solvers.blocking.layers.near_field import NearField
from meshonet.solvers.blocking.layers.rings import (
    COLUMNS,
    THICKNESS,
    Ring,
    march_ring,
    mirrored,
    room_between,
)
from meshonet.solvers.blocking.layers.row_sizes import RowSizes
from meshonet.solvers.blocking.layers.stretches import Stretch
from meshonet.solvers.blocking.layers.wall_rows import WallRows
from meshonet.solvers.layers.even_line import Measures
from meshonet.solvers.layers.layer_settings import LayerSettings
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.size_metric import SizeMetric

INNER_THICKNESS = 0.075  # of layers inside an outer loop, in hydraulic diameters: 4 * area / perimeter
MOST_OPTIMISED = 4000  # cells that are optimised directly; finer grids are splines through these
ROWS = 3  # number of cells across a row of layers during the optimisation
_MARCHES = 4  # largest number of marches of rings that are too close to each other
_BISECTIONS = 14  # of a range of 240 to 1: the scale to 0.03 %


@dataclass(frozen=True, eq=False)
class WallLayers:
    """The layers at the walls of a domain, and the remaining domain, which is decomposed into blocks."""

    domain: Domain
    rings: Mapping[int, Ring]  # layers around whole loops, by the index of the loop
    near: NearField | None  # the circle that replaces a distant outer loop
    rest: Domain  # the remaining domain, with the same indices of loops
    settings: LayerSettings
    stretches: tuple[Stretch, ...] = ()  # parts of loops whose layers are rows of blocks of the layout
    sharp: tuple[int, ...] = ()  # indices of loops with rows of blocks around them and along their wakes
    sizes: Mapping[int, RowSizes] = field(default_factory=dict)  # at rows of blocks, by index of the loop

    @classmethod
    def of(
        cls, domain: Domain, loops: Sequence[int], settings: LayerSettings,
        stretches: Sequence[Stretch] = (), sharp: Sequence[int] = (),
    ) -> Self:  # fmt: skip
        """Return the layers of a domain.

        Layers around `loops` (indices) are marched. Layers along `stretches` (parts of loops) and around the
        loops `sharp` (indices) are rows of blocks. The latter loops have a sharp edge; their rows continue on
        both sides of the wake. Raises InputError if there is too little room, or if layers fold.
        """
        rings = rings_around(domain, loops, settings)
        numbers = sorted({*sharp, *(stretch.loop for stretch in stretches)})
        outer = 0 in rings or 0 in numbers or domain.periodic
        near = None if outer else NearField.of(domain)
        rest = list(domain.loops)
        if near is not None:
            rest[0] = near.circle
        for k, ring in rings.items():
            rest[k] = ring.front
        left = replace(domain, loops=tuple(rest), notes=())
        sizes = {k: RowSizes.of(left, k, [s for s in stretches if s.loop == k], settings) for k in numbers}
        for each in sizes.values():
            each.check_room()
        return cls(domain, rings, near, left, settings, tuple(stretches), tuple(sharp), sizes)

    @cached_property
    def mirrors(self) -> tuple[Mirror, ...]:
        """Mirror symmetries of the region outside the layers; empty if the domain is not symmetric."""
        return mirrors_of(self.rest) if mirrors_of(self.domain) else ()

    def of_ring(self, number: int) -> LayerSettings:
        """Return the settings of the layers around loop `number`."""
        return self.settings.at(self.domain.loops[number].names)

    @cached_property
    def of_rows(self) -> tuple[LayerSettings, ...]:
        """Settings of each row of blocks with layers: first those around sharp edges, then the others."""
        loops = self.domain.loops
        names = [loops[k].names for k in self.sharp] + [s.names(loops[s.loop]) for s in self.stretches]
        return tuple(map(self.settings.at, names))

    def symmetric(self, layout: Layout) -> Layout:
        """Return `layout` with its nodes made symmetric about `mirrors`, if its connectivity is symmetric."""
        return replace(layout, mesh=made_symmetric(layout.mesh, images_of(layout.mesh, self.mirrors)))

    def is_free(self, number: int, mesh: QuadMesh, wake: Sequence[int]) -> bool:
        """Return whether a wake reaches the outer loop and has room for layers along its whole length.

        `wake` has the indices of the wake's nodes in `mesh`, beginning at the sharp edge of loop `number`.
        """
        return bool(mesh.places.loop[wake[-1]] == 0) and self.has_room(number, mesh.nodes[wake])

    def has_room(self, number: int, wake: Floats, scale: float = 1.0) -> bool:
        """Return whether other bodies leave room for layers along the `wake` (k, 2) of loop `number`."""
        others = [loop for k, loop in enumerate(self.rest.loops) if k not in (0, number)]
        if not others:
            return True
        gap = np.sqrt(nearest_points(np.ascontiguousarray(wake), wall_points(others))[1])
        thick = self.sizes[number].thickness_behind(np.hypot(*(wake - wake[0]).T), scale, self.settings)
        return bool((thick < GAP_PART * gap).all())

    @cached_property
    def _ring_metrics(self) -> list[SizeMetric]:
        return [ring_metric(ring, self.of_ring(k)) for k, ring in self.rings.items()]

    def _at_rings(self, scale: float) -> list[SizeMetric]:
        """Return the sizes of cells beyond rings, with gradual lengths along them multiplied by `scale`."""
        parts = []
        for ring, each in zip(self.rings.values(), self._ring_metrics, strict=True):
            along = scale * each.along
            if scale > 1.0:
                front = ring.front
                along = graded(along, front.curve.knots, front.length, self.settings.grading)
            parts.append(replace(each, along=along))
        return parts

    def metric(
        self, scale: float, size: float = 0.0, wakes: Mapping[int, Floats] | None = None
    ) -> SizeMetric:
        """Return the target cell sizes outside the layers.

        Next to layers, they are `scale` times the cell lengths along the wall. `scale` is ignored if `size`,
        the largest cell size, is given. `wakes` has the nodes (k, 2) of the wake behind each loop with a
        sharp edge, by the index of the loop.
        """
        scale = 1.0 if size else scale
        parts = [sizes.metric(scale, self.settings) for sizes in self.sizes.values()]
        for loop, wake in (wakes or {}).items():
            parts.append(self.sizes[loop].wake_metric(wake, scale, self.settings))
        if self.rings:
            parts.append(SizeMetric.joined(self._at_rings(scale)))  # one part: the nearest ring counts
        metric = SizeMetric.joined(parts)
        if size:
            along = metric.along * max(size / metric.along.max(), 1.0) ** 0.5
            return replace(metric, along=np.minimum(along, size), largest=size)
        finer = min(scale, 1.0)  # like sizes at walls, so that growth per cell is independent of their number
        grading = min(metric.grading, self.settings.grading * max(scale, 1.0))  # with few cells, no less
        largest = self.rest.extent / 12.0 * scale**0.5
        return replace(metric, largest=largest, grading=finer * grading)

    @property
    def measures(self) -> dict[int, Measures]:
        """Arc lengths along loops, by loop index; nodes are moved so that steps between them grow slowly."""
        measures = {k: ring.along for k, ring in self.rings.items()}
        if self.near is not None:
            ends = np.array([0.0, self.near.circle.length])
            measures[0] = Measures(ends, ends[None])
        return measures

    def ring_rows(self, number: int) -> int:
        """Return the number of layers in the ring around loop `number`."""
        return self.of_ring(number).rows(float(self.rings[number].thickness.max()))

    def attached_cells(self, chords: Chords, counts: Indices) -> int:
        """Return the number of cells in layers around loops, plus those from the blocks to a far field.

        `counts` (chords,) are the cells along the edges of each chord (set of opposite edges).
        """
        along = chords.along_loops(counts).tolist()
        total = sum(along[number] * self.ring_rows(number) for number in self.rings)
        if self.near is not None:
            first = 2.0 * np.pi * self.near.radius / max(along[0], 1)
            total += along[0] * self.near.cells(first, self.settings)
        return total


def rings_around(domain: Domain, loops: Sequence[int], settings: LayerSettings) -> dict[int, Ring]:
    """Return the layers around each of the `loops` of a domain, by the index of the loop.

    Raises InputError if there is too little room for layers, or if layers fold at a wall.
    """
    mirrors, rings = mirrors_of(domain), dict[int, Ring]()
    rooms, tight = dict[int, Floats](), dict[int, Floats]()
    for _ in range(_MARCHES):
        before, rings = rings, {}
        for k in loops:
            mirror = next((each for each in mirrors if int(each.loops[k]) in rings), None)
            if mirror is not None:
                image, total = rings[int(mirror.loops[k])], float(mirror.sums[k])
                rings[k] = mirrored(image, domain.loops[k], mirror, total)
            elif before and k not in tight:
                rings[k] = before[k]
            else:
                first = settings.at(domain.loops[k].names).first
                rings[k] = march_ring(
                    domain, k, first, *_sizes(domain, k), mirrors, before.get(k), rooms.get(k)
                )
        tight = room_between(rings)
        if not tight:
            break
        rooms |= {k: np.minimum(room, rooms.get(k, np.inf)) for k, room in tight.items()}
    return rings


def _sizes(domain: Domain, number: int) -> tuple[float, float]:
    """Return the thickness of layers at a loop, and the length of the longest cells along it."""
    loop = domain.loops[number]
    if number > 0:
        return THICKNESS * loop.length, loop.length / COLUMNS
    around = sum(each.length for each in domain.loops)
    return INNER_THICKNESS * 4.0 * domain.area / around, loop.length / COLUMNS


@dataclass(frozen=True, eq=False)
class Counts:
    """Numbers of cells along the chords (sets of opposite block edges) of a layout, and factors on them.

    Parameters
    ----------
    coarse : (chords,) numbers of cells in the first optimisation.
    stride : factor from the first to the second optimisation; 1 without a second.
    times : factor from the last optimisation to the final grid.
    scale : factor on the cell lengths along walls.
    metric : target cell sizes.
    layers : (rows,) factor on the estimated number of layers in each row of blocks.
    """

    coarse: Indices
    stride: int
    times: int
    scale: float
    metric: SizeMetric
    layers: tuple[float, ...] = ()


def wanted_counts(
    walls: WallLayers, rows: WallRows, chords: Chords, cells: int, size: float, before: Counts | None
) -> Counts:
    """Return cell counts of all rows of blocks for about `cells` cells in total.

    If `cells` is 0, `size` is the largest cell size. `before` is the result of the last iteration, if any.
    """
    multiple, row = walls.settings.multiple, rows.of_chords(chords)
    wakes = rows.wakes(chords.layout)
    low, high = math.log(0.05), math.log(12.0)
    wanted = WantedCounts(chords, walls.metric(1.0, wakes=wakes))
    for _ in range(_BISECTIONS):
        scale = math.exp(0.5 * (low + high))
        metric = walls.metric(scale, 0.0 if cells else size, wakes)
        counts = nearer(chords, wanted.counts(metric, multiple), multiple)
        for number, loop in enumerate(rows.loops):
            layers = walls.sizes[loop].rows(scale, walls.of_rows[number])
            counts[row == number] = round(layers * before.layers[number]) if before else layers
        total = chords.cells(counts) + walls.attached_cells(chords, counts)
        low, high = (math.log(scale), high) if total > cells else (low, math.log(scale))
    inner, times = row < 0, 1
    while chords.cells(np.where(inner, counts / times, ROWS)) > MOST_OPTIMISED:
        times += 1
    while times % multiple and multiple % times:  # either divides the other
        times -= 1
    stride = max(multiple // times, 1)
    around = times * stride * chords.multiple
    least = -(-chords.least // chords.multiple)
    coarse = chords.multiple * np.maximum(least, np.round(counts / around).astype(np.intp))
    fixed = {int(chord): ROWS for chord in np.flatnonzero(~inner)}
    coarse = suited(chords, np.where(inner, coarse, ROWS), chords.least, fixed=fixed, named=False)
    return Counts(coarse, stride, times, scale, metric)
