"""Multi-block grids with layers at walls: rings around loops, rows of quads elsewhere, rows to a far field.

::

    walls --march--> rings
    fronts, near field --decompose--> layout --rows of quads--> layout with layers
                                                 |  counts, optimum, columns by the law
    rings --columns at the nodes of the fronts---+--> whole
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, middle
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.periodic_sides import with_tied_sides
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.chord_cells import metric_places
from meshonet.solvers.blocking.decomposition.side_counts import alike_along_sides, suited
from meshonet.solvers.blocking.decomposition.symmetry.images import made_symmetric, node_images
from meshonet.solvers.blocking.layers.attach import attach
from meshonet.solvers.blocking.layers.even_mesh import evened_mesh
from meshonet.solvers.blocking.layers.finished import finished
from meshonet.solvers.blocking.layers.growth_lines import GrowthLines
from meshonet.solvers.blocking.layers.layer_rows import heights_inside, ring_rows
from meshonet.solvers.blocking.layers.outside import found_outside, taken_outside
from meshonet.solvers.blocking.layers.placed_rows import held_nodes, layers_of, with_layers
from meshonet.solvers.blocking.layers.stretches import Stretch
from meshonet.solvers.blocking.layers.wall_layers import ROWS, Counts, WallLayers, wanted_counts
from meshonet.solvers.blocking.layers.wall_rows import WallRows, has_sharp_edge, wake_of, with_wall_rows
from meshonet.solvers.blocking.unfolded import unfolded
from meshonet.solvers.energy.quad_problem import smallest_jacobian
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.layers.even_line import EVEN, FEW_STEPS, evened_loops
from meshonet.solvers.layers.layer_settings import LayerSettings
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.refine import multiplied, refine
from meshonet.solvers.stages import Timings, stage

ITERATIONS, STRIDING = 120, 60  # of each optimum, and of one before it on fewer cells
UNFOLDING = 3  # factor on the number of iterations if cells are folded at first
SWEEPS = 10  # sweeps that smooth target lengths: with twice as many, cells in slots grow too fast
COUNTINGS = 3
"""Number of rounds in which cells are counted and nodes optimised, before nodes on fronts are fixed."""
LIMITS = 1.0, 2.0, 4.0
"""Multiples of `EVEN` that are tried in turn: nodes that move far along a front fold the cells beside it."""
BASE_GROWTH = math.log(4.0)
"""Logarithm of the ratio of neighbouring edges above which a wall with a wake gets a ring."""


def layered(
    domain: Domain, loops: Sequence[int], settings: LayerSettings, *, stretches: Sequence[Stretch] = (),
    cells: int = 0, cell_size: float = 0.0, layout: Layout | None = None, timings: Timings | None = None,
) -> Layout:  # fmt: skip
    """Return a fine layout of about `cells` cells, with layers at `loops` and `stretches` (parts of loops).

    If `cells` is 0, edges away from walls are at most `cell_size` long. If `layout`, the layout of a similar
    domain, is given, its blocks are used. Raises InputError if there is too little room for layers,
    SolverError if no blocks are found, NoValidGridError if cells are folded.
    """
    timings = {} if timings is None else timings
    sharp = () if layout else tuple(k for k in loops if k and has_sharp_edge(domain.loops[k]))
    while True:
        with stage("layers", timings):
            rings = [k for k in loops if k not in sharp]
            walls = WallLayers.of(domain, rings, settings, stretches, sharp)
        coarse = layout and taken_outside(layout, walls.rest, walls.rings)
        coarse = coarse or found_outside(walls.rest, walls.rings, timings, bool(walls.mirrors))
        free = tuple(k for k in sharp if walls.is_free(k, coarse.mesh, wake_of(coarse.mesh, k)))
        if free == sharp:
            coarse, rows = with_wall_rows(coarse, walls.stretches, sharp, walls.mirrors)
            coarse, counts = _optimum(walls, rows, walls.symmetric(coarse), (cells, cell_size), None, timings)
            for _ in range(1, COUNTINGS if rows.loops else COUNTINGS - 1):
                coarse, counts = _optimum(walls, rows, coarse, (cells, cell_size), counts, timings)
            wakes = rows.wakes(coarse)  # they have moved
            free = tuple(
                k for k in sharp
                if walls.has_room(k, wakes[k], counts.scale) and rows.growth(coarse, k) < BASE_GROWTH
            )  # fmt: skip
        if free == sharp:
            break
        sharp = free
    fine = _fine(walls, rows, coarse, counts, timings)
    with stage("layers", timings):
        return _joined(walls, rows, fine)


def _optimum(
    walls: WallLayers, rows: WallRows, layout: Layout, size: tuple[int, float], before: Counts | None,
    timings: Timings,
) -> tuple[Layout, Counts]:  # fmt: skip
    """Return the layout outside the rings with cells counted anew, optimised."""
    chords = Chords.of(layout, node_images(layout.mesh, walls.mirrors))
    with stage("refine", timings):
        counts = wanted_counts(walls, rows, chords, *size, before)
        places = metric_places(chords, counts.coarse, counts.metric)
        for edge in np.flatnonzero(rows.of_chords(chords)[chords.chord] >= 0):
            places[edge] = np.linspace(0.0, len(chords.edges[edge]) - 1.0, ROWS + 1)
        coarse = _tied(walls.symmetric(refine(layout, counts.coarse, chords, places)))
    with stage("optimum", timings):
        if counts.stride > 1:
            with suppress(NoValidGridError):  # more cells may unfold
                coarse = _optimised(coarse, walls, rows, counts, STRIDING)
            coarse = _tied(walls.symmetric(multiplied(coarse, counts.stride)))
        coarse = _optimised(coarse, walls, rows, counts, ITERATIONS)
    known = before.layers if before else (1.0,) * len(rows.loops)
    layers = [
        layers_of(coarse, rows, number, walls.of_rows[number])
        / walls.sizes[loop].rows(counts.scale, walls.of_rows[number])
        for number, loop in enumerate(rows.loops)
    ]
    damped = tuple(math.sqrt(new * old) for new, old in zip(layers, known, strict=True))
    return coarse, replace(counts, layers=damped)


def _fine(walls: WallLayers, rows: WallRows, coarse: Layout, counts: Counts, timings: Timings) -> Layout:
    """Return the fine layout outside the rings, with all layers of its rows."""
    times = counts.times
    with stage("optimum", timings):
        on = np.isin(coarse.mesh.places.loop, list(walls.measures))
        for limit in (EVEN * np.array(LIMITS)).tolist():
            even = evened_loops(coarse, walls.measures, times * limit)
            if even is not coarse:
                coarse = _optimised(walls.symmetric(even), walls, rows, counts, ITERATIONS, on)
                break
        lines = GrowthLines.of(coarse.mesh, times * EVEN, _factors(coarse, walls, rows, times))
        coarse = replace(coarse, mesh=evened_mesh(coarse.mesh, on | coarse.mesh.tied, lines))
        coarse = walls.symmetric(coarse)
    with stage("refine", timings):
        chords = Chords.of(coarse, node_images(coarse.mesh, walls.mirrors))
        row, cells = rows.of_chords(chords), times * chords.counts
        layers = [layers_of(coarse, rows, number, own) for number, own in enumerate(walls.of_rows)]
        cut = max((n for n, loop in zip(layers, rows.loops, strict=True) if loop == 0), default=0)
        for number, loop in enumerate(rows.loops):  # walls have as many layers at both periodic sides
            cells[row == number] = cut if loop == 0 and walls.domain.periodic else layers[number]
        if not alike_along_sides(chords, cells):
            problem = "layers end at one of two periodic sides and not at the other"
            raise InputError(problem, "name the walls at both", parameter="walls")
        fixed = {int(chord): int(cells[chord]) for chord in np.flatnonzero(row >= 0)}
        cells = suited(chords, cells, chords.least, multiple=walls.settings.multiple, fixed=fixed)
        fine = _tied(walls.symmetric(refine(coarse, cells, chords)))
        fine = walls.symmetric(unfolded(fine, np.isin(fine.mesh.places.loop, list(walls.measures))))
        fine = walls.symmetric(evened_loops(fine, walls.measures, EVEN, most=FEW_STEPS))
        return _tied(walls.symmetric(with_layers(fine, rows, walls.of_rows)))


def _factors(layout: Layout, walls: WallLayers, rows: WallRows, times: int) -> Floats:
    """Return factors (e,) by which edges across rows of layers become the cells beyond the last layers."""
    factors = np.ones(len(layout.mesh.edges))
    for row, settings in enumerate(walls.of_rows):
        last = settings.join * (1.0 - 1.0 / settings.growth)  # cell beyond the layers over their thickness
        for table in rows.columns(layout, row):
            across = layout.mesh.edges_between(table[:, :-1], table[:, 1:])
            factors[across] = times * (table.shape[1] - 1) * last
    return factors


def _tied(layout: Layout) -> Layout:
    """Return the layout with the nodes of periodic sides in pairs."""
    return replace(layout, mesh=with_tied_sides(layout.mesh))


def _optimised(
    layout: Layout, walls: WallLayers, rows: WallRows, counts: Counts, iterations: int,
    held: Bools | None = None,
) -> Layout:  # fmt: skip
    """Return a layout with its nodes optimised for the sizes of `counts`; nodes `held` (n,) are fixed."""
    mesh = layout.mesh
    targets = counts.metric.gradual(mesh, SWEEPS)
    if rows.loops:
        targets *= exp(middle(log(mesh.edge_lengths / targets)))  # cells are larger than they will be
        for number, loop in enumerate(rows.loops):
            for table in rows.columns(layout, number):
                thick = _thickness(walls, mesh, table[:, 0], loop, counts.scale)
                edges = mesh.edges_between(table[:, :-1], table[:, 1:])
                targets[edges] = (thick / (table.shape[1] - 1))[:, None]
    if smallest_jacobian(mesh.nodes, mesh.quads) <= 0.0:
        iterations *= UNFOLDING
    optimum = optimise(mesh, iterations=iterations, targets=targets, aspects=mesh.aspects(targets), held=held)
    if not optimum.valid:
        remedy = "use more {cells} or a lower first cell"
        if walls.domain.counts:
            sides = ", ".join(f"{name}={count}" for name, count in walls.domain.counts.items())
            remedy = f"leave {{count}} {sides} out, or give numbers nearer to those of the grid without them"
        raise NoValidGridError(f"cells outside the layers stay folded; {remedy}")
    return walls.symmetric(replace(layout, mesh=optimum.mesh))


def _thickness(walls: WallLayers, mesh: QuadMesh, base: Indices, loop: int, scale: float) -> Floats:
    """Return the thickness of layers at nodes (k,) of a wall, or of the wake behind it."""
    sizes = walls.sizes[loop]
    thick = sizes.thickness_at(mesh.places.arc[base], scale, walls.settings)
    behind = mesh.places.loop[base] != loop
    if behind.any():
        edge = sizes.loop.at(sizes.loop.corner_arcs[:1])[0]
        away = np.hypot(*(mesh.nodes[base[behind]] - edge).T)
        thick[behind] = sizes.thickness_behind(away, scale, walls.settings)
    return thick


def _joined(walls: WallLayers, rows: WallRows, layout: Layout) -> Layout:
    """Return the layout with rings and rows to a distant outer loop attached, and its growth limited."""
    settings, mesh = walls.settings, layout.mesh
    attached = [
        ring_rows(
            mesh, number, ring, walls.ring_rows(number), walls.of_ring(number), heights_inside(layout, number)
        )
        for number, ring in walls.rings.items()
    ]
    if walls.near is not None:
        attached.append(walls.near.rows(mesh, heights_inside(layout, 0), settings))
    whole = attach(layout, walls.domain, attached)
    whole = replace(whole, mesh=made_symmetric(whole.mesh))
    held = np.zeros(len(whole.mesh.nodes), dtype=bool)
    own, following = held_nodes(layout, rows, settings, len(walls.sharp))
    held[: len(mesh.nodes)] = own | mesh.tied
    return finished(whole, settings, held, following)
