"""Smooths multi-block volume grids: the joint optimum of all nodes, with the spacing of the given grid."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from meshonet.geometry.arrays import Bools, Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.notes import UNJUDGED
from meshonet.geometry.volume.hex_mesh import HexMesh, any_corner, corners_of, hex_mesh_of, with_nodes
from meshonet.solvers.energy.hex_tables import Targets
from meshonet.solvers.energy.hexes import HexProblem, Slides, optimise
from meshonet.solvers.smoothing.slide_planes import slides_of
from meshonet.solvers.smoothing.volume_judge import VolumeMeasures, cells_below, measures
from meshonet.solvers.smoothing.volume_layers import VolumeLayers, layers_of, with_first_heights, with_layers
from meshonet.solvers.smoothing.volume_levels import carried, coarser
from meshonet.solvers.smoothing.volume_restart import harmonic
from meshonet.solvers.smoothing.volume_spacing import wanted_edges
from meshonet.solvers.solution import Outcome, Solution, timed

METHOD = "variational"
ITERATIONS = 40  # of the optimum, at the most
TOLERANCE = 1e-5  # relative gain of the functional at which it ends before
_AROUND = (2, 4)  # numbers of cells around folded ones that are untangled first
_SOME = 0.02  # largest fraction of folded cells for which only cells around them are moved first
_FEW_ROUNDS = 5  # of unfolding, where layers at their heights folded what was valid
_COARSE = 60  # iterations of the optimum of a coarser copy, at the most
_ROUNDS, _GENTLE = 12, 5
"""Numbers of rounds of reducing displacements, and of rounds before bad cells are reset at once."""
_SHARES = (0.5, 0.7, 0.85)
"""Factors per round of the displacement of a bad cell's nodes, and of nodes one and two cells away."""
_AS_GOOD = "the grid is kept as it was: its optimum is no better"


@timed
def smooth_volumes(grid: Grid, *, iterations: int = ITERATIONS, slide: bool = False) -> Solution:
    """Return `grid` with its nodes moved to the joint optimum of the cells of all blocks.

    The functional is that of `meshonet.solvers.energy.hex_functional`. Nodes of outer and periodic sides are
    bitwise unchanged; with `slide`, nodes of flat patches move in their planes. `iterations` is the largest
    number of iterations. Displacements are reduced if the smallest scaled Jacobian or the mean deviation from
    90 degrees would become worse. Raises InputError if blocks are not volumes or are left-handed.
    """
    original = hex_mesh_of(grid)
    before = measures(original)
    slides, sliding = (
        slides_of(grid, original) if slide else (Slides.none(), np.zeros(len(original.nodes), bool))
    )
    moves = ~original.outer | sliding
    made, after = original, before
    if moves.any():
        made, after = _best(original, before, moves, slides, iterations)
    notes = () if made is not original else (_AS_GOOD,)
    result = with_nodes(grid, made) if made is not original else grid
    return Solution(
        result.with_provenance(method=METHOD, slide=slide, **UNJUDGED),
        METHOD,
        notes=notes,
        outcome=Outcome.FOLDED if after.folded else Outcome.DONE,
    )


def _best(
    original: HexMesh, before: VolumeMeasures, moves: Bools, slides: Slides, iterations: int
) -> tuple[HexMesh, VolumeMeasures]:
    """Return the smoothed mesh and its measures, or the given one if smoothing does not improve it."""
    targets = wanted_edges(original, moves)
    layers = layers_of(original, moves, targets)
    start, valid = original, before
    if before.folded:
        start, valid, targets = _unfolded(original, before, moves, targets, slides)
        if valid.folded:
            return (start, valid) if valid.folded < before.folded else (original, before)
    for made, kept in _optima(start, moves, targets, layers, slides, iterations):
        best = _held_back(start, made, valid, layers) if kept or start is not original else None
        if best is not None:
            return best
    return start, valid


def _unfolded(
    original: HexMesh, before: VolumeMeasures, moves: Bools, targets: Targets, slides: Slides
) -> tuple[HexMesh, VolumeMeasures, Targets]:
    """Return the mesh without folded cells, or with fewer, its measures, and the target lengths.

    A few folded cells are first untangled with the nodes around them, then with all nodes, from several
    starts: the optimum of a coarser copy, the given nodes, and a harmonic restart.
    """
    mesh, measured = original, before
    for reach in _AROUND if before.folded < _SOME * original.cells else ():
        near = moves & _around(mesh, reach)
        mesh, measured = _with_fewer(mesh, mesh, measured, near, targets, slides)
        if not measured.folded:
            return mesh, measured, targets
    for start, wanted in _starts(mesh, moves, targets, slides):
        fewer, now = _with_fewer(mesh, start, measured, moves, wanted, slides)
        if fewer is not mesh:
            mesh, measured, targets = fewer, now, wanted
        if not measured.folded:
            break
    return mesh, measured, targets


def _starts(
    mesh: HexMesh, moves: Bools, targets: Targets, slides: Slides
) -> Iterator[tuple[HexMesh, Targets]]:  # fmt: skip
    begun = _begun(mesh, moves, targets, slides)
    if begun is not mesh:
        yield begun, targets
    yield mesh, targets
    anew = mesh.with_nodes(harmonic(mesh, ~mesh.outer))
    yield anew, wanted_edges(anew, moves)


