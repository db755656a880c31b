"""Grids of blocks with C sheets at bodies with one sharp edge and a free wake, rings at all others.

::

    walls --march--> sheets, rings    cut outer loop, fronts --decompose--> layout --counts, optimum-->
        fine layout, nodes of both sides of wakes alike --columns at the fronts--> whole
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, percentiles_of
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import NoValidGridError, SolverError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.ties import less
from meshonet.solvers.blocking import layered
from meshonet.solvers.blocking.attach import attach
from meshonet.solvers.blocking.base_complex import base_complex
from meshonet.solvers.blocking.c_attach import attach_sheets
from meshonet.solvers.blocking.c_domain import Sheets
from meshonet.solvers.blocking.c_sheets import Sheet
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.cut_loop import CutLoop
from meshonet.solvers.blocking.decompose import Timings
from meshonet.solvers.blocking.even_line import evened_places
from meshonet.solvers.blocking.even_loops import evened_loops, followed
from meshonet.solvers.blocking.even_metric import metric_places
from meshonet.solvers.blocking.finished import best_of, finished, respaced_layers
from meshonet.solvers.blocking.folds import smallest_corner, unfolded
from meshonet.solvers.blocking.layer_rows import LayerSettings, heights_inside, ring_rows
from meshonet.solvers.blocking.on_loops import on_loops
from meshonet.solvers.blocking.outside import found_outside
from meshonet.solvers.blocking.refine import multiplied, refine
from meshonet.solvers.blocking.wall_layers import wanted_counts
from meshonet.solvers.energy.quads import optimise

FREE = 3
"""Optimisations, each with the sizes at the nodes of the one before, until fronts are held."""
SKEW_DEG = 35.0
"""Deviation from a right angle, of one corner in a hundred, beyond which other ways are tried too."""


def bodies_with_layers(
    domain: Domain, loops: list[int], settings: LayerSettings, *, cells: int, timings: Timings | None = None
) -> tuple[Layout, tuple[str, ...]]:
    """Return a fine layout with C sheets where they can be and are better than rings, and notes.

    Raises InputError: no room for layers; BlockingError, NoValidGridError: rings failed too.
    """
    sheeted = None
    notes: tuple[str, ...] = ()
    try:
        sheeted = c_layered(domain, loops, settings, cells=cells, timings=timings)
        if sheeted is not None and skewness(sheeted[0].mesh) < SKEW_DEG:
            return sheeted
    except (SolverError, NoValidGridError) as error:
        notes = (f"rings of layers in place of C sheets: {error}",)
    try:
        rings = layered.layered(domain, loops, settings, cells=cells, timings=timings)
    except (SolverError, NoValidGridError):
        if sheeted is None:
            raise
        return sheeted
    if sheeted is not None and not less(skewness(rings.mesh), skewness(sheeted[0].mesh)):
        return sheeted
    return rings, notes or (
        ("rings of layers, whose cells are less skew than those of C sheets",) if sheeted else ()
    )


def c_layered(
    domain: Domain, loops: list[int], settings: LayerSettings, *, cells: int, timings: Timings | None = None
) -> tuple[Layout, tuple[str, ...]] | None:
    """Return a fine layout of about so many cells with C sheets and rings at some loops, and notes.

    None where no body has one sharp edge and a free wake. Raises InputError, BlockingError,
    NoValidGridError: cells stay folded.
    """
    timings = timings or Timings()
    with timings.stage("layers"):
        sheets = Sheets.along(domain, loops, settings)
    if sheets is None:
        return None
    layout = found_outside(sheets.rest, (), timings)
    best: Layout | None = None
    problem = NoValidGridError("cells stay folded")
    for even in (True, False):
        try:
            fine = _outside(sheets, layout, cells, timings, even)
            with timings.stage("layers"):
                whole = _whole(sheets, fine)
        except NoValidGridError as error:
            problem = error
            continue
        best = whole if best is None else best_of([best, whole])
        if skewness(best.mesh) < SKEW_DEG:
            break
    if best is None:
        raise problem
    return best, sheets.notes


def skewness(mesh: QuadMesh) -> float:
    """Return the deviation from a right angle, in degrees, that 99 of 100 corners do not exceed."""
    z = mesh.nodes[mesh.quads]
    edge = np.roll(z, -1, axis=1) - z
    before = np.roll(edge, 1, axis=1)
    cosine = (before * edge).sum(axis=2) / np.sqrt((before**2).sum(axis=2) * (edge**2).sum(axis=2))
    return math.degrees(math.asin(percentiles_of(np.abs(cosine), (99,))[0]))


def _outside(sheets: Sheets, layout: Layout, cells: int, timings: Timings, even: bool) -> Layout:
    """Return the fine layout outside sheets and rings, its nodes alike on both sides of wakes."""
    chords = Chords.of(layout)
    with timings.stage("refine"):
        counts, _, times, metric = wanted_counts(sheets, chords, cells, 0.0)
        coarse = refine(layout, counts, chords, metric_places(chords, counts, metric))
    with timings.stage("optimum"):
        mesh = coarse.mesh
        for k in range(len(sheets.cut.layers)):
            mesh = _balanced(mesh, sheets.cut, k)
        held, fronts = None, sheets.measures
        for turn in range(FREE + 1):
            optimum = optimise(mesh, iterations=layered.ITERATIONS, targets=metric.edges(mesh), held=held)
            if not optimum.valid:
                raise NoValidGridError("cells outside the layers stay folded")
            mesh = optimum.mesh
            if turn == FREE - 1:
                held = np.zeros(len(mesh.nodes), dtype=bool)
                for k in range(len(sheets.cut.layers)):
                    mesh, on = _tied(mesh, sheets.cut, k, times * layered.EVEN if even else 0.0)
                    held[on] = True
                if even and fronts:
                    mesh = evened_loops(replace(coarse, mesh=mesh), fronts, times * layered.EVEN).mesh
                    held |= np.isin(mesh.places.loop, list(fronts))
    with timings.stage("refine"):
        fine = multiplied(Layout(mesh, coarse.blocks), times)
        fine = unfolded(fine, fine.mesh.wall_nodes)
        moved = _evened_fronts(fine, sheets) if even else fine
        return moved if smallest_corner(moved.mesh) > 0.0 else fine


def _evened_fronts(fine: Layout, sheets: Sheets) -> Layout:
    """Return the layout with nodes moved along fronts, so that neighbouring cells there differ less."""
    mesh = fine.mesh
    for k in range(len(sheets.cut.layers)):
        mesh, _ = _tied(mesh, sheets.cut, k, layered.EVEN)
    fronts = np.flatnonzero((mesh.nodes != fine.mesh.nodes).any(axis=1))
    nodes = followed(fine, fine.mesh.nodes, 0, fronts, mesh.nodes[fronts])
    fine = replace(fine, mesh=mesh.with_nodes(nodes))
    return evened_loops(fine, sheets.measures, layered.EVEN)


def _balanced(mesh: QuadMesh, cut: CutLoop[Sheet], k: int) -> QuadMesh:
    """Return the mesh with nodes of a front moved along it, as many on both sides of the wake."""
    order, index = cut.front_nodes(mesh, 0, k)
    sheet, last = cut.layers[k], len(order) - 1
    n = len(sheet.levels)
    corner = mesh.places.cells[order] > 0
    low, high = (int(np.flatnonzero(corner & (index == at))[0]) for at in (sheet.edge, n - 1 - sheet.edge))
    edge = round(0.5 * (low + last - high))
    if edge == low and edge == last - high:
        return mesh
    was = np.interp(np.arange(last + 1.0), [0, edge, last - edge, last], [0, low, high, last])
    new = np.interp(was, np.arange(last + 1.0), index)
    new[[edge, last - edge]] = sheet.edge, n - 1 - sheet.edge
    cells = mesh.places.cells.copy()
    cells[order[[low, high]]] = 0
    cells[order[[edge, last - edge]]] = 2
    return _moved(mesh.with_places(mesh.nodes, replace(mesh.places, cells=cells)), cut, k, order, new)


def _tied(mesh: QuadMesh, cut: CutLoop[Sheet], k: int, limit: float) -> tuple[QuadMesh, Indices]:
    """Return the mesh with nodes at the same columns on both sides of a wake, and these nodes.

    Neighbouring cells along the front differ by at most the exponential of `limit`, unless that is 0.
    """
    order, index = cut.front_nodes(mesh, 0, k)
    last = len(cut.layers[k].levels) - 1.0
    edge = int(np.flatnonzero(index == cut.layers[k].edge)[0])
    new = index.copy()
    mean = 0.5 * (index[: edge + 1] + last - index[::-1][: edge + 1])
    if limit:
        measures = cut.layers[k].along(cut.front_arcs(k, np.arange(last + 1.0)))
        mean = evened_places(mean, _ends(len(mean), 1), measures, limit, closed=False)
    new[: edge + 1], new[::-1][: edge + 1] = mean, last - mean
    held = np.concatenate([order[: edge + 1], order[::-1][: edge + 1]])
    if limit:  # the wall's cells fit to those of the wake
        piece = slice(edge - 1, len(new) - edge + 1)
        fixed = _ends(len(new[piece]), 2)
        new[piece] = evened_places(new[piece], fixed, measures, limit, closed=False)
        held = order
    return _moved(mesh, cut, k, order, new), held


def _ends(count: int, held: int) -> NDArray[np.bool_]:
    """Return an array (count,) that is true for the first and last `held`."""
    at = np.arange(count)
    return np.minimum(at, count - 1 - at) < held


def _moved(mesh: QuadMesh, cut: CutLoop[Sheet], k: int, order: Indices, index: Floats) -> QuadMesh:
    nodes, arc = mesh.nodes.copy(), mesh.places.arc.copy()
    arc[order] = cut.front_arcs(k, index)
    nodes[order] = cut.loop.at(arc[order])
    return mesh.with_nodes(nodes, arc)


def _whole(sheets: Sheets, outside: Layout) -> Layout:
    """Return the layout with sheets, rings and the rows to a distant outer loop."""
    domain, near = sheets.domain, sheets.near
    first = near.circle if near else domain.loops[0]
    fronts = [sheets.rings[k].front if k in sheets.rings else loop for k, loop in enumerate(domain.loops)]
    inner = Domain((first, *fronts[1:]), domain.name)
    rows = [sheets.sheet_rows(sheet) for sheet in sheets.cut.layers]
    layout = attach_sheets(outside, sheets.cut, inner, sheets.numbers, sheets.settings, rows)
    rings = [
        ring_rows(layout.mesh, k, ring, sheets.rows(ring), sheets.settings, heights_inside(layout, k))
        for k, ring in sheets.rings.items()
    ]
    walls = Domain((first, *domain.loops[1:]), domain.name)
    layout = attach(layout, walls, rings)
    layout = respaced_layers(layout, sheets.settings)
    sliding = (layout.mesh.places.loop == 0) & (layout.mesh.places.cells == 0)
    layout = replace(layout, mesh=on_loops(layout.mesh, sliding))
    if near is not None:
        layout = attach(layout, domain, [near.rows(layout.mesh, heights_inside(layout, 0))])
    return _exact(finished([_conforming(layout)], sheets.settings), sheets.settings.first)


def _conforming(layout: Layout) -> Layout:
    """Return the layout with blocks that meet along whole sides, layers in blocks of their own."""
    mesh = layout.mesh
    front = np.zeros(len(mesh.nodes), dtype=bool)
    within = np.zeros(len(mesh.nodes), dtype=bool)
    for number in layout.layers:
        front[layout.blocks[number][:, -1]] = True
        within[layout.blocks[number][:, :-1]] = True
    blocks: list[Indices] = []
    layers: dict[int, int] = {}
    split = base_complex(mesh, front[mesh.edges].all(axis=1) & ~mesh.on_wall)
    for block in split.blocks:
        turned = block
        if within[block[1:-1, 1:-1]].all() and within[block].sum() > front[block].sum():
            sides = (block, block.T[::-1], block[::-1, ::-1], block.T[:, ::-1])
            turned = next((side for side in sides if front[side[:, -1]].all()), block)
            if front[turned[:, -1]].all():
                layers[len(blocks)] = turned.shape[1] - 1
        blocks.append(turned)
    return Layout(mesh, tuple(blocks), layers)


def _exact(layout: Layout, first: float) -> Layout:
    """Return the layout with first cells exactly as high as asked for where layers are at walls."""
    nodes = layout.mesh.nodes.copy()
    for number in layout.layers:
        wall, above = layout.blocks[number][:, :2].T
        on = layout.mesh.places.loop[wall] > 0
        step = nodes[above[on]] - nodes[wall[on]]
        nodes[above[on]] = nodes[wall[on]] + step * (first / np.hypot(*step.T))[:, None]
    return replace(layout, mesh=layout.mesh.with_nodes(nodes))
