"""Smooths planar multi-block grids: the joint optimum of all nodes, with the spacing of the given grid."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.layout.from_grid import layout_of, with_nodes
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.notes import UNJUDGED
from meshonet.geometry.ties import first_least
from meshonet.solvers.energy.quads import FREE, optimise
from meshonet.solvers.smoothing.hold_back import PlaneMeasures, held_back, measures
from meshonet.solvers.smoothing.layers import with_layers
from meshonet.solvers.smoothing.wanted_lengths import wanted_lengths
from meshonet.solvers.solution import Outcome, Solution, timed

METHOD = "variational"
EVEN = 1.3  # largest ratio of neighbouring edges that is not evened out
ITERATIONS = 300  # of the optimum, at the most
TOLERANCE = 1e-5  # relative gain of the functional at which it ends before
_AS_GOOD = "the grid is kept as it was: its optimum is no better"


@timed
def smooth(grid: Grid, *, slide: bool = False, iterations: int = ITERATIONS) -> Solution:
    """Return `grid` with its nodes at the variational optimum of all blocks; boundary nodes may `slide`.

    Two optima are computed, one of them with evened-out spacing between blocks; the better one is used.
    Displacements are reduced until none of three values of the grid is larger than before: non-orthogonality
    and skewness of the worst face, and mean deviation from 90 degrees. Raises InputError if the blocks are
    not planar or do not form a domain.
    """
    original = layout_of(grid)
    before = measures(grid)
    candidates: list[tuple[PlaneMeasures, Grid]] = []
    for layout in _optima(original, slide=slide, iterations=iterations):
        made: Grid | None = with_nodes(grid, layout)
        if made is not None and not measures(made).no_worse(before):
            made = held_back(grid, original, layout, before)
        if made is not None:
            candidates.append((measures(made), made))
    least, best = first_least(candidates or [(before, grid)], key=lambda pair: pair[0].score)
    better = least.folded < before.folded or least.score < before.score
    notes = () if better else (_AS_GOOD,)
    best = best if better else grid
    outcome = Outcome.FOLDED if (better and least.folded) or (not better and before.folded) else Outcome.DONE
    facts = best.with_provenance(method=METHOD, slide=slide, **UNJUDGED)
    return Solution(facts, METHOD, notes=notes, outcome=outcome)


def _optima(original: Layout, *, slide: bool, iterations: int) -> Iterator[Layout]:
    """Yield the optimum with jumps evened out, if there are any, and the optimum with all ratios kept."""
    mesh = original.mesh
    places = mesh.places
    fixed = (places.loop >= 0) & (places.partner < 0)
    fixed[places.partner[places.partner >= 0]] = False
    stays = np.zeros(len(mesh.nodes), dtype=bool) if slide else fixed
    own, even = mesh.edge_lengths, wanted_lengths(mesh, EVEN, slide=slide)
    for wanted in [own] if np.array_equal(even, own) else [even, own]:
        towards = partial(
            optimise,
            weights=FREE,
            iterations=iterations,
            aspects=mesh.aspects(wanted),
            targets=wanted,
            tolerance=TOLERANCE,
        )
        optimum = towards(mesh, held=stays)
        if not optimum.valid:
            continue
        layers, inside = with_layers(optimum.mesh, mesh)
        if inside.any():
            optimum = towards(layers, held=stays | inside)
        if optimum.valid:
            yield replace(original, mesh=optimum.mesh)
