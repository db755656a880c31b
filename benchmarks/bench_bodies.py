"""Bodies in far fields by the network that goes round them, beside every way without one.

    python benchmarks/bench_bodies.py [--sizes 129x65:60,401x201:10] [--page docs/benchmarks/body-operator.md]

Bodies are random ones of seeds that no model was trained on, and the paper's moving hole, whose family no
model has seen. Folds are counted before the guard. Processor time of one thread, in one run.
"""

from functools import partial

import numpy as np
from clock import clocked
from gains import Way, distances, figures, gains, operate, percent, published
from page import arguments, publish

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import SolverError
from meshonet.geometry.families.bodies import boundary as random_body
from meshonet.geometry.families.family import family
from meshonet.geometry.families.split import split
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.algebraic.resample.grids import thinned
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.registry import load
from meshonet.solvers.pipeline.coarse import solve_coarse
from meshonet.solvers.solution import Solution

SEED = 1000
"""Of the bodies here; those of training have another."""
WITHIN = "six from -0.4 to 0.4"
"""Heights of the hole that the paper's models were evaluated for."""


def main() -> None:
    """Measure and print; write the page when asked."""
    parser = arguments(__doc__)
    parser.add_argument("--sizes", default="129x65:60,401x201:10", help="NIxNJ:bodies")
    parser.add_argument("--model", default="hole-o")
    parser.add_argument("--twin", default="hole-winslow")
    options = parser.parse_args()
    parts = [HEAD]
    for size in options.sizes.split(","):
        counts, _, members = size.partition(":")
        ni, nj = (int(word) for word in counts.split("x"))
        parts += tables(bodies(ni, nj, int(members)), options.model, options.twin)
    parts += [batches(options.model), holes(options.model, options.twin), wakes(), TAIL]
    publish("\n".join(parts), options.page)


def bodies(ni: int, nj: int, count: int) -> list[Boundary]:
    """Return random boundaries with ni x nj nodes on which Winslow's equations have a solution."""
    boundaries: list[Boundary] = []
    for k in range(count):
        edges = random_body(np.random.default_rng([SEED, k]), ni, nj)
        try:
            winslow(edges)
            variational(edges, max_cycles=1)
        except SolverError:
            continue
        boundaries.append(edges)
    return boundaries


def tables(edges: list[Boundary], model: str, twin: str) -> list[str]:
    """Return the tables of angles and of distances to Winslow's solution."""
    ways: dict[str, Way] = {
        "TFI": lambda b: Solution(tfi(b), "tfi"),
        "Winslow": winslow,
        "variational": variational,
        "variational --coarse 65": partial(solve_coarse, solve=variational, n=65, smooth=True),
        f"**{model} --polish off**": partial(operate, model, 0),
        f"**{model} --polish 2**": partial(operate, model, 2),
        f"**{model} --polish 5**": partial(operate, model, 5),
    }
    to_winslow: dict[str, Way] = {
        "TFI": ways["TFI"],
        "Winslow --coarse 65": partial(solve_coarse, solve=winslow, n=65, smooth=True),
        f"**{twin} --polish off**": partial(operate, twin, 0),
        f"**{twin} --polish 2**": partial(operate, twin, 2),
    }
    goals = [winslow(one, tol=1e-8, max_cycles=60).grid for one in edges]
    title = f"bodies, {edges[0].ni} x {edges[0].nj}"
    return [
        gains(f"{len(edges)} random {title}", edges, ways),
        distances(f"{len(edges)} {title}", edges, goals, to_winslow),
    ]


def batches(model: str) -> str:
    """Return the table of batches at 65 x 33 nodes, in memory."""
    edges = [random_body(np.random.default_rng([SEED, k]), 65, 33) for k in range(32)]
    lines = ["\n## 32 bodies in one batch, 65 x 33\n", "| method | CPU time per grid, ms |", "| --- | --- |"]
    for dtype, words in (("float32", "single precision"), ("float64", "double precision")):
        spent = clocked(partial(load(model).solve, edges, 0, dtype=dtype), 5)[0] / len(edges)
        lines.append(f"| **{model} --polish off, {words}** | {1e3 * spent:.2f} |")
    return "\n".join(lines)


def holes(model: str, twin: str) -> str:
    """Return the tables of the paper's moving hole: test members of the random split, and others beyond."""
    kind = family("hole")
    drawn = [float(v) for v in np.random.default_rng(0).uniform(kind.low, kind.high, 36)]
    kept = split(drawn, "random")
    groups = {
        WITHIN: [v for v, use in zip(drawn, kept, strict=True) if use == "test"],
        "-0.5, -0.45, 0.45 and 0.5": [-0.5, -0.45, 0.45, 0.5],
    }
    lines, angles = [HOLES], [HOLE_ANGLES]
    for name, parameters in groups.items():
        edges = [kind.boundary(v, 101, 101) for v in parameters]
        goals = [winslow(one, tol=1e-8, max_cycles=60).grid for one in edges]
        cells = []
        for polish in (0, 2):
            grids = [result.grid for result in load(twin).solve(edges, polish)]
            errors = [compare(grid, goal).relative_l2 for grid, goal in zip(grids, goals, strict=True)]
            cells.append(f"{np.median(errors):.1e} ({sum(count_folded(grid.nodes) > 0 for grid in grids)})")
        judgements = [
            [figures(partial(operate, model, polish), one) for one in edges] for polish in (0, 5)
        ] + [[figures(winslow, one) for one in edges]]
        means = ["{:.1f} / {:.1f}".format(*np.array(rows)[:, 1:3].mean(axis=0)) for rows in judgements]
        paper = [published(f"hole.random.{kind}") for kind in ("meshonet.raw", "meshonet-hard.raw")]
        paper = paper if name == WITHIN else ["not evaluated", "not evaluated"]
        lines.append(f"| {name} | {' | '.join([*cells, *paper])} |")
        angles.append(f"| {name} | {' | '.join(means)} |")
    return "\n".join([*lines, *angles])


