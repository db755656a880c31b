"""Four-sided domains by the quad network beside every way without one: folds, angles, distances, time.

    python benchmarks/bench_quads.py [--sizes 65:120,193:60,385:30] [--page docs/benchmarks/quad-operator.md]

Domains are the random ones of the tests, of a generator that no model was trained on, and the paper's
families. Folds are counted before the guard. Processor time of one thread, in one run.
"""

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from clock import clocked
from gains import Way, distances, figures, gains, operate, published
from page import arguments, publish

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "solvers"))
from random_quads import random_quad
from solver_shapes import arch

from meshonet.formats.registry import read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.algebraic.resample.quad import refine_quad
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.quad.coarse_grids import sides_of, thinned, transfinite
from meshonet.solvers.neural.quad.encoding import LATENT, frame
from meshonet.solvers.neural.quad.picard import approach
from meshonet.solvers.neural.registry import load
from meshonet.solvers.pipeline.coarse import solve_coarse
from meshonet.solvers.solution import Solution

NEAR = "4 Picard steps, 33"

FIRST = 1000
"""Seed of the first random domain."""


def main() -> None:
    """Measure and print; write the page when asked."""
    parser = arguments(__doc__)
    parser.add_argument("--sizes", default="65:120,193:60,385:30", help="nodes:domains")
    parser.add_argument("--large", type=int, default=800, help="one more size, of the arch alone")
    parser.add_argument("--model", default="quad-general")
    parser.add_argument("--twin", default="quad-winslow")
    parser.add_argument("--clock", action="store_true", help="rates by the clock too, of an idle machine")
    options = parser.parse_args()
    network = partial(operate, options.model)
    parts = [HEAD]
    for size in options.sizes.split(","):
        n, count = (int(word) for word in size.split(":"))
        boundaries = domains(n, count)
        parts += [angles(n, boundaries, network), to_winslow(n, boundaries, partial(operate, options.twin))]
    parts += [large(options.large, network), batches(options.model, options.clock)]
    parts += [families(options.twin), TAIL]
    publish("\n".join(parts), options.page)


def domains(n: int, count: int) -> list[Boundary]:
    """Return random domains with n x n nodes, as many as `count` seeds give."""
    return [b for seed in range(FIRST, FIRST + count) if (b := random_quad(seed, n, n)) is not None]


def angles(n: int, boundaries: list[Boundary], network: Callable[..., Solution]) -> str:
    """Return the table of folds and angles at n x n nodes."""
    ways: dict[str, Way] = {
        "TFI": lambda b: Solution(tfi(b), "tfi"),
        "Winslow": winslow,
        "Winslow --coarse 65": partial(solve_coarse, solve=winslow, n=65, smooth=True),
        "variational": variational,
        "variational --coarse 33": partial(solve_coarse, solve=variational, n=33, smooth=True),
        "variational --coarse 65": partial(solve_coarse, solve=variational, n=65, smooth=True),
        NEAR: near,
        "**network**": partial(network, 0),
        "**network, 2 steps**": partial(network, 2),
        "**network, 5 steps**": partial(network, 5),
    }
    return gains(f"{len(boundaries)} random domains, {n} x {n}", boundaries, _coarser(ways, n))


def to_winslow(n: int, boundaries: list[Boundary], network: Callable[..., Solution]) -> str:
    """Return the table of distances to Winslow's solution at n x n nodes."""
    ways: dict[str, Way] = {
        "TFI": lambda b: Solution(tfi(b), "tfi"),
        "Winslow --coarse 33": partial(solve_coarse, solve=winslow, n=33, smooth=False),
        "Winslow --coarse 65": partial(solve_coarse, solve=winslow, n=65, smooth=False),
        NEAR: near,
        "**quad-winslow**": partial(network, 0),
        "**quad-winslow, 1 cycle**": partial(network, 1),
        "**quad-winslow, 2 cycles**": partial(network, 2),
    }
    goals = [winslow(boundary, tol=1e-8).grid for boundary in boundaries]
    return distances(boundaries, goals, _coarser(ways, n))


