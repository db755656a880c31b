"""Joint optimisation of all nodes of a multi-block quad mesh with the functional of `energy.functional`.

Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, ACM Trans. Graph. 40 (2021) 154 (untangling).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Bools, Floats
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.energy.quad_problem import ALLOWED, Problem, smallest_jacobian, unknowns_of
from meshonet.solvers.energy.walls import walls_of

FREE = 0.9, 2e-3  # w and β of the functional
# The same where lengths are wanted: with ten times the β they follow no better, and around layers of real
# sections the mean deviation of angles from 90 degrees is a third larger.
SIZED = 0.97, 2e-4

UNFOLDING = 0.0, 0.3  # w, and the weight of areas, while folded: angles would hold on to folds
ROUNDS = 14  # regularisations at the most
FIRST_ROUND, PER_ROUND = 80, 40  # iterations with the first, and with each other
GAIN = 1e-5  # relative, in two iterations in a row, below which a round ends


@dataclass(frozen=True, eq=False)
class QuadOptimum:
    """Result of `optimise`."""

    mesh: QuadMesh
    valid: bool  # whether all corner Jacobians are positive and wall nodes are in order
    value: float  # value of the functional, infinite if the mesh is not valid
    iterations: int


def optimise(
    mesh: QuadMesh, *, iterations: int = 60, held: Bools | None = None, aspects: Floats | None = None,
    targets: Floats | None = None, tolerance: float = 1e-4, turning: float = ALLOWED,
    weights: tuple[float, float] = SIZED, growth: tuple[float, float] = (0.0, 0.0),
) -> QuadOptimum:  # fmt: skip
    """Return the mesh with nodes moved for optimal angles and edge lengths; wall nodes slide along walls.

    Periodic partners move together. Cells without free nodes are ignored, but must not be folded. The
    smoothness term compares the length of each edge with those of the opposite edges of its cells, and of the
    next edges on the same grid line.

    Parameters
    ----------
    iterations : greatest number of iterations; iterations of untangling are not counted.
    held : (n,) mask of fixed nodes; corners of the domain are fixed anyway.
    aspects : (m,) for each cell, target length of its sides 1-2 and 0-3 divided by that of sides 0-1 and 3-2.
    targets : (e,) target lengths of `mesh.edges` in any unit, because only ratios of neighbours matter.
    tolerance : the iteration ends after two consecutive relative gains below a hundredth of this.
    turning : angle in radians; wall edges along which the wall's direction changes by more are penalised.
    weights : weights of angles and of smoothness, used only with `targets` or with a penalty for growth.
    growth : weight of a penalty for growth ratios, and the logarithm of the largest ratio without penalty.
    """
    problem = problem_of(mesh, held, aspects, targets, turning)
    if problem is None:
        return QuadOptimum(mesh, False, np.inf, 0)
    steps = (weights,) if growth[0] > 0.0 else (FREE,) if targets is None else (FREE, weights)
    return minimise(problem, iterations, tolerance, steps, growth)


def problem_of(
    mesh: QuadMesh, held: Bools | None, aspects: Floats | None = None, targets: Floats | None = None,
    turning: float = ALLOWED,
) -> Problem | None:  # fmt: skip
    """Return the minimisation over the nodes of a mesh; parameters as in `optimise`.

    Returns None if the fixed wall nodes are not in order along the wall.
    """
    unknowns = unknowns_of(mesh, held)
    walls = walls_of(mesh, unknowns.fixed, unknowns.tied)
    return Problem(mesh, unknowns, walls, aspects, targets, turning) if walls else None


def minimise(
    problem: Problem, iterations: int, tolerance: float, steps: Sequence[tuple[float, float]],
    growth: tuple[float, float],
) -> QuadOptimum:  # fmt: skip
    """Return the mesh of `problem` with its nodes at the minimum of a functional of cell shapes.

    `steps` has the weights w and β (see `optimise`) of functionals that are minimised in this order. Other
    parameters are as in `optimise`.
    """
    low, done = problem.smallest(), 0
    if low <= 0.0:
        low, done = _unfold(problem, low)
    value = np.inf
    for own in steps:
        if low > 0.0:
            value, low, more = problem.descent.run(
                *own, 0.0, 0.0, 0.01 * tolerance, iterations, True, *growth
            )
            done += more
    moved = problem.result()
    valid = low > 0.0 and smallest_jacobian(moved.nodes, moved.quads) > 0.0
    return QuadOptimum(moved, valid, value if valid else np.inf, done)


def _unfold(problem: Problem, low: float) -> tuple[float, int]:
    """Minimise with decreasing regularisation of the Jacobians; return the smallest one, and the iterations.

    `low` is the initial smallest Jacobian relative to its cell's area.
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
