"""Joint optimisation of all nodes of a multi-block quad mesh with one functional.

The functional is that of `meshonet.solvers.energy.functional` at the corners of cells. Its smoothness term is
the squared differences of log lengths of neighbouring edges along and across grid lines, also across
interfaces. Nodes of interfaces and singular vertices are unknowns like all others. Wall nodes slide along
their loops without overtaking each other. A penalty limits the turning of a wall along one edge, because
otherwise wall nodes would leave rounded tips, which improves angles.

Folded meshes are first untangled with regularised Jacobians; a term for their areas keeps cells from
shrinking to points.

Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, ACM Trans. Graph. 40 (2021) 154 (untangling with area
and shape).
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
GAIN = 1e-5  # relative, in three iterations in a row, below which a round ends


@dataclass(frozen=True, eq=False)
class QuadOptimum:
    """Result of `optimise`."""

    mesh: QuadMesh
    valid: bool
    """Whether all corner Jacobians are positive and wall nodes are in order."""
    value: float
    """Value of the functional, infinite if the mesh is not valid."""
    iterations: int


def optimise(
    mesh: QuadMesh, *, iterations: int = 60, held: Bools | None = None, aspects: Floats | None = None,
    targets: Floats | None = None, tolerance: float = 1e-4, turning: float = ALLOWED,
    weights: tuple[float, float] = SIZED, growth: tuple[float, float] = (0.0, 0.0),
) -> QuadOptimum:  # fmt: skip
    """Return the mesh with all nodes at the minimum of the functional.

    Corners (`Places.cells` > 0) and `held` nodes (n,) are bitwise unchanged. A node with a periodic partner
    is at the partner's position plus the period of the domain; both move. `aspects` (m,) are, for each quad,
    the target ratios of its sides 1-2 and 0-3 to its sides 0-1 and 3-2. `targets` (e,), for `mesh.edges`, are
    lengths in any unit: the ratios of neighbouring edges should be those of their targets. Edges along which
    a wall turns by more than `turning` radians are penalised. The minimisation ends after `iterations`, not
    including those of untangling, or if three consecutive iterations gain less than a hundredth of
    `tolerance` times the value. Cells without free nodes are ignored, but if one of them is folded, the mesh
    is not valid. `weights` are w and β of the functional if there are `targets` or if growth is penalised.
    `growth` has two values: the weight of the penalty for ratios of consecutive edges, and the logarithm of
    the ratio above which it applies.
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
    """Return the minimisation over the nodes of a mesh (see `optimise`).

    Returns None if the fixed wall nodes are not in order along the wall.
    """
    unknowns = unknowns_of(mesh, held)
    walls = walls_of(mesh, unknowns.fixed, unknowns.tied)
    return Problem(mesh, unknowns, walls, aspects, targets, turning) if walls else None


def minimise(
    problem: Problem, iterations: int, tolerance: float, steps: Sequence[tuple[float, float]],
    growth: tuple[float, float],
) -> QuadOptimum:  # fmt: skip
    """Return the mesh of a problem with all nodes at the minimum; see `optimise`.

    `steps` has w and β of each functional; the functionals are minimised one after another.
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

    `low` is the initial smallest Jacobian relative to its cell's area. The iteration ends when all are
    positive.
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
