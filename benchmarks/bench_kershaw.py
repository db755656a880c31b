"""Kershaw's cube: cells like cubes by our descent and by TMOP of MFEM, the same functional.

    python benchmarks/bench_kershaw.py [--cells 24] [--epsilon .3] [--page docs/benchmarks/kershaw.md]

MFEM (``pip install mfem``) is needed for the rows of TMOP alone; without it they are left out. Times are
processor seconds of one thread, the least of three runs of ours and one run of TMOP.
"""

from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any

import numpy as np
from bench_volumes import quality
from clock import clocked
from page import arguments, publish

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.threads import limited_to
from meshonet.solvers.solution import Solution
from meshonet.solvers.volumes.variational import variational
from meshonet.solvers.volumes.winslow import winslow

HEAD = """# Kershaw's cube

<!-- made by python benchmarks/bench_kershaw.py --page docs/benchmarks/kershaw.md -->

Use this page to compare `solve-pde --energy shape` with TMOP, the mesh optimiser of [MFEM](https://mfem.org),
in grid quality and in CPU time of one thread. The case is Kershaw's map of the unit cube, which shears and
compresses the cells in six layers. The smaller its parameter ε, the stronger is the compression; ε = 1 gives
the uniform grid.

- *Kershaw's grid*: a uniform grid, deformed by this map. meshonet does not move its boundary nodes.
- *TMOP*: MFEM's mini-app `mesh-optimizer` with `-mid 303 -tid 1`, started from Kershaw's grid. Its Newton
  method takes at most 100 MINRES iterations per step.
- *objective*: mean over the cells of the integral of |**T**|² / (3 det(**T**)^⅔) − 1, which is 0 for cubes.
  **T** is the Jacobian matrix of the map from a reference cube to the cell, |**T**| its Frobenius norm.
  `--energy shape` and TMOP minimise this objective (metric 303 of TMOP).
- *deviation*: largest deviation from 90 degrees of the three angles at a cell corner; mean and 99th
  percentile over all corners.
- *scaled Jacobian*: minimum over the cell corners.
"""
TAIL = """
## Conclusions

- **Same minimum**: with fixed boundary nodes `--energy shape` reaches the objective 0.48074 in 0.19 s, TMOP
  reaches 0.48073 in 62.51 s.
- **Sliding boundary nodes**: TMOP with boundary nodes that slide in the faces reaches the uniform grid.
  meshonet never moves boundary nodes of a volume.
- **Default**: use `--energy angles` for angles near 90 degrees. Its mean deviation is 19.1 degrees, that of
  `--energy shape` 29.7 degrees. `--energy angles` does not penalise large aspect ratios.
"""
HEADS = (
    "| grid | objective | folded cells | minimum scaled Jacobian "
    "| deviation, degrees: mean / 99th percentile | CPU time, s |"
)
FIXED, SLIDING = "TMOP, boundary nodes fixed", "TMOP, boundary nodes slide in the faces"


def kershaw(cells: int, epsilon: float) -> Floats:
    """Return the nodes (n, n, n, 3) of Kershaw's map of the unit cube; 1 is the identity.

    Kershaw, J. Comput. Phys. 39 (1981) 375-395, in space as in MFEM.
    """
    x = np.linspace(0.0, 1.0, cells + 1)
    layer = np.minimum((6 * x + 1e-9).astype(int), 5)
    share = 6 * x - layer
    to_right = np.choose(layer, [0 * x, share, 1 - share / 2, (1 - share) / 2, share, 0 * x + 1])
    right = np.where(x <= 0.5, (2 - epsilon) * x, 1 + epsilon * (x - 1))
    left = 1 - right[::-1]
    rows = (1 - to_right[:, None]) * left + to_right[:, None] * right
    shape = cells + 1, cells + 1, cells + 1
    parts = x[:, None, None], rows[:, :, None], rows[:, None, :]
    return np.stack([np.broadcast_to(part, shape) for part in parts], axis=-1)


def lobatto() -> tuple[Floats, Floats]:
    """Return the six points of Gauss-Lobatto's rule from 0 to 1, and their weights."""
    series = np.eye(6)[5]
    inner = np.polynomial.legendre.legroots(np.polynomial.legendre.legder(series))
    points = np.concatenate([[-1.0], np.sort(inner), [1.0]])
    return (points + 1) / 2, 1 / (30 * np.polynomial.legendre.legval(points, series) ** 2)


def shape_value(nodes: Floats) -> float:
    """Return the mean of the integral of metric 303 over cells; infinite with a folded one."""
    points, weights = lobatto()
    total = 0.0
    for place in np.ndindex(6, 6, 6):
        at = [points[k] for k in place]
        columns = []
        for axis in range(3):
            edge = np.diff(nodes, axis=axis)
            for other in {0, 1, 2} - {axis}:
                low = np.take(edge, range(edge.shape[other] - 1), axis=other)
                edge = low + at[other] * np.diff(edge, axis=other)
            columns.append(edge)
        u, v, w = columns
        det = (np.cross(u, v) * w).sum(axis=-1)
        if det.min() <= 0:
            return np.inf
        squares = sum((each**2).sum(axis=-1) for each in columns)
        share = weights[place[0]] * weights[place[1]] * weights[place[2]]
        total += share * float((squares / (3 * np.cbrt(det) ** 2)).mean())
    return total - 1.0


