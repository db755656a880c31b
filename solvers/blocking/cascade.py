"""Grids of a cascade: layers around the blade, blocks of its passage, rows to inlet and outlet.

::

    blade --march--> ring    front, pitch --map--> template --counts, optimum--> fine layout
                      |                                                               |
                      +--- columns at the nodes of the front, straight rows ----------+--> whole
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.attach import Rows, loop_nodes
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.decompose import Timings
from meshonet.solvers.blocking.feature_sizes import feature_sizes
from meshonet.solvers.blocking.layer_rows import LayerSettings, heights_inside, ring_metric, ring_rows
from meshonet.solvers.blocking.layered import smallest_corner
from meshonet.solvers.blocking.passage import BLADE, INLET, OUTLET, Passage, extended, laid_out, turned_round
from meshonet.solvers.blocking.passage_map import complex_of, pairs_of
from meshonet.solvers.blocking.passage_template import cut_of, template
from meshonet.solvers.blocking.refine import multiplied, refine
from meshonet.solvers.blocking.respace import respaced
from meshonet.solvers.blocking.rings import Ring, march_ring
from meshonet.solvers.blocking.size_metric import SizeMetric
from meshonet.solvers.energy.quads import optimise

THICKNESS, COLUMNS = 0.018, 140
"""Thickness of the layers and cells around the blade, by its length around, where there is room."""
ACROSS = 12.0
"""Cells in a pitch at the least, where nothing is near, before counts are made up to what was asked for."""
MOST_OPTIMISED = 4000
"""Cells that are optimised at the most; finer grids are splines through these."""
FIRST, ITERATIONS, PASSES = 150, 120, 2
ROW_GROWTH = 1.1
"""Ratio of neighbouring cells on the way to inlet and outlet."""
SHORTEST = 0.08
"""Pitches between blade, with its layers, and inlet or outlet at the least."""
_BISECTIONS = 14
_PARTS = (0.2, 0.5, 0.8)  # of edges, where sizes are looked at


@dataclass(frozen=True)
class Cascade:
    """A row of blades.

    Parameters
    ----------
    blade : the passage on its left.
    pitch : vector from a blade to the next.
    inlet, outlet : lengths of the passage before and behind the blade, in axial chords.
    settings : of the layers at the blade, if there are any.
    name : of the blade.
    """

    blade: Loop
    pitch: tuple[float, float]
    inlet: float = 1.0
    outlet: float = 1.0
    settings: LayerSettings | None = None
    name: str = ""

    @property
    def opposite(self) -> bool:
        """Whether the pitch leads to the blade on the right of the flow, which is one of rising x."""
        return self.pitch[1] < 0.0 or (self.pitch[1] == 0.0 and self.pitch[0] > 0.0)

    @property
    def left(self) -> complex:
        """Vector to the next blade on the left of the flow."""
        pitch = complex(*self.pitch)
        return -pitch if self.opposite else pitch

    @cached_property
    def blades(self) -> Domain:
        """The blade and its neighbours on both sides."""
        shift = pairs_of(np.array([-self.left, self.left]))
        curve = self.blade.curve
        beside = [_moved(self.blade, curve, each) for each in shift]
        return Domain((self.blade, *beside), self.name)

    @cached_property
    def ring(self) -> Ring | None:
        """The layers around the blade."""
        if self.settings is None:
            return None
        length = self.blade.length
        return march_ring(self.blades, self.blade, self.settings.first, THICKNESS * length, length / COLUMNS)

    @cached_property
    def ends(self) -> tuple[float, float]:
        """Lengths from the front to inlet and outlet."""
        axis = self.left / (1j * abs(self.left))
        axial = (complex_of(self.blade.curve.points) * np.conj(axis)).real
        around = axial if self.ring is None else (complex_of(self.ring.front.curve.points) * np.conj(axis)).real
        chord = float(np.ptp(axial))
        before = self.inlet * chord - float(axial.min() - around.min())
        behind = self.outlet * chord - float(around.max() - axial.max())
        for length, name, given in ((before, "inlet", self.inlet), (behind, "outlet", self.outlet)):
            least = SHORTEST * abs(self.left)
            if length < least:
                enough = given + 1.01 * (least - length) / chord
                problem = f"{given:g} axial chords leave no room for blocks beside the blade"
                raise InputError(problem, f"use {enough:.2g} or more", parameter=name)
        return before, behind

    @cached_property
    def passage(self) -> Passage:
        """The passage around the blade or its layers."""
        front = self.blade if self.ring is None else self.ring.front
        return Passage.around(front, self.left, *self.ends, self.name)

    @cached_property
    def rows_of_layers(self) -> int:
        """Rows of cells in the layers."""
        if self.ring is None or self.settings is None:
            return 0
        thickness = np.hypot(*np.diff(self.ring.levels, axis=1).transpose(2, 0, 1)).sum(axis=1)
        return self.settings.rows(float(thickness.max()))

    @cached_property
    def metric(self) -> SizeMetric:
        """Sizes of cells outside the layers, in the plane of the passage's map."""
        if self.ring is None or self.settings is None:
            sizes = feature_sizes(self.blades)
        else:
            sizes = ring_metric(self.ring, self.settings)
        to = self.passage.map
        points = to.forward(sizes.points)
        turn = to.derivative(points)
        normals = pairs_of(complex_of(sizes.normals) * turn / np.abs(turn))
        largest = abs(self.left) / ACROSS
        return replace(sizes, points=points, normals=normals, largest=largest, scale=to.stretching)

    def scaled(self, scale: float) -> SizeMetric:
        """Return sizes of cells `scale` times as long along the blade."""
        metric = self.metric
        across = metric.across if self.ring is not None else scale * metric.across
        return replace(metric, across=across, along=scale * metric.along, largest=metric.largest * scale**0.5)