def wakes() -> str:
    """Return the table of C grids by the network for four-sided domains, which knows none."""
    ways: dict[str, Way] = {
        "TFI": lambda b: Solution(tfi(b), "tfi"),
        "Winslow": winslow,
        "variational": variational,
        "**quad-general --polish off**": partial(operate, "quad-general", 0),
        "**quad-general --polish 5**": partial(operate, "quad-general", 5),
    }
    sections = [naca(name) for name in ("0012-sharp", "2406-sharp", "4418-sharp")]
    edges = [
        thinned(section.boundary(Sampling(201, 65, "c", far_field=far)), 201, 65)
        for section in sections
        for far in (5.0, 15.0)
    ]
    lines = [WAKES]
    for name, way in ways.items():
        folds, largest, mean, spent = np.array([figures(way, one) for one in edges]).T
        lines.append(
            f"| {name} | {percent(folds == 0)} | {largest.mean():.1f} | {mean.mean():.2f} "
            f"| {1e3 * np.median(spent):.1f} |"
        )
    return "\n".join(lines)


WAKES = """
## C grids: no model

No network was trained on C grids. March them from the wall: use `infer --topology c` without `--model`.

The table gives averages over six C grids of 201 x 65 nodes: around three airfoils, each with a far field at 5
and at 15 chords. `quad-general` is the network for four-sided domains.

| method | valid, % | largest angle, degrees | mean angle, degrees | CPU time per grid, ms |
| --- | --- | --- | --- | --- |"""
HOLES = """
## Plates with a hole, from the MeshONet paper, 101 x 101

The shapes are square plates of side 2 with a round hole of radius 0.35. The *height* of its centre is 0 at
the middle of the plate. *MeshONet* is the network of the paper, *MeshONet-hard* a variant of it. Both were
[trained](paper/index.md) on 30 such plates, `hole-winslow` on none.

The first table gives the median distance to Winslow's solution and, in brackets, the number of grids with
folded cells.

| height of the hole | hole-winslow --polish off | hole-winslow --polish 2 | MeshONet | MeshONet-hard |
| --- | --- | --- | --- | --- |"""
HOLE_ANGLES = """
The second table gives the largest angle / the mean angle in degrees.

| height of the hole | hole-o --polish off | hole-o --polish 5 | Winslow |
| --- | --- | --- | --- |"""
HEAD = """# The neural operator for bodies: accuracy and time

<!-- made by python benchmarks/bench_bodies.py --page docs/benchmarks/body-operator.md -->

Read this page to decide whether the neural network `hole-o` is accurate enough for O grids around bodies.
`hole-o` predicts the grid of the variational solver. The network's second [output](../theory/operators.md),
`hole-winslow`, predicts the grid of Winslow's solver. CPU times are medians for one thread.

- *TFI*: transfinite interpolation.
- *Winslow*, *variational*: the solvers `solve-pde --method winslow` and `solve-pde --method variational`.
- *--coarse 65*: the solver runs on 65 x 65 nodes, and its grid is interpolated to all nodes.
- *--polish n*: n iterations of the variational solver after `hole-o`, or n multigrid cycles of Winslow's
  solver after `hole-winslow`. *off*: none.
- *valid*: share of grids without folded cells, before repair.
- *largest angle*, *mean angle*: each cell has a largest angle. The columns give the maximum and the mean of
  these angles over the cells of a grid, averaged over the bodies.
- *gain in mean angle*: 0 % is the mean angle of Winslow's grids, 100 % that of variational grids. Bodies
  whose Winslow grid has folded cells do not count.
- *distance*: RMS distance of the nodes from Winslow's converged grid, divided by the RMS distance of that
  grid's nodes from their centroid.

Bodies for which Winslow's or the variational solver ends with an error are left out: 2 of 40.
"""
TAIL = """
## Conclusions

- **Default**: without `--model`, `infer` makes the grid by a conformal map. It uses `hole-o` only for
  [compact bodies](../theory/operators.md) for which the computation of the map fails.
- **Quality**: all 44 grids of `hole-o --polish 5` are valid. The gain in mean angle is 93 to 96 %.
- **Time**: `hole-o --polish 5` takes about three times as long as Winslow's solver, and a third of the time
  of the variational solver.
- **Limits**: around bodies that are not compact, such as crescents and L-shaped profiles, the grids of
  `hole-o` often have folded cells without polish. With `--polish 5` all 25 grids around crescents, L-shaped
  profiles and thin plates were valid.
"""

if __name__ == "__main__":
    main()