def near(boundary: Boundary) -> Solution:
    """Return the grid that the network goes out from, evaluated as its own are."""
    sides = sides_of([boundary])
    base = transfinite(thinned(sides, LATENT, LATENT))
    z = base[:, 0] + 1j * base[:, 1]
    middle, factor = frame(z, np)
    z = approach((z - middle) * factor, np)[0] / factor + middle
    (planes,) = refine_quad(np.stack([z.real, z.imag], axis=1), sides)
    return Solution(
        Grid.from_nodes(np.ascontiguousarray(np.moveaxis(planes, 0, -1)), "quad", boundary.patches), "picard"
    )


def _coarser(ways: dict[str, Way], n: int) -> dict[str, Way]:
    """Return the ways that solve on fewer than n nodes, or on all."""
    return {name: way for name, way in ways.items() if n > 65 or not name.endswith("65")}


def large(n: int, network: Callable[..., Solution]) -> str:
    """Return the table of the arch at n x n nodes."""
    boundary = arch(n, n)
    ways: dict[str, Way] = {
        "Winslow": winslow,
        "variational": variational,
        "variational --coarse 129": partial(solve_coarse, solve=variational, n=129, smooth=True),
        "**network**": partial(network, 0),
        "**network, 5 steps**": partial(network, 5),
    }
    lines = [
        f"\n## The arch at {n} x {n}\n",
        "| method | folded | max / mean angle | CPU ms |",
        "| --- | --- | --- | --- |",
    ]
    for name, way in ways.items():
        runs = [figures(way, boundary) for _ in range(1 if name == "variational" else 3)]
        folds, largest, mean, spent = min(runs, key=lambda run: run[3])
        lines.append(f"| {name} | {folds} | {largest:.1f} / {mean:.2f} | {1e3 * spent:.1f} |")
    return "\n".join(lines)


def batches(model: str, clock: bool) -> str:
    """Return the table of batches at 65 x 65 nodes, in memory, with rates by the `clock` when asked."""
    boundaries = domains(65, 80)[:64]
    lines = [
        "\n## 64 domains in one batch, 65 x 65\n",
        "| method | CPU ms per grid | grids per second on one core | speed-up over the first row |",
        "| --- | --- | --- | --- |",
    ]
    ways: dict[str, Callable[[], object]] = {
        "variational --coarse 33, one by one": lambda: [
            solve_coarse(b, variational, 33, smooth=True) for b in boundaries
        ]
    }
    for dtype in ("float32", "float64"):
        for polish in (0, 2):
            name = f"**network in {dtype}, {polish} steps**"
            ways[name] = partial(load(model).solve, boundaries, polish, dtype=dtype)
    spent = dict.fromkeys(ways, np.inf)
    for _ in range(8):  # in turn: the machine's speed changes
        for name, way in ways.items():
            spent[name] = min(spent[name], clocked(way)[0] / len(boundaries))
    first = next(iter(spent.values()))
    lines += [
        f"| {name} | {1e3 * each:.2f} | {1 / each:.0f} | {first / each:.1f} |" for name, each in spent.items()
    ]
    if clock:
        many = 4 * boundaries
        solve = partial(load(model).solve, many, 0, dtype="float32")
        rates = [rate(partial(solve, threads=n), len(many)) for n in (1, 2)]
        message = "\nBy the clock, float32: {:.0f} grids a second in one thread, {:.0f} in two."
        lines.append(message.format(*rates))
    return "\n".join(lines)


def rate(call: Callable[[], object], count: int) -> float:
    """Return how many of `count` things `call` makes a second by the clock, at its best."""
    seconds = []
    for _ in range(8):
        begun = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - begun)
    return count / min(seconds)