def tmop(nodes: Floats, *, slide: bool) -> tuple[Floats, float]:
    """Return the nodes that TMOP makes of a cube's, and its seconds."""
    from mfem import ser as mfem
    from mfem._ser.tmop import TargetConstructor, TMOP_Integrator, TMOP_Metric_303
    from mfem._ser.tmop_tools import TMOPNewtonSolver

    n = len(nodes) - 1
    mesh = mfem.Mesh.MakeCartesian3D(n, n, n, mfem.Element.HEXAHEDRON, 1.0, 1.0, 1.0, False)
    collection = mfem.H1_FECollection(1, 3)
    space = mfem.FiniteElementSpace(mesh, collection, 3, mfem.Ordering.byNODES)
    mesh.SetNodalFESpace(space)
    x = mesh.GetNodes()
    values = x.GetDataArray().reshape(3, -1)
    at = tuple(np.rint(values * n).astype(int))
    values[:] = nodes[at].T
    form = mfem.NonlinearForm(space)
    target = TargetConstructor(TargetConstructor.IDEAL_SHAPE_UNIT_SIZE)
    metric, start = TMOP_Metric_303(), mfem.GridFunction(x)
    target.SetNodes(start)
    integrator = TMOP_Integrator(metric, target)
    rules = mfem.IntegrationRules(0, mfem.Quadrature1D.GaussLobatto)
    integrator.SetIntegrationRules(rules, 8)
    form.AddDomainIntegrator(integrator)
    keep: list[Any] = [collection, target, metric, integrator, start]  # the form points to them
    fixed = _fixed(at, n, slide)
    form.SetEssentialTrueDofs(mfem.intArray([space.DofToVDof(int(k), d) for k, d in fixed]))
    linear = mfem.MINRESSolver()
    linear.SetMaxIter(100)
    linear.SetRelTol(1e-12)
    linear.SetAbsTol(0.0)
    newton = TMOPNewtonSolver(rules.Get(mfem.Geometry.CUBE, 8), 0)
    newton.SetIntegrationRules(rules, 8)
    newton.SetPreconditioner(linear)
    newton.SetMaxIter(20)
    newton.SetRelTol(1e-10)
    newton.SetAbsTol(0.0)
    newton.SetPrintLevel(-1)
    newton.SetOperator(form)
    spent, _ = clocked(lambda: newton.Mult(mfem.Vector(0), x))
    made = np.empty_like(nodes)
    made[at] = x.GetDataArray().reshape(3, -1).T
    del keep
    return made, spent


def _fixed(at: tuple[Floats, ...], n: int, slide: bool) -> list[tuple[int, int]]:
    """Return nodes and directions that stay: all of nodes of faces, or those across their faces."""
    outer = [(each == 0) | (each == n) for each in at]
    rows = outer if slide else [outer[0] | outer[1] | outer[2]] * 3
    return [(int(k), axis) for axis in range(3) for k in np.flatnonzero(rows[axis])]


def timed(make: Callable[[], Solution]) -> tuple[Floats, float]:
    """Return the nodes of a solution and the least seconds of three runs."""
    spent, solution = clocked(make, 3)
    return solution.grid.nodes, spent


def rows(cells: int, epsilon: float) -> dict[str, tuple[Floats, float]]:
    """Return nodes and seconds of each grid by what it is."""
    nodes = kershaw(cells, epsilon)
    faces = SixFaces.of_block(nodes)
    made: dict[str, tuple[Floats, float]] = {"Kershaw's grid": (nodes, 0.0)}
    made["`--energy shape`"] = timed(partial(variational, faces, energy="shape"))
    made["`--energy angles`, the default"] = timed(partial(variational, faces))
    made["`--method winslow`"] = timed(partial(winslow, faces))
    if find_spec("mfem") is not None:
        made[f"{FIXED} (MFEM {version('mfem')})"] = tmop(nodes, slide=False)
        made[SLIDING] = tmop(nodes, slide=True)
    return made


def table(cells: int, epsilon: float) -> str:
    """Return the table of all grids."""
    lines = [HEADS]
    lines += ["| --- | --- | --- | --- | --- | --- |"]
    for name, (nodes, spent) in rows(cells, epsilon).items():
        folds, scaled, mean, high = quality(nodes)
        seconds = f"{spent:.2f}" if spent else ""
        value = f"{abs(shape_value(nodes)):.5f}"
        lines.append(f"| {name} | {value} | {folds} | {scaled:.3f} | {mean:.1f} / {high:.1f} | {seconds} |")
    return "\n".join(lines)


def main() -> None:
    """Print the table, or write the page."""
    parser = arguments(__doc__)
    parser.add_argument("--cells", type=int, default=24, help="a multiple of 6")
    parser.add_argument("--epsilon", type=float, default=0.3)
    chosen = parser.parse_args()
    with limited_to(1):
        made = table(chosen.cells, chosen.epsilon)
    title = f"\n## {chosen.cells} x {chosen.cells} x {chosen.cells} cells, ε = {chosen.epsilon}\n\n"
    publish(f"{HEAD}{title}{made}\n{TAIL}", chosen.page)


if __name__ == "__main__":
    main()
