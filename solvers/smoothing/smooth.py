"""Given grids of many blocks, smoothed: the joint optimum of their nodes, with the spacing that they have.

The optimum is `meshonet.solvers.energy.quads`'s, which wants cells as long to wide, and edges as long to
their neighbours, as they were given (`meshonet.solvers.smoothing.spacing`); layers at the boundary keep their
heights (`meshonet.solvers.smoothing.layers`). It is looked for twice, with jumps from block to block evened
out and with all of them kept, and the better one is taken. No face of it has a larger non-orthogonality or
skewness than the worst of the given grid, nor is the mean deviation from 90 degrees larger: where it would
be, nodes go part of the way.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.layout.from_grid import layout_of, with_nodes
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.ties import first_least
from meshonet.solvers.energy.quads import FREE, optimise
from meshonet.solvers.smoothing.hold_back import held_back
from meshonet.solvers.smoothing.judge import PlaneMeasures, measures
from meshonet.solvers.smoothing.layers import with_layers
from meshonet.solvers.smoothing.spacing import lengths, wanted_lengths
from meshonet.solvers.solution import Outcome, Solution, timed

METHOD = "variational"
EVEN = 1.3
"""Factor between neighbouring edges from which on a jump is evened out."""
ITERATIONS = 300  # of the optimum, at the most
TOLERANCE = 1e-5  # relative gain of the functional at which it ends before
_AS_GOOD = "the grid is kept as it was: its optimum is no better"


@timed
def smooth(grid: Grid, *, slide: bool = False, iterations: int = ITERATIONS) -> Solution:
    """Return `grid` with its nodes moved to the optimum of all blocks; those of the boundary may `slide`.

    Raises InputError: blocks that are not in the plane, or do not close to a domain.
    """
    given = layout_of(grid)
    before = measures(grid)
    candidates: list[tuple[PlaneMeasures, Grid]] = []
    for layout in _optima(given, slide=slide, iterations=iterations):
        made: Grid | None = with_nodes(grid, layout)
        if made is not None and not measures(made).no_worse(before):
            made = held_back(grid, given, layout, before)
        if made is not None:
            candidates.append((measures(made), made))
    least, best = first_least(candidates or [(before, grid)], key=lambda pair: pair[0].score)
    better = least.folded < before.folded or least.score < before.score
    notes = () if better else (_AS_GOOD,)
    best = best if better else grid
    outcome = Outcome.FOLDED if (better and least.folded) or (not better and before.folded) else Outcome.DONE
    facts = best.with_provenance(method=METHOD, slide=slide)
    return Solution(facts, METHOD, notes=notes, outcome=outcome)


def _optima(given: Layout, *, slide: bool, iterations: int) -> Iterator[Layout]:
    """Yield the optimum with jumps evened out, if there are any, and that with all ratios kept."""
    mesh = given.mesh
    places = mesh.places
    fixed = (places.loop >= 0) & (places.partner < 0)
    fixed[places.partner[places.partner >= 0]] = False
    stays = np.zeros(len(mesh.nodes), dtype=bool) if slide else fixed
    own, even = lengths(mesh), wanted_lengths(mesh, EVEN, slide=slide)
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
            yield replace(given, mesh=optimum.mesh)