def _moved(blade: Loop, curve: Curve, shift: Floats) -> Loop:
    points = curve.points + shift
    return Loop(Curve(points, closed=True, corners=curve.corner_index), blade.corners, blade.names)


def cascade_layout(
    cascade: Cascade, *, cells: int | None = None, cell_size: float | None = None,
    timings: Timings | None = None,
) -> Layout:  # fmt: skip
    """Return a fine layout of a passage of about so many `cells`, or of cells of a size away from the blade.

    Its outer loop is named periodic1, outlet, periodic2 and inlet; nodes of periodic2 are those of periodic1
    moved by the pitch. Raises InputError: no room for layers, inlet or outlet; NoValidGridError: folds.
    """
    timings = timings or Timings()
    with timings.stage("layers"):
        passage = cascade.passage
    with timings.stage("first optimum"):
        coarse = template(passage)
        coarse = _optimised(coarse, FIRST, None)
    with timings.stage("refine"):
        chords = Chords.of(coarse)
        counts, times, metric = _counts(cascade, chords, cells, cell_size)
        coarse = refine(coarse, counts, chords)
    with timings.stage("optimum"):
        for _ in range(PASSES):
            coarse = _optimised(coarse, ITERATIONS, metric)
    with timings.stage("refine"):
        fine = multiplied(coarse, times)
        flat = laid_out(fine, passage, cut_of(fine))
    with timings.stage("layers"):
        rows = _rows(cascade, flat.layout, metric)
        whole = extended(flat, passage, cascade.blade, rows)
        if cascade.settings is not None:
            whole = respaced(whole, cascade.settings)
    if smallest_corner(whole.mesh) <= 0.0:
        raise NoValidGridError("cells of the passage are folded")
    return turned_round(whole) if cascade.opposite else whole


def _optimised(layout: Layout, iterations: int, metric: SizeMetric | None) -> Layout:
    targets = metric.edges(layout.mesh) if metric else None
    optimum = optimise(layout.mesh, iterations=iterations, targets=targets)
    if not optimum.valid:
        raise NoValidGridError("cells of the passage stay folded")
    return replace(layout, mesh=optimum.mesh)