def _begun(mesh: HexMesh, moves: Bools, targets: Targets, slides: Slides) -> HexMesh:
    """Return a mesh displaced like the optimum of a coarser copy; unchanged if there is none."""
    copy = coarser(mesh)
    optimum = None if copy is None else _nested(copy.mesh, moves[copy.nodes], slides.among(copy.nodes))
    if copy is None or optimum is None:
        return mesh
    moved = mesh.nodes + carried(mesh, copy, optimum - copy.mesh.nodes, targets)
    starts = [mesh.with_nodes(slides.kept(mesh.nodes, moved, moves))]
    if measures(starts[0]).folded > _SOME * mesh.cells:
        filled = carried(mesh, copy, optimum, targets)
        starts.append(mesh.with_nodes(slides.kept(mesh.nodes, filled, moves)))
    return min(starts, key=lambda each: measures(each).folded)


def _nested(mesh: HexMesh, moves: Bools, slides: Slides) -> Floats | None:
    """Return the nodes of the optimum of a mesh, starting on a coarser copy; None if it stays folded."""
    targets, before = wanted_edges(mesh, moves), measures(mesh)
    if before.folded:
        mesh, before, targets = _unfolded(mesh, before, moves, targets, slides)
        if before.folded:
            return None
    start = _begun(mesh, moves, targets, slides)
    optimum = optimise(start, moves, targets, slides=slides, iterations=_COARSE, tolerance=TOLERANCE)
    return optimum.nodes if optimum.valid else None


def _with_fewer(
    mesh: HexMesh, start: HexMesh, measured: VolumeMeasures, moves: Bools, targets: Targets, slides: Slides
) -> tuple[HexMesh, VolumeMeasures]:
    """Return `start` untangled, and its measures, if it has fewer folded cells than `mesh`; else `mesh`."""
    problem = HexProblem(start, moves, targets, slides)
    problem.unfold(problem.smallest())
    tried = start.with_nodes(problem.result())
    now = measures(tried)
    return (tried, now) if now.folded < measured.folded else (mesh, measured)


def _around(mesh: HexMesh, reach: int) -> Bools:
    near = _nodes_of(mesh, cells_below(mesh, 0.0))
    for _ in range(reach):
        near = _dilated(near, mesh)
    return near


def _nodes_of(mesh: HexMesh, cells: list[Bools]) -> Bools:
    """Return a mask (n,) of the nodes that are corners of the given cells of each block."""
    nodes = np.zeros(len(mesh.nodes), dtype=bool)
    for block, some in zip(mesh.blocks, cells, strict=True):
        for corner in corners_of(block):
            nodes[corner[some]] = True
    return nodes


def _dilated(nodes: Bools, mesh: HexMesh) -> Bools:
    return _nodes_of(mesh, [any_corner(nodes[block]) for block in mesh.blocks])


def _optima(
    start: HexMesh,
    moves: Bools,
    targets: Targets,
    layers: list[VolumeLayers],
    slides: Slides,
    iterations: int,
) -> Iterator[tuple[HexMesh, bool]]:
    """Yield optima with layers, with first cells only and without, and whether these have their heights."""
    towards = partial(optimise, targets=targets, slides=slides, iterations=iterations, tolerance=TOLERANCE)
    begun = _begun(start, moves, targets, slides)
    optimum = towards(begun, moves)
    if not optimum.valid and begun is not start:
        optimum = towards(start, moves)
    if not optimum.valid:
        return
    first = [replace(each, rows=np.minimum(each.rows, 1)) for each in layers]
    for some in (layers, first) if layers else ():
        nodes, held = with_layers(optimum.nodes, some)
        rest = towards(start.with_nodes(nodes), moves & ~held, rounds=_FEW_ROUNDS)
        if rest.valid:
            yield start.with_nodes(rest.nodes), True
    yield start.with_nodes(optimum.nodes), not layers


def _held_back(
    start: HexMesh, made: HexMesh, before: VolumeMeasures, layers: list[VolumeLayers]
) -> tuple[HexMesh, VolumeMeasures] | None:
    """Return `made` moved back towards `start` until it is no worse, None if nothing would move."""
    part = np.ones(len(start.nodes))
    for number in range(_ROUNDS):
        tried = start.with_nodes(_part_of_the_way(start.nodes, made.nodes, part, layers))
        now = measures(tried)
        if now.no_worse(before):
            return tried, now
        bad = _nodes_of(start, cells_below(tried, 0.0 if now.folded else before.bound))
        if not bad.any():  # the mean deviation
            bad[:] = True
        for share in _SHARES:
            part[bad] *= share if number < _GENTLE else 0.0
            bad = _dilated(bad, start)
        if not part.any():
            break
    return None


def _part_of_the_way(old: Floats, new: Floats, part: Floats, layers: list[VolumeLayers]) -> Floats:
    """Return nodes at the fraction `part` (n,) between two positions; first cells of layers are kept."""
    nodes = old + part[:, None] * (new - old)
    still = part == 0.0
    nodes[still], nodes[part == 1.0] = old[still], new[part == 1.0]
    for each in layers:
        first, heights = each.lines[:, :2], each.heights[:, 0]
        between = (each.rows > 0) & (part[first[:, 1]] > 0.0) & (part[first[:, 1]] < 1.0)
        nodes = with_first_heights(nodes, first[between], heights[between])
    return nodes
