"""Smooths planar multi-block grids: the joint optimum of all nodes, with the spacing of the given grid.

The optimum is computed by `meshonet.solvers.energy.quads`. Its targets are the aspect ratios of cells and the
ratios of neighbouring edges in the given grid (`meshonet.solvers.smoothing.layers`). Layers at the boundary
keep their heights (`meshonet.solvers.smoothing.layers`). Two optima are computed, with and without evening
out jumps of the spacing between blocks, and the better one is used. Neither the largest non-orthogonality and
skewness of a face nor the mean deviation from 90 degrees may exceed those of the given grid; if they would,
displacements are reduced.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from meshonet.geometry.arrays import Floats, shortest_ways
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.layout.from_grid import layout_of, with_nodes
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.notes import UNJUDGED
from meshonet.geometry.quality.checkmesh import cells_beyond
from meshonet.geometry.ties import first_least
from meshonet.solvers.energy.quads import FREE, optimise
from meshonet.solvers.smoothing.judge import PlaneMeasures, measures
from meshonet.solvers.smoothing.layers import wanted_lengths, with_layers
from meshonet.solvers.solution import Outcome, Solution, timed

METHOD = "variational"
EVEN = 1.3
"""Largest ratio of neighbouring edges that is not evened out."""
ITERATIONS = 300  # of the optimum, at the most
TOLERANCE = 1e-5  # relative gain of the functional at which it ends before
_AS_GOOD = "the grid is kept as it was: its optimum is no better"


@timed
def smooth(grid: Grid, *, slide: bool = False, iterations: int = ITERATIONS) -> Solution:
    """Return `grid` with its nodes moved to the optimum of all blocks; boundary nodes may `slide`.

    Raises InputError: blocks that are not planar, or do not form a domain.
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
    facts = best.with_provenance(method=METHOD, slide=slide, **UNJUDGED)
    return Solution(facts, METHOD, notes=notes, outcome=outcome)


def _optima(given: Layout, *, slide: bool, iterations: int) -> Iterator[Layout]:
    """Yield the optimum with jumps evened out, if there are any, and the optimum with all ratios kept."""
    mesh = given.mesh
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
            yield replace(given, mesh=optimum.mesh)


_ROUNDS, _GENTLE = 30, 8
"""Largest number of rounds, and the number after which nodes of bad cells are reset at once."""
_SHARES = (0.5, 0.7, 0.85)
"""Factors per round of the displacement of a bad cell's nodes, and of nodes one and two cells away."""
_SMALL = 0.02
"""Fraction of the displacement below which a node is reset."""


def held_back(grid: Grid, given: Layout, layout: Layout, before: PlaneMeasures) -> Grid | None:
    """Return `grid`, whose layout is `given`, moved towards `layout` only where it does not become worse.

    `before` are the measures of `grid`. The result is None if hardly any node would move.
    """
    part = np.ones(len(given.mesh.nodes))
    for number in range(_ROUNDS):
        made = with_nodes(grid, part_of_the_way(given, layout, part))
        now = measures(made)
        if now.no_worse(before):
            return made
        bad = np.zeros(len(part), dtype=bool)
        for block, i, j in cells_beyond(made, before.angle, before.skew):
            bad[given.blocks[block][i : i + 2, j : j + 2]] = True
        if not bad.any():  # the mean deviation, or folded cells
            bad[:] = True
        quads = given.mesh.quads
        for share in _SHARES:
            part[bad] *= share if number < _GENTLE else 0.0
            bad[quads[bad[quads].any(axis=1)].ravel()] = True  # and the nodes around them
        part[part < _SMALL] = 0.0
        if not part.any():
            break
    return None


def part_of_the_way(given: Layout, layout: Layout, part: Floats) -> Layout:
    """Return the layout with nodes at the fraction `part` (n,) between two layouts; boundary nodes slide."""
    old, mesh = given.mesh, layout.mesh
    nodes = old.nodes + part[:, None] * (mesh.nodes - old.nodes)
    arc = old.places.arc.copy()
    moved = (mesh.nodes != old.nodes).any(axis=1) & (old.places.partner < 0)
    moved[old.places.partner[old.places.partner >= 0]] = False
    on = (old.places.loop >= 0) & moved
    length = old.domain.lengths[old.places.loop[on]]
    way = shortest_ways(mesh.places.arc[on] - arc[on], length)
    arc[on] = np.mod(arc[on] + part[on] * way, length)
    nodes[on] = old.domain.at(old.places.loop[on], arc[on])
    return replace(layout, mesh=mesh.with_nodes(old.beside_partners(nodes), arc))
