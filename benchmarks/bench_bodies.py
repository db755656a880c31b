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
        "Winslow --coarse 65": partial(solve_coarse, solve=winslow, n=65, smooth=True),
        "variational": variational,
        "variational --coarse 65": partial(solve_coarse, solve=variational, n=65, smooth=True),
        "**network**": partial(operate, model, 0),
        "**network, 2 steps**": partial(operate, model, 2),
        "**network, 5 steps**": partial(operate, model, 5),
    }
    to_winslow: dict[str, Way] = {
        "TFI": ways["TFI"],
        "Winslow --coarse 65": ways["Winslow --coarse 65"],
        f"**{twin}**": partial(operate, twin, 0),
        f"**{twin}, 2 cycles**": partial(operate, twin, 2),
    }
    goals = [winslow(one, tol=1e-8, max_cycles=60).grid for one in edges]
    title = f"{len(edges)} random bodies, {edges[0].ni} x {edges[0].nj}"
    return [gains(title, edges, ways), distances(edges, goals, to_winslow)]


def batches(model: str) -> str:
    """Return the table of batches at 65 x 33 nodes, in memory."""
    edges = [random_body(np.random.default_rng([SEED, k]), 65, 33) for k in range(32)]
    lines = ["\n## 32 bodies in one batch, 65 x 33\n", "| method | CPU ms per grid |", "| --- | --- |"]
    for dtype in ("float32", "float64"):
        spent = clocked(partial(load(model).solve, edges, 0, dtype=dtype), 5)[0] / len(edges)
        lines.append(f"| **network in {dtype}** | {1e3 * spent:.2f} |")
    return "\n".join(lines)


def holes(model: str, twin: str) -> str:
    """Return the table of the paper's moving hole: test members of the random split, and beyond the range."""
    kind = family("hole")
    drawn = [float(v) for v in np.random.default_rng(0).uniform(kind.low, kind.high, 36)]
    kept = split(drawn, "random")
    groups = {
        "random": [v for v, use in zip(drawn, kept, strict=True) if use == "test"],
        "outside the range, to 0.5": [-0.5, -0.45, 0.45, 0.5],
    }
    lines = [HOLES]
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
        angles = ["{:.1f} / {:.1f}".format(*np.array(rows)[:, 1:3].mean(axis=0)) for rows in judgements]
        paper = [published(f"hole.random.{kind}") for kind in ("meshonet.raw", "meshonet-hard.raw")]
        paper = paper if name == "random" else ["", ""]
        lines.append(f"| {name} | {' | '.join([*cells, *paper, *angles])} |")
    return "\n".join(lines)


def wakes() -> str:
    """Return the table of C grids by the network for four-sided domains, which knows none."""
    ways: dict[str, Way] = {
        "TFI": lambda b: Solution(tfi(b), "tfi"),
        "Winslow": winslow,
        "variational": variational,
        "**quad-general**": partial(operate, "quad-general", 0),
        "**quad-general, 5 steps**": partial(operate, "quad-general", 5),
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
            f"| {name} | {percent(folds == 0)} | {largest.mean():.1f} / {mean.mean():.2f} "
            f"| {1e3 * np.median(spent):.1f} |"
        )
    return "\n".join(lines)


WAKES = """
## C grids: no model

A C grid is a four-sided domain whose south side consists of wake, airfoil and wake. The table gives averages
over six grids of 201 x 65 nodes: around three airfoils, each with a far field at 5 and at 15 chords. The
network for four-sided domains, `quad-general`, was not trained on such domains. It works on 33 nodes per
side, which are too few for the long south side. Without iterations its grids are worse than those of
transfinite interpolation (TFI). meshonet has no model for C grids; `infer` marches C grids from the wall.

| method | valid % | max / mean angle, average | CPU ms, median |
| --- | --- | --- | --- |"""
HOLES = """
## The moving hole of the MeshONet paper, 101 x 101

The shapes are plates of 2 x 2 with a round hole of radius 0.35. The height of the centre of the hole,
measured from the middle of the plate, is between -0.4 and 0.4 in the row *random*, and -0.5, -0.45, 0.45 or
0.5 in the second row. The paper's models were not evaluated for the second row.

The columns from `hole-winslow` to MeshONet-hard give the median relative L2 distance to Winslow's solution
and, in brackets, the number of grids with folded cells. The last three columns give the maximum / mean angle,
averaged over the grids. The network was not trained on such plates. The paper's models were trained on 30 of
these plates ([the reproduction](paper/index.md)).

| split | hole-winslow | 2 cycles | MeshONet | MeshONet-hard | hole-o | hole-o, 5 steps | Winslow |
| --- | --- | --- | --- | --- | --- | --- | --- |"""
HEAD = """# The neural operator for bodies: accuracy and time

<!-- made by python benchmarks/bench_bodies.py --page docs/benchmarks/body-operator.md -->

Read this page to decide whether the neural network `hole-o` is accurate enough for your O grids around
bodies. For the method see [neural operators](../theory/operators.md).

- The network `hole-o` (*network* in the tables) predicts the variational O grid. `hole-winslow`, a second
  output of the same network, predicts Winslow's grid. *n steps* and *n cycles* mean `--polish n`: n
  iterations of the variational method, or n multigrid cycles for Winslow's equations, follow the network.
- The network was trained for only about nine minutes on one core: six epochs with 5,710 random bodies.
- *valid*: share of grids without a folded cell, before repair.
- *no worse than Winslow*: share of grids that are valid and have neither a larger maximum nor a larger mean
  angle than Winslow's grid.
- *max / mean angle*: each cell has a largest corner angle. The columns give the maximum and the mean of this
  angle over the cells, in degrees, averaged over the bodies.
- *gain*: by how much the angle is smaller than in Winslow's grid, in percent of the same difference for the
  variational grid. *all*: both differences are summed over the bodies before the division; the gain in the
  largest angle is computed in this way. *median*: median over the bodies of the gain of each body.
- Bodies for which Winslow's iteration does not converge, a few in a hundred, are left out.
- *CPU ms*: CPU time of one thread, while other programs used the machine.
"""
TAIL = """
## Conclusions

- `infer` without `--model` uses `hole-o` for compact bodies for which the conformal map fails. If the grid of
  the network on 65 x 33 nodes has folded cells, the elliptic solver generates the grid instead.
- With five iterations after the network, all grids are valid, and the angles are closer to 90 degrees than in
  Winslow's grids. A quarter of Winslow's grids have folded cells before repair. Network and iterations take
  about three times as long as Winslow's method.
- `solve-pde --method variational` gives the angles closest to 90 degrees, and takes about three times as long
  as the network with five iterations.
- In the grids of the network and of the variational method, grid lines cluster where a body is close to its
  far field.
- For smooth bodies in a round far field and for thin bodies `infer` uses the conformal map and no network.
- The network was not trained on bodies whose centroid lies outside the body, such as clips, crescents and
  angle sections. Its grids around these bodies often have folded cells, which five iterations or the repair
  remove. For 25 plates, crescents and angle sections, all grids were valid after the iterations.
"""

if __name__ == "__main__":
    main()