def families(twin: str) -> str:
    """Return the table of the paper's families: the twin, never shown them, beside a model of each."""
    lines = [FAMILIES]
    for name in ("arch", "hexagon", "wrench", "semicircle"):
        for split in ("interpolation", "extrapolation"):
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "test.h5"
                words = [
                    "--family",
                    name,
                    "--count",
                    "36",
                    "--res",
                    "101",
                    "--split",
                    split,
                    "-o",
                    str(path),
                    "-q",
                ]
                subprocess.run([sys.executable, "-m", "meshonet_cli", "sample-boundary", *words], check=True)
                boundaries = list(read_shapes(f"{path}#test"))
            goals = [winslow(b, tol=1e-8).grid for b in boundaries]
            cells = []
            for polish in (0, 1):
                grids = [solution.grid for solution in load(twin).solve(boundaries, polish)]
                errors = [compare(grid, goal).relative_l2 for grid, goal in zip(grids, goals, strict=True)]
                folded = sum(count_folded(grid.nodes) > 0 for grid in grids)
                cells.append(f"{np.median(errors):.1e} ({folded})")
            raw = {
                kind: published(f"{name}.{split}.{kind}") for kind in ("meshonet.raw", "meshonet-hard.raw")
            }
            lines.append(f"| {name}, {split} | {' | '.join(cells)} | {' | '.join(raw.values())} |")
    return "\n".join(lines)


FAMILIES = """
## The families of the MeshONet paper, 101 x 101, test members

Each row is for six test members of a family, inside (*interpolation*) or outside (*extrapolation*) the
range of training of the paper's models. The table gives the median relative L2 distance to Winslow's
solution and, in brackets, the number of grids with folded cells. Winslow's own grids of the wrench have
folded cells. `quad-winslow` was not trained on these shapes. The paper's models, MeshONet and
MeshONet-hard, were trained on 30 members of each family ([the reproduction](paper/index.md)).

| family | quad-winslow | 1 cycle | MeshONet | MeshONet-hard |
| --- | --- | --- | --- | --- |"""
HEAD = """# The neural operator for four-sided domains: accuracy and time

<!-- made by python benchmarks/bench_quads.py --page docs/benchmarks/quad-operator.md -->

Use this page to decide whether the accuracy of `infer --model quad-general` suffices for batches of
four-sided domains. For the method see [neural operators](../theory/operators.md).

- `quad-general` predicts the variational grid, `quad-winslow` Winslow's grid. *n steps* and *n cycles* are
  `--polish n`: iterations of the variational method, or multigrid cycles for Winslow's grid.
- *TFI*: transfinite interpolation. *--coarse n*: the solver runs on n x n nodes; its grid is interpolated.
- *4 Picard steps, 33*: the grid to which the network adds a correction, from four Picard steps for Winslow's
  equations on 33 x 33 nodes.
- *valid*: share of grids without a folded cell, before repair.
- *no worse than Winslow*: share of grids that are valid, and in which neither the maximum nor the mean angle
  is larger than in Winslow's grid.
- *angle*: largest included angle of each cell, in degrees. The tables give the maximum and the mean over
  the cells, averaged over the domains.
- *gain*: (Winslow's angle - angle) / (Winslow's angle - angle of the row *variational*), in percent.
  *all*: ratio of the sums over all domains. *median*: median of the ratios of the single domains.
- *CPU ms*: CPU time of one thread, while other programs used the machine.
"""
TAIL = """
## Conclusions

- **One domain**: use no network. Without `--model`, `infer` minimises the functional on fewer nodes
  (`--coarse`) and reaches 99 to 100 % of the gain in mean angle.
- **Batches**: use `--model quad-general`. The network evaluates all domains together, in a fraction of the
  time of any solver. `--polish 2` to `5` removes folded cells.
- **Winslow's grid**: the network has no advantage. On 65 x 65 nodes, multigrid solves the equations in less
  time than `quad-winslow` needs for its prediction. On more nodes, `solve-pde --coarse 65` takes about the
  same time as `quad-winslow`, and its grids are about as close to the solution.
- **Python**: the fastest call is `load("quad-general").solve(boundaries, "off", dtype="float32",
  threads=2)`. `"off"` omits the iterations after the network, which runs in single precision on two cores.
  The grids do not depend on the number of threads.
"""

if __name__ == "__main__":
    main()
