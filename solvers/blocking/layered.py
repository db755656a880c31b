"""Grids of blocks with layers at walls: rings around them, blocks between the rings, rows to a far field.

::

    walls --march--> rings    fronts, near field --decompose--> layout --counts, optimum--> fine layout
                       |                                                                         |
                       +------------------ columns at the nodes of the fronts -------------------+--> whole
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.attach import attach
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.decompose import Timings
from meshonet.solvers.blocking.even_loops import evened_loops
from meshonet.solvers.blocking.even_metric import metric_places
from meshonet.solvers.blocking.finished import best_of, finished, respaced_layers
from meshonet.solvers.blocking.folds import smallest_corner, unfolded
from meshonet.solvers.blocking.layer_rows import LayerSettings, heights_inside, ring_rows
from meshonet.solvers.blocking.on_loops import on_loops
from meshonet.solvers.blocking.outside import found_outside, taken_outside
from meshonet.solvers.blocking.refine import multiplied, refine
from meshonet.solvers.blocking.size_metric import SizeMetric
from meshonet.solvers.blocking.stretches import Stretch
from meshonet.solvers.blocking.strip_attach import attach_strips, with_corners
from meshonet.solvers.blocking.wall_layers import WallLayers, wanted_counts
from meshonet.solvers.energy.quads import optimise

ITERATIONS, STRIDING = 120, 60
COUNTINGS = 3
"""How often cells are counted, nodes optimised after each, before nodes on fronts are evened and held."""
COMPARED = 2
"""By how much cells may be multiplied after they are optimised for the first counts to be tried as well."""
EVEN = math.log(1.2)
"""Logarithm of the ratio by which neighbouring cells along fronts may differ."""


def layered(
    domain: Domain, loops: Sequence[int], settings: LayerSettings, *, stretches: Sequence[Stretch] = (),
    cells: int = 0, cell_size: float = 0.0, layout: Layout | None = None, timings: Timings | None = None,
) -> Layout:  # fmt: skip
    """Return a fine layout of about so many cells, with layers at loops of a domain and stretches of others.

    Without `cells`, none away from walls is longer than `cell_size`. `layout` is to be taken instead of one
    that is found: of a domain like it outside layers like these, or of the whole of it.
    Raises InputError, BlockingError; NoValidGridError: cells stay folded.
    """
    timings = timings or Timings()
    with timings.stage("layers"):
        walls = WallLayers.of(domain, loops, settings, stretches)
    if layout is None:
        layout = found_outside(walls.rest, walls.fronts, timings, walls.spans)
    else:
        layout = taken_outside(layout, walls.rest, walls.fronts)
    for even in (True, False):  # nodes that are moved to make cells grow evenly may fold them
        try:
            return _whole(walls, layout, (cells, cell_size), timings, even)
        except NoValidGridError as error:
            problem = error
    raise problem


def _whole(
    walls: WallLayers, layout: Layout, size: tuple[int, float], timings: Timings, even: bool
) -> Layout:
    """Return the fine layout, its cells evened along fronts or not.

    Blocks change in size while nodes are optimised, and cells are counted again for the new ones. Where cells
    are few, the better of the first and the last counts is taken: blocks that grow may cost more in angles
    than they gain in growth.
    """
    counted: list[tuple[Layout, int, SizeMetric]] = []
    wholes: list[Layout] = []
    problem = NoValidGridError("cells outside the layers stay folded")
    for _ in range(COUNTINGS):
        try:
            counted.append(_optimum(walls, counted[-1][0] if counted else layout, size, timings))
        except NoValidGridError as error:
            problem = error
            break
    for coarse, times, metric in (counted[-1], counted[0]) if len(counted) > 1 else counted:
        if wholes and times > COMPARED:
            break
        try:
            fine = _fine(walls, coarse, times, metric, timings, even)
            with timings.stage("layers"):
                wholes.append(_joined(walls, fine))
        except NoValidGridError as error:
            problem = error
    if not wholes:
        raise problem
    return best_of(wholes) if len(wholes) > 1 else wholes[0]


def _optimum(
    walls: WallLayers, layout: Layout, size: tuple[int, float], timings: Timings
) -> tuple[Layout, int, SizeMetric]:
    """Return the layout outside the rings with cells counted anew, optimised.

    With it come by how much it is to be finer, and the sizes that it follows.
    """
    chords = Chords.of(layout)
    with timings.stage("refine"):
        counts, stride, times, metric = wanted_counts(walls, chords, *size)
        coarse = refine(layout, counts, chords, metric_places(chords, counts, metric))
    with timings.stage("optimum"):
        if stride > 1:
            with suppress(NoValidGridError):  # so few cells may stay folded, and more not
                coarse = _optimised(coarse, metric, STRIDING)
            coarse = multiplied(coarse, stride)
        return _optimised(coarse, metric, ITERATIONS), times, metric


def _fine(
    walls: WallLayers, coarse: Layout, times: int, metric: SizeMetric, timings: Timings, even: bool
) -> Layout:
    """Return the fine layout outside the rings, `times` as fine as the coarse one."""
    with timings.stage("optimum"):
        if even:
            coarse = evened_loops(coarse, walls.measures, times * EVEN)
            on = np.isin(coarse.mesh.places.loop, list(walls.measures))
            coarse = _optimised(coarse, metric, ITERATIONS, on)
    with timings.stage("refine"):
        fine = multiplied(coarse, times)
        fine = unfolded(fine, np.isin(fine.mesh.places.loop, list(walls.measures)))
        moved = evened_loops(fine, walls.measures, EVEN) if even else fine
        return moved if smallest_corner(moved.mesh) > 0.0 else fine


def _optimised(
    layout: Layout, metric: SizeMetric, iterations: int, held: NDArray[np.bool_] | None = None
) -> Layout:
    """Return a layout with its nodes optimised for some sizes; `held` (n,) stay."""
    mesh = layout.mesh
    targets = metric.edges(mesh)
    optimum = optimise(mesh, iterations=iterations, targets=targets, aspects=mesh.aspects(targets), held=held)
    if not optimum.valid:
        raise NoValidGridError("cells outside the layers stay folded")
    return replace(layout, mesh=optimum.mesh)


def _joined(walls: WallLayers, outside: Layout) -> Layout:
    """Return the layout with the layers, and the rows to a distant outer loop, attached."""
    settings, layout = walls.settings, outside
    corners: list[int] = []
    for number, cut in walls.cuts.items():
        loops = list(layout.mesh.domain.loops)
        loops[number] = cut.outer
        rows_of = [walls.rows(strip) for strip in cut.layers]
        layout, new = attach_strips(layout, Domain(tuple(loops)), number, cut, rows_of, settings)
        corners += new
    mesh = layout.mesh
    rows = [
        ring_rows(mesh, number, ring, walls.rows(ring), settings, heights_inside(layout, number))
        for number, ring in walls.rings.items()
    ]
    if walls.near is not None:
        rows.append(walls.near.rows(mesh, heights_inside(layout, 0), multiple=settings.multiple))
    whole = attach(layout, walls.domain, rows)
    joints = [int(whole.blocks[number][-1, -1]) for number in corners]
    respaced = with_corners(respaced_layers(whole, settings, joints), corners, settings)
    sliding = np.isin(whole.mesh.places.loop, list(walls.cuts)) & (whole.mesh.places.cells == 0)
    respaced = replace(respaced, mesh=on_loops(respaced.mesh, sliding))
    return finished([respaced, whole], settings, corners)
