"""Grids of blocks with layers at walls: rings around them, blocks between the rings, rows to a far field.

::

    walls --march--> rings    fronts, near field --decompose--> layout --counts, optimum--> fine layout
                       |                                                                         |
                       +------------------ columns at the nodes of the fronts -------------------+--> whole
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.attach import attach
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.decompose import Timings
from meshonet.solvers.blocking.even_loops import Measure, evened_loops
from meshonet.solvers.blocking.even_rows import evened_rows, guarded
from meshonet.solvers.blocking.feature_sizes import feature_sizes
from meshonet.solvers.blocking.layer_rows import LayerSettings, heights_inside, ring_metric, ring_rows
from meshonet.solvers.blocking.near_field import NearField
from meshonet.solvers.blocking.outside import found_outside, taken_outside
from meshonet.solvers.blocking.refine import multiplied, refine
from meshonet.solvers.blocking.respace import respaced
from meshonet.solvers.blocking.rings import Ring, march_ring
from meshonet.solvers.blocking.size_metric import SizeMetric
from meshonet.solvers.energy.quads import optimise

COLUMNS = 140
"""Cells around a loop, if all were as long as the longest."""
THICKNESS = 0.018
"""Thickness of a ring where there is room, in lengths of its loop."""
MOST_OPTIMISED = 4000
"""Cells that are optimised at the most; finer grids are splines through these."""
ITERATIONS, STRIDING = 120, 60
FEW_ITERATIONS = 10
NEAR_FOLDS = 5
"""Cells around folded ones that are optimised with them."""
RESPACED_SINE = 0.1
"""Of angles, that no node that is placed anew across layers may make smaller."""
FREE = 2
"""Optimisations, each with the sizes at the nodes of the one before, before one with fronts held."""
EVEN = float(np.log(1.2))
"""Logarithm of the ratio by which neighbouring cells along fronts may differ."""
MARGIN = 1.1
"""By how much cells may differ in the end, in logarithms, over the growth of layers."""
_BISECTIONS = 12
_PARTS = (0.2, 0.5, 0.8)  # of edges, where sizes are looked at


@dataclass(frozen=True, eq=False)
class Rings:
    """Walls with their layers, and the domain that is left.

    `rings` are by number of their loop, which is the same in both domains; `near` stands in for a distant
    outer loop.
    """

    domain: Domain
    rings: Mapping[int, Ring]
    near: NearField | None
    rest: Domain
    settings: LayerSettings

    @classmethod
    def around(cls, domain: Domain, loops: list[int], settings: LayerSettings) -> Rings:
        """Return the rings around some loops of a domain.

        Raises InputError: no room for layers; a wall that they fold at.
        """
        rings = {}
        for number in loops:
            loop = domain.loops[number]
            thickness, largest = THICKNESS * loop.length, loop.length / COLUMNS
            rings[number] = march_ring(domain, loop, settings.first, thickness, largest)
        near = None if 0 in rings else NearField.of(domain)
        left = [near.circle if near else domain.loops[0], *domain.loops[1:]]
        rest = [rings[k].front if k in rings else loop for k, loop in enumerate(left)]
        return cls(domain, rings, near, Domain(tuple(rest), domain.name), settings)

    @cached_property
    def _metric(self) -> SizeMetric:
        if not self.rings:
            return feature_sizes(self.rest)
        return SizeMetric.joined([ring_metric(ring, self.settings) for ring in self.rings.values()])

    def metric(self, scale: float, size: float = 0.0) -> SizeMetric:
        """Return the sizes of cells outside the rings: at most `size`, or `scale` times their columns."""
        if size:
            along = self._metric.along * max(size / self._metric.along.max(), 1.0) ** 0.5
            return replace(self._metric, along=np.minimum(along, size), largest=size)
        largest = self.rest.extent / 12.0 * scale**0.5
        return replace(self._metric, along=scale * self._metric.along, largest=largest)

    @property
    def measures(self) -> dict[int, Measure]:
        """What steps are to be even in, besides arc length, along the loops that stand in for others."""
        measures = {k: ring.along_wall for k, ring in self.rings.items()}
        if self.near is not None:
            measures[0] = (np.array([0.0, self.near.circle.length]),) * 2
        return measures

    def rows(self, ring: Ring) -> int:
        """Return the layers of a ring."""
        thickness = np.hypot(*np.diff(ring.levels, axis=1).transpose(2, 0, 1)).sum(axis=1)
        return self.settings.rows(float(thickness.max()))

    def attached_cells(self, chords: Chords, counts: Indices) -> int:
        """Return the cells of rings and of the rows to the far field, for counts (chords,)."""
        along = np.zeros(len(self.rest.loops), dtype=np.intp)
        places = chords.layout.mesh.places
        for edge in np.flatnonzero(chords.wall):
            along[places.loop[chords.edges[edge][0]]] += counts[chords.chord[edge]]
        total = sum(int(along[number]) * self.rows(ring) for number, ring in self.rings.items())
        if self.near is not None:
            first = 2.0 * np.pi * self.near.radius / max(int(along[0]), 1)
            total += int(along[0]) * self.near.cells(first, multiple=self.settings.multiple)
        return total


def layered(
    domain: Domain, loops: list[int], settings: LayerSettings, *, cells: int = 0, cell_size: float = 0.0,
    layout: Layout | None = None, timings: Timings | None = None,
) -> Layout:  # fmt: skip
    """Return a fine layout of about so many cells, with layers at some loops of a domain.

    Without `cells`, none away from walls is longer than `cell_size`. `layout` is to be taken instead of one
    that is found: of a domain like it outside layers like these, or of the whole of it.
    Raises InputError, BlockingError; NoValidGridError: cells stay folded.
    """
    timings = timings or Timings()
    with timings.stage("layers"):
        rings = Rings.around(domain, loops, settings)
    if layout is None:
        layout = found_outside(rings.rest, rings.rings, timings)
    else:
        layout = taken_outside(layout, rings.rest, rings.rings)
    for even in (True, False):  # nodes that are moved to make cells grow evenly may fold them
        try:
            return _whole(rings, layout, (cells, cell_size), timings, even)
        except NoValidGridError as error:
            problem = error
    raise problem


def _whole(rings: Rings, layout: Layout, size: tuple[int, float], timings: Timings, even: bool) -> Layout:
    """Return the fine layout, its cells evened along fronts or not."""
    fine = _outside(rings, layout, size, timings, even)
    with timings.stage("layers"):
        return _joined(rings, fine)


def _outside(rings: Rings, layout: Layout, size: tuple[int, float], timings: Timings, even: bool) -> Layout:
    """Return the fine layout outside the rings, optimised."""
    chords = Chords.of(layout)
    with timings.stage("refine"):
        counts, stride, times, metric = wanted_counts(rings, chords, *size)
        coarse = refine(layout, counts, chords)
    with timings.stage("optimum"):
        if stride > 1:
            with suppress(NoValidGridError):  # so few cells may stay folded, and more not
                coarse = _optimised(coarse, metric, STRIDING)
            coarse = multiplied(coarse, stride)
        for _ in range(FREE):
            coarse = _optimised(coarse, metric, ITERATIONS)
        if even:
            coarse = evened_loops(coarse, rings.measures, times * EVEN)
            on = np.isin(coarse.mesh.places.loop, list(rings.measures))
            coarse = _optimised(coarse, metric, ITERATIONS, on)
    with timings.stage("refine"):
        fine = multiplied(coarse, times)
        fine = unfolded(fine, np.isin(fine.mesh.places.loop, list(rings.measures)))
        moved = evened_loops(fine, rings.measures, EVEN) if even else fine
        return moved if smallest_corner(moved.mesh) > 0.0 else fine


def _optimised(
    layout: Layout, metric: SizeMetric, iterations: int, held: NDArray[np.bool_] | None = None
) -> Layout:
    """Return a layout with its nodes optimised for some sizes; `held` (n,) stay."""
    mesh = layout.mesh
    optimum = optimise(
        mesh, iterations=iterations, targets=metric.edges(mesh), aspects=metric.aspects(mesh), held=held
    )
    if not optimum.valid:
        raise NoValidGridError("cells outside the layers stay folded")
    return replace(layout, mesh=optimum.mesh)


def unfolded(layout: Layout, held: NDArray[np.bool_]) -> Layout:
    """Return the layout with nodes near folded cells, but for `held` (n,) ones, moved to unfold them."""
    mesh = layout.mesh
    bad = corner_jacobians(mesh) <= 0.0
    if not bad.any():
        return layout
    free = np.zeros(len(mesh.nodes), dtype=bool)
    free[mesh.quads[bad]] = True
    for _ in range(NEAR_FOLDS):
        free[mesh.quads[free[mesh.quads].any(axis=1)]] = True
    optimum = optimise(mesh, iterations=FEW_ITERATIONS, held=held | ~free)
    return replace(layout, mesh=optimum.mesh) if optimum.valid else layout


def wanted_counts(
    rings: Rings, chords: Chords, cells: int, size: float
) -> tuple[Indices, int, int, SizeMetric]:
    """Return coarse counts (chords,), and the sizes that they follow.

    Between these by how much counts are multiplied before cells are optimised, and after.
    """
    multiple = rings.settings.multiple
    low, high = np.log(0.1), np.log(8.0)
    wanted = _Wanted(chords, rings.metric(1.0))
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        metric = rings.metric(float(np.exp(middle)), 0.0 if cells else size)
        counts = wanted.counts(metric, multiple)
        total = chords.cells(counts) + rings.attached_cells(chords, counts)
        low, high = (middle, high) if total > cells else (low, middle)
    times = 1
    while chords.cells(counts) / times**2 > MOST_OPTIMISED:
        times += 1
    while times % multiple and multiple % times:  # either divides the other
        times -= 1
    stride = max(multiple // times, 1)
    counts = np.round(counts / (times * stride)).astype(np.intp)
    return np.maximum(chords.least, counts), stride, times, metric


class _Wanted:
    """What edges of chords want, for any sizes at the same points."""

    def __init__(self, chords: Chords, metric: SizeMetric) -> None:
        self.chords = chords
        nodes = chords.layout.mesh.nodes
        start = nodes[np.concatenate([edge[:-1] for edge in chords.edges])]
        step = nodes[np.concatenate([edge[1:] for edge in chords.edges])] - start
        self.length = np.hypot(*step.T)
        self.near = [metric.near(start + part * step, step) for part in _PARTS]
        self.first = np.cumsum([0, *(len(edge) - 1 for edge in chords.edges)])[:-1]

    def counts(self, metric: SizeMetric, multiple: int = 1) -> Indices:
        """Return counts (chords,), multiples near what edges want: its geometric mean, by length."""
        parts = [self.length / near.length(metric.across, metric.along, metric.largest) for near in self.near]
        chords = self.chords
        wanted = np.add.reduceat(np.mean(parts, axis=0), self.first)
        weight = np.bincount(chords.chord, wanted, chords.count)
        mean = np.bincount(chords.chord, wanted * np.log(np.maximum(wanted, 1e-9)), chords.count) / weight
        return multiple * np.maximum(chords.least, np.round(np.exp(mean) / multiple).astype(np.intp))


def _joined(rings: Rings, outside: Layout) -> Layout:
    """Return the layout with the layers, and the rows to a distant outer loop, attached."""
    rows = [
        ring_rows(
            outside.mesh, number, ring, rings.rows(ring), rings.settings, heights_inside(outside, number)
        )
        for number, ring in rings.rings.items()
    ]
    if rings.near is not None:
        multiple = rings.settings.multiple
        rows.append(rings.near.rows(outside.mesh, heights_inside(outside, 0), multiple=multiple))
    whole = attach(outside, rings.domain, rows)
    respaced_nodes = respaced(whole, rings.settings).mesh.nodes
    nodes = guarded(whole.mesh.nodes, respaced_nodes - whole.mesh.nodes, whole.mesh, RESPACED_SINE)
    whole = replace(whole, mesh=whole.mesh.with_nodes(nodes))
    whole = evened_rows(whole, MARGIN * float(np.log(rings.settings.growth)), rings.settings.constant)
    held = np.zeros(len(nodes), dtype=bool)
    for number in whole.layers:
        block = whole.blocks[number]
        held[block[:, : 2 * block.shape[1] // 3]] = True
    whole = unfolded(whole, held)
    corners = corner_jacobians(whole.mesh)
    if corners.min() <= 0.0:
        x, y = whole.mesh.nodes[whole.mesh.quads[int(corners.argmin())]].mean(axis=0)
        raise NoValidGridError(f"layers or cells beside them are folded at ({x:.6g}, {y:.6g})")
    return whole


def smallest_corner(mesh: QuadMesh) -> float:
    """Return the smallest Jacobian, of parallelograms at corners, of the quads of a mesh."""
    return float(corner_jacobians(mesh).min())


def corner_jacobians(mesh: QuadMesh) -> Floats:
    """Return the smallest corner Jacobian (m,) of each quad of a mesh."""
    z = mesh.nodes[mesh.quads]
    edge = np.roll(z, -1, axis=1) - z
    before = np.roll(edge, 1, axis=1)
    return np.asarray((before[..., 0] * edge[..., 1] - before[..., 1] * edge[..., 0]).min(axis=1))