def _rows(cascade: Cascade, layout: Layout, metric: SizeMetric) -> list[Rows]:
    """Return the layers, and the straight rows to inlet and outlet."""
    mesh, passage, rows = layout.mesh, cascade.passage, []
    if cascade.ring is not None and cascade.settings is not None:
        inner = heights_inside(layout, BLADE)
        rows.append(ring_rows(mesh, BLADE, cascade.ring, cascade.rows_of_layers, cascade.settings, inner))
    axis = np.array([passage.map.axis.real, passage.map.axis.imag])
    for number, length, way in _straight(cascade):
        if length > 0.0:
            start = mesh.nodes[loop_nodes(mesh, number)]
            steps = _steps(float(np.exp(np.log(heights_inside(layout, number)).mean())), length, metric.largest)
            nodes = start[:, None] + steps[:, None] * (way * axis)
            rows.append(Rows(number, nodes, np.zeros(len(start)), False))
    return rows


def _straight(cascade: Cascade) -> list[tuple[int, float, float]]:
    """Return loop, length and direction of the rows to inlet and outlet."""
    passage = cascade.passage
    axial = passage.map.axial(passage.front.curve.points)
    before = cascade.ends[0] - float(axial.min() - passage.inlet)
    behind = cascade.ends[1] - float(passage.outlet - axial.max())
    some = 1e-6 * abs(cascade.left)
    return [(INLET, before if before > some else 0.0, -1.0), (OUTLET, behind if behind > some else 0.0, 1.0)]


def _steps(first: float, length: float, largest: float) -> Floats:
    """Return distances from 0 to a length, of cells that grow from `first` to about `largest`."""
    cells = [min(first * ROW_GROWTH**0.5, length)]
    while sum(cells) < length - 0.5 * cells[-1]:
        cells.append(max(min(cells[-1] * ROW_GROWTH, largest), cells[0]))
    steps = np.concatenate([[0.0], np.cumsum(cells)]) * (length / sum(cells))
    steps[-1] = length
    return np.asarray(steps)


def _counts(
    cascade: Cascade, chords: Chords, cells: int | None, cell_size: float | None
) -> tuple[Indices, int, SizeMetric]:
    """Return coarse counts (chords,), by how much they are multiplied, and the sizes that they follow."""
    wanted = _Wanted(chords, cascade.metric)
    if cell_size is not None:
        sizes = np.minimum(cascade.metric.across, cell_size)
        metric = replace(cascade.metric, across=sizes, along=sizes, largest=cell_size)
        counts = wanted.counts(metric)
    else:
        low, high = np.log(0.05), np.log(20.0)
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            metric = cascade.scaled(float(np.exp(middle)))
            counts = wanted.counts(metric)
            total = chords.cells(counts) + _attached_cells(cascade, chords, counts, metric)
            low, high = (middle, high) if total > (cells or 0) else (low, middle)
    times = 1
    while chords.cells(counts) / times**2 > MOST_OPTIMISED:
        times += 1
    return np.maximum(chords.least, np.round(counts / times).astype(np.intp)), times, metric


def _attached_cells(cascade: Cascade, chords: Chords, counts: Indices, metric: SizeMetric) -> int:
    """Return the cells of the layers and of the rows to inlet and outlet."""
    along = np.zeros(3, dtype=np.intp)
    mesh = chords.layout.mesh
    for edge in np.flatnonzero(chords.wall):
        along[mesh.places.loop[chords.edges[edge][0]]] += counts[chords.chord[edge]]
    total = int(along[BLADE]) * cascade.rows_of_layers
    for number, length, _ in _straight(cascade):
        if length > 0.0:
            total += int(along[number]) * (len(_steps(abs(cascade.left) / along[number], length, metric.largest)) - 1)
    return total


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

    def counts(self, metric: SizeMetric) -> Indices:
        """Return counts (chords,): the mean, by length, of the logarithms of what edges want."""
        parts = [self.length / near.length(metric.across, metric.along, metric.largest) for near in self.near]
        chords = self.chords
        wanted = np.add.reduceat(np.mean(parts, axis=0), self.first)
        weight = np.bincount(chords.chord, wanted, chords.count)
        mean = np.bincount(chords.chord, wanted * np.log(np.maximum(wanted, 1e-9)), chords.count) / weight
        return np.maximum(chords.least, np.round(np.exp(mean)).astype(np.intp))
