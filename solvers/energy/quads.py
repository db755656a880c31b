"""The joint optimum of a quad mesh: one functional over all cells of all blocks, one descent of all nodes.

The functional is that of `meshonet.solvers.energy.functional` in the corners of cells, with the squared
differences of log lengths over all pairs of edges that follow or face each other along a grid line, across
interfaces as inside of blocks. Nodes of interfaces and singular vertices are unknowns like any other; wall
nodes slide along their loops, in order, and edges of walls that turn too much are held back:
angles alone are best where tips are cut off.

Folded meshes are unfolded first, with Jacobians regularised; cells that could then gain by shrinking to
points are held to their areas.

Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, ACM Trans. Graph. 40 (2021) 154 (unfolding with area
and shape).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.energy.quad_problem import ALLOWED, Problem, smallest_jacobian, unknowns_of
from meshonet.solvers.energy.walls import Bools, walls_of

FREE = 0.9, 2e-3  # w and β of the functional
# The same where lengths are wanted: with ten times the β they follow no better, and around layers of real
# sections the mean deviation of angles from 90 degrees is a third larger.
SIZED = 0.97, 2e-4

UNFOLDING = 0.0, 0.3  # w, and the weight of areas, while folded: angles would hold on to folds
ROUNDS = 14  # regularisations at the most
FIRST_ROUND, PER_ROUND = 80, 40  # iterations with the first, and with each other
GAIN = 1e-5  # relative, in three iterations in a row, below which a round ends


@dataclass(frozen=True, eq=False)
class QuadOptimum:
    """What `optimise` ends with."""

    mesh: QuadMesh
    valid: bool
    """Whether all corner Jacobians are positive and wall nodes are in order."""
    value: float
    """Of the functional, infinite where the mesh is not valid."""
    iterations: int


def optimise(
    mesh: QuadMesh, *, iterations: int = 60, held: Bools | None = None, aspects: Floats | None = None,
    targets: Floats | None = None, tolerance: float = 1e-4, turning: float = ALLOWED,
    weights: tuple[float, float] = SIZED,
) -> QuadOptimum:  # fmt: skip
    """Return the mesh with all nodes moved to where the functional is least.

    Corners (`Places.cells` > 0) and `held` nodes (n,) stay bitwise; a node with a partner is where that one
    is, moved by the domain's period, and both move freely. `aspects` (m,) are the wanted ratios of the sides
    1-2 and 0-3 of a quad to 0-1 and 3-2; `targets` (e,), for `mesh.edges`, lengths in any unit whose ratios
    those of neighbouring edges should have. Edges along which a wall turns by more than `turning` radians are
    held back. It ends after so many `iterations`, not counting those of unfolding, or when three in a row
    gain less than a hundredth of `tolerance` of the value. Cells
    with no node that moves are left out, but a mesh where one of them is folded is not valid. `weights`
    are w and β of the functional where there are `targets`.
    """
    unknowns = unknowns_of(mesh, held)
    walls = walls_of(mesh, unknowns.fixed, unknowns.tied)
    if walls is None:
        return QuadOptimum(mesh, False, np.inf, 0)
    problem = Problem(mesh, unknowns, walls, aspects, targets, turning)
    low, done = problem.smallest(), 0
    if low <= 0.0:
        low, done = _unfold(problem, low)
    value = np.inf
    for own in (FREE,) if targets is None or weights == FREE else (FREE, weights):
        if low > 0.0:
            value, low, more = problem.descent.run(*own, 0.0, 0.0, 0.01 * tolerance, iterations, True)
            done += more
    moved = problem.result()
    valid = low > 0.0 and smallest_jacobian(moved.nodes, moved.quads) > 0.0
    return QuadOptimum(moved, valid, value if valid else np.inf, done)


def _unfold(problem: Problem, low: float) -> tuple[float, int]:
    """Descend with less and less regularised Jacobians; return the smallest Jacobian, and the iterations.

    `low` is the smallest one at first, over its cell's area; once none is negative it is done.
    """
    done, epsilon = 0, max(0.3, min(2.0 * abs(low), 3.0))
    shape, size = UNFOLDING
    for number in range(ROUNDS):
        most = PER_ROUND if number else FIRST_ROUND
        _, low, more = problem.descent.run(shape, FREE[1], epsilon, size, GAIN, most, True)
        done += more
        if low > 0.0:
            break
        epsilon *= 0.5
        if number < ROUNDS // 2:
            epsilon = min(epsilon, 2.0 * abs(low) + 1e-3)
        epsilon = max(epsilon, 1e-4)
    return low, done
