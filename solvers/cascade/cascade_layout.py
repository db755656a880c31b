"""Grids of a cascade: layers around the blade, blocks of its passage, rows to inlet and outlet.

::

    blade --march--> ring    front, pitch --map--> template --counts, optimum--> fine layout
                      |                                                               |
                      +--- columns at the nodes of the front, straight rows ----------+--> whole
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.elementary import log
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.chord_cells import WantedCounts
from meshonet.solvers.blocking.layers.attach import Rows
from meshonet.solvers.blocking.layers.finished import evened
from meshonet.solvers.blocking.layers.layer_rows import heights_inside, ring_rows
from meshonet.solvers.blocking.unfolded import with_more_cells
from meshonet.solvers.cascade.cascade import COARSEST, Cascade, scaled
from meshonet.solvers.cascade.passage import BLADE, INLET, OUTLET, Passage, extended, turned_round
from meshonet.solvers.cascade.templates import Template, first_valid
from meshonet.solvers.energy.quad_problem import smallest_jacobian
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.layers.even_line import EVEN, FEW_STEPS, evened_loops
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.refine import refine
from meshonet.solvers.refinement.size_metric import SizeMetric
from meshonet.solvers.stages import Timings, stage

MOST_OPTIMISED = 4000  # cells that are optimised directly; finer grids are splines through these
CORNERS = ("at first", "later", "nowhere")
"""When nodes are moved to the corners of the blade, in the order of attempts."""
LEAST = 4  # smallest number of cells along the side of an optimised block
FIRST, ITERATIONS, PASSES = 150, 120, 2  # iterations of the template and of each sized optimum; their number
WEIGHTS = 0.95, 1e-3  # weights w and β of the functional; with a smaller β rounding errors move nodes by 1 %
ROW_GROWTH = 1.1  # growth ratio of cells towards inlet and outlet
_BISECTIONS = 14  # of a range of 400 to 1: the scale to 0.04 %


def cascade_layout(
    cascade: Cascade, *, cells: int | None = None, cell_size: float | None = None,
    timings: Timings | None = None,
) -> Layout:  # fmt: skip
    """Return a fine layout of a passage with about `cells` cells, or cells of `cell_size` far from the blade.

    The outer loop consists of periodic1, outlet, periodic2 (periodic1 moved by the pitch) and inlet. Raises
    InputError if there is too little room for layers, inlet or outlet, or if far more cells are needed than
    requested. Raises NoValidGridError if cells are folded.
    """
    timings = {} if timings is None else timings
    cascade.check_reach(cells, cell_size)
    with stage("layers", timings):
        passage = cascade.passage

    def outside(template: Template, corners: str) -> tuple[Layout, int, SizeMetric]:
        return _outside(cascade, passage, template, corners, cells, cell_size, timings)

    coarse, times, metric = first_valid(outside, CORNERS)
    with stage("refine", timings):
        fine = with_more_cells(coarse, times)
        fine = evened_loops(fine, cascade.measures, EVEN, FEW_STEPS)
    with stage("layers", timings):
        rows = _rows(cascade, fine, metric)
        whole = extended(fine, passage, cascade.blade, rows)
        whole = evened(whole, cascade.layers)
    if smallest_jacobian(whole.mesh.nodes, whole.mesh.quads) <= 0.0:
        raise NoValidGridError("cells of the passage are folded; use more {cells}")
    return turned_round(whole) if cascade.opposite else whole


def _outside(
    cascade: Cascade, passage: Passage, template: Template, corners: str, cells: int | None,
    cell_size: float | None, timings: Timings,
) -> tuple[Layout, int, SizeMetric]:  # fmt: skip
    """Return the coarse layout outside the layers, the factor to the final counts, and target cell sizes."""
    if corners == "nowhere":
        front = passage.front
        passage = replace(passage, front=replace(front, corners=(), names=front.names[:1]))
    with stage("first optimum", timings):
        coarse = passage_optimum(template(passage, at_corners=corners == "at first"), FIRST, None)
    with stage("refine", timings):
        chords = Chords.of(coarse)
        counts, times, metric = counts_of(cascade, chords, cells, cell_size)
        coarse = refine(coarse, counts, chords)
    with stage("optimum", timings):
        for _ in range(PASSES):
            coarse = passage_optimum(coarse, ITERATIONS, metric)
        if cascade.measures:
            even = evened_loops(coarse, cascade.measures, times * EVEN, FEW_STEPS)
            coarse = passage_optimum(even, ITERATIONS, metric, even.mesh.places.loop == BLADE)
    return coarse, times, metric


def passage_optimum(
    layout: Layout, iterations: int, metric: SizeMetric | None, held: Bools | None = None
) -> Layout:
    """Return the layout of a passage with nodes optimised for the target cell sizes `metric`.

    Nodes in the mask `held` (n,), and the end nodes of the cut (the grid line at which the passage repeats),
    do not move. Raises NoValidGridError if cells stay folded.
    """
    mesh = layout.mesh
    ends = (mesh.places.loop >= 0) & mesh.tied
    optimum = optimise(
        mesh, iterations=iterations, held=ends if held is None else ends | held,
        targets=metric.gradual(mesh) if metric else None, weights=WEIGHTS,
    )  # fmt: skip
    if not optimum.valid:
        raise NoValidGridError("cells of the passage stay folded")
    return replace(layout, mesh=optimum.mesh)


def _rows(cascade: Cascade, layout: Layout, metric: SizeMetric) -> list[Rows]:
    """Return the layers, and the straight rows to inlet and outlet."""
    mesh, passage = layout.mesh, cascade.passage
    inner = heights_inside(layout, BLADE)
    rows = [ring_rows(mesh, BLADE, cascade.ring, cascade.rows_of_layers, cascade.layers, inner)]
    for number, length, way in straight_rows(cascade):
        if length > 0.0:
            start = mesh.nodes[mesh.places.along(number)]
            steps = row_steps(math.exp(log(heights_inside(layout, number)).mean()), length, metric.largest)
            nodes = start[:, None] + steps[:, None] * (way * passage.axis)
            rows.append(Rows(number, nodes, np.zeros(len(start)), False))
    return rows


def straight_rows(cascade: Cascade) -> list[tuple[int, float, float]]:
    """Return start (loop index), length and axial direction (±1) of straight grid lines to inlet and outlet.

    They lead from the loops `INLET` and `OUTLET`, where the blocks around the blade end.
    """
    passage = cascade.passage
    axial = passage.axial(passage.front.curve.points)
    before = cascade.ends[0] - float(axial.min() - passage.inlet)
    behind = cascade.ends[1] - float(passage.outlet - axial.max())
    some = 1e-6 * abs(cascade.left)
    return [(INLET, before if before > some else 0.0, -1.0), (OUTLET, behind if behind > some else 0.0, 1.0)]


def row_steps(first: float, length: float, largest: float) -> Floats:
    """Return positions of nodes on a line, from 0 to `length`; cells grow from `first` to about `largest`."""
    cells = [min(first * ROW_GROWTH**0.5, length)]
    total = cells[0]
    while total < length - 0.5 * cells[-1]:
        cells.append(max(min(cells[-1] * ROW_GROWTH, largest), cells[0]))
        total += cells[-1]
    steps = np.concatenate([[0.0], np.cumsum(cells)]) * (length / total)
    steps[-1] = length
    return np.asarray(steps)


def counts_of(
    cascade: Cascade, chords: Chords, cells: int | None, cell_size: float | None
) -> tuple[Indices, int, SizeMetric]:
    """Return coarse cell counts of all rows of blocks, the factor that refines them, and target sizes."""
    sizes = cascade.metric
    wanted = WantedCounts(chords, sizes)
    if cell_size is not None:
        across = np.minimum(sizes.across, cell_size)
        metric = replace(sizes, across=across, along=across, largest=cell_size)
        counts = wanted.counts(metric)
    else:
        low, high = math.log(0.05), math.log(COARSEST)
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            metric = scaled(sizes, math.exp(middle))
            counts = wanted.counts(metric)
            total = chords.cells(counts) + attached_cells(cascade, chords, counts, metric)
            low, high = (middle, high) if total > (cells or 0) else (low, middle)
    times = 1
    while chords.cells(counts) / times**2 > MOST_OPTIMISED:
        times += 1
    least = np.maximum(chords.least, LEAST)
    return np.maximum(least, np.round(counts / times).astype(np.intp)), times, metric


def attached_cells(
    cascade: Cascade, chords: Chords, counts: Indices, metric: SizeMetric, layers: int | None = None,
    least: Mapping[int, float] | None = None,
) -> int:  # fmt: skip
    """Return the number of cells in the layers, and along straight grid lines to inlet and outlet.

    `counts` are the cells along the edges of each chord (set of opposite edges). `layers` replaces the number
    of layers. `least` has, for `INLET` and `OUTLET`, the smallest length that these lines are taken to have.
    """
    along = chords.along_loops(counts).tolist()
    total = along[BLADE] * (cascade.rows_of_layers if layers is None else layers)
    for number, length, _ in straight_rows(cascade):
        length = max(length, (least or {}).get(number, 0.0))
        if length > 0.0:
            steps = row_steps(abs(cascade.left) / along[number], length, metric.largest)
            total += along[number] * (len(steps) - 1)
    return int(total)
