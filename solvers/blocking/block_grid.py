"""Refines a layout to the requested number of cells and optimises its nodes."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Indices
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.periodic_sides import with_tied_sides
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.decomposition.decompose import most_folded
from meshonet.solvers.blocking.decomposition.side_counts import suited, sums_of
from meshonet.solvers.blocking.decomposition.symmetry.images import images_of, made_symmetric, node_images
from meshonet.solvers.blocking.request import CELLS
from meshonet.solvers.blocking.unfolded import with_more_cells
from meshonet.solvers.energy.quad_problem import ALLOWED, smallest_jacobian
from meshonet.solvers.energy.quads import QuadOptimum, optimise
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.refine import multiplied, refine
from meshonet.solvers.stages import Timings, stage

OPTIMISED = 6000
"""Largest number of cells that are optimised; finer grids are splines through the nodes of a coarser one."""
ITERATIONS = 150  # of the optimisation at the most; it usually ends earlier, when its gain is small
CUT_OFF = 7e-4  # fraction of the area that cells may cut off along walls before the walls get more cells
ROUNDS, STEP, MORE = 7, 1.12, 1.19
"""Largest number of refinements at walls, their factor, and the largest ratio of cells to requested cells."""
MOST_CUT_OFF = 9.5e-4
"""Fraction of the area, cut off less added, above which wall nodes are placed closer at bends."""
MOST_HALVED = 8  # largest number of times that cells are halved without an optimisation in between
RECOUNTS = 4  # iterations for the total number of cells if numbers along some sides are prescribed
HELD_BACK = 0.6  # factor by which the largest turn of a wall along one edge is reduced in each round


def fine_layout(
    layout: Layout,
    *,
    cells: int | None = None,
    cell_size: float | None = None,
    halved: int = 0,
    timings: Timings | None = None,
) -> Layout:
    """Return a block layout, refined to the requested number of cells, with optimised nodes.

    Give the number of `cells`, or `cell_size`, an edge length; the default is `CELLS` cells. After that, each
    of these cells is divided into four, `halved` times. Raises NoValidGridError if cells stay folded.
    """
    timings = {} if timings is None else timings
    area = layout.mesh.domain.area
    wanted = cells or (area / cell_size**2 if cell_size else CELLS)
    halvings = 0
    while wanted / 4**halvings > OPTIMISED:
        halvings += 1
    own = 0  # halvings that are optimised themselves
    while own < halved and not layout.mesh.domain.counts and wanted * 4 ** (own + 1) <= OPTIMISED:
        own += 1
    chords = Chords.of(layout, node_images(layout.mesh))
    least, along = chords.least, [chord for row in sums_of(chords).values() for chord in row]
    size = None if cells else cell_size
    while along and halvings < MOST_HALVED:
        if chords.cells(_counts(chords, least, wanted, size, halvings)) <= 2 * OPTIMISED:
            break
        halvings += 1  # given numbers along sides need more cells than are asked for
    turning, counts, finer = ALLOWED, least, 4.0 ** (halvings - own)
    fine: Layout | None = None
    for _ in range(ROUNDS):
        before = counts
        try:
            counts = _counts(chords, least, wanted, size, halvings)
        except InputError:  # more cells along walls and the given numbers exclude each other
            if fine is None:
                raise
            break
        if fine is not None and chords.cells(counts) > MORE * wanted / 4**halvings:
            if abs(cut_off(fine)) / finer < MOST_CUT_OFF:
                break
            turning, counts = _held_back(chords.of_refined(fine), turning), before
        trial = _optimised(chords, counts, 2**own, turning, timings)
        if fine is not None and turning < ALLOWED and abs(cut_off(trial)) > abs(cut_off(fine)):
            break
        fine = trial
        more = _more_along_walls(chords.of_refined(fine), finer, 2**own)
        more[along] = counts[along]
        if (more <= counts).all():
            break
        least = np.maximum(least, more)
        least[along] = chords.least[along]
    assert fine is not None  # noqa: S101 - the first round makes it
    with stage("refine", timings):
        times = 2 ** (halvings + halved - own)
        if layout.mesh.domain.counts:
            chords, times = chords.of_refined(fine), 2**halved
            exact = suited(chords, chords.counts * 2**halvings, chords.least)
            fine = refine(fine, exact, chords)
        fine = with_more_cells(fine, times) if times > 1 else fine
        return replace(fine, mesh=with_tied_sides(made_symmetric(fine.mesh)))


def _counts(chords: Chords, least: Indices, wanted: float, size: float | None, halvings: int) -> Indices:
    """Return counts (chords,) for a grid with cells of a size, or `wanted` cells, after `halvings`."""
    cells = wanted = wanted / 4**halvings
    size = size and size * 2**halvings
    for _ in range(RECOUNTS):
        few = max(int(cells), 1)
        counts = chords.counts_for_size(size, least) if size else chords.counts_for_cells(few, least)
        counts = suited(chords, counts, least, finer=2**halvings)
        if size or not chords.layout.mesh.domain.counts:
            break
        cells *= wanted / chords.cells(counts)
    return counts


def cut_off(fine: Layout, area: float = 0.0) -> float:
    """Return the fraction of `area` that is lost along curved walls because cells have straight edges.

    The result is negative if the cells cover more. An `area` of 0 stands for the area of the domain.
    """
    (x, y), area = fine.mesh.nodes[fine.mesh.quads].transpose(2, 0, 1), area or fine.mesh.domain.area
    return 1.0 - 0.5 * float((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum()) / area


def _held_back(fine: Chords, turning: float) -> float:
    """Return the largest turn (radians) of walls along an edge: less than now where most is cut off."""
    return HELD_BACK * min(turning, fine.bend(int(np.argmax(fine.cut_off()))))


def _optimised(chords: Chords, counts: Indices, times: int, turning: float, timings: Timings) -> Layout:
    with stage("refine", timings):
        fine = refine(chords.layout, counts, chords)
        fine = multiplied(fine, times) if times > 1 else fine
    with stage("optimum", timings):
        optimum = _optimum(with_tied_sides(fine.mesh), turning)
    if not optimum.valid:
        where = most_folded(optimum.mesh)
        raise NoValidGridError(f"cells of the blocks stay folded after optimisation, most {where}")
    return Layout(optimum.mesh, fine.blocks)


def _optimum(mesh: QuadMesh, turning: float) -> QuadOptimum:
    """Return the optimum of a mesh; its nodes are symmetric about the mirrors of its quads."""
    images = images_of(mesh)
    if images:
        optimum = optimise(made_symmetric(mesh, images), iterations=ITERATIONS, turning=turning)
        symmetric = made_symmetric(optimum.mesh, images)
        if optimum.valid and smallest_jacobian(symmetric.nodes, symmetric.quads) > 0.0:
            return replace(optimum, mesh=symmetric)
    optimum = optimise(mesh, iterations=ITERATIONS, turning=turning)
    if not optimum.valid:  # nodes that slide along a wall can be caught at its corners: unfold without them
        held = optimise(mesh, iterations=ITERATIONS, turning=turning, held=mesh.wall_nodes)
        optimum = optimise(held.mesh, iterations=ITERATIONS, turning=turning) if held.valid else optimum
    return optimum


def _more_along_walls(fine: Chords, finer: float, times: int) -> Indices:
    """Return counts (chords,), `times` coarser, and larger along walls if more than `CUT_OFF` is cut off.

    The area that a chord cuts off is proportional to 1 / count²; refinement later divides it by `finer`.
    """
    lost = np.bincount(fine.chord, fine.cut_off(), fine.count) / finer
    if lost.sum() <= CUT_OFF * fine.layout.mesh.domain.area:
        return fine.counts // times
    walls = np.bincount(fine.chord, np.where(fine.wall, fine.lengths, 0.0), fine.count)
    allowed = CUT_OFF * fine.layout.mesh.domain.area * walls / walls.sum()
    over = np.sqrt(np.maximum(lost, 1e-300) / np.maximum(allowed, 1e-300))
    return np.ceil(fine.counts // times * np.clip(over, 1.0, STEP)).astype(np.intp)
