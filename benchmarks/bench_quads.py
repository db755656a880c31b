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
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.registry import load
from meshonet.solvers.pipeline.coarse import solve_coarse
from meshonet.solvers.solution import Solution

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
    drawn = {}
    for size in options.sizes.split(","):
        n, count = (int(word) for word in size.split(":"))
        drawn[n] = domains(n, count)
    parts = [HEAD, *(angles(n, some, network) for n, some in drawn.items())]
    parts += [large(options.large, network), batches(options.model, options.clock)]
    parts += [to_winslow(n, some, partial(operate, options.twin)) for n, some in drawn.items()]
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
        "variational": variational,
        "variational --coarse 33": partial(solve_coarse, solve=variational, n=33, smooth=True),
        "variational --coarse 65": partial(solve_coarse, solve=variational, n=65, smooth=True),
        "**quad-general --polish off**": partial(network, 0),
        "**quad-general --polish 2**": partial(network, 2),
        "**quad-general --polish 5**": partial(network, 5),
    }
    return gains(f"{len(boundaries)} random domains, {n} x {n}", boundaries, _coarser(ways, n))


def to_winslow(n: int, boundaries: list[Boundary], network: Callable[..., Solution]) -> str:
    """Return the table of distances to Winslow's solution at n x n nodes."""
    ways: dict[str, Way] = {
        "TFI": lambda b: Solution(tfi(b), "tfi"),
        "Winslow --coarse 33": partial(solve_coarse, solve=winslow, n=33, smooth=False),
        "Winslow --coarse 65": partial(solve_coarse, solve=winslow, n=65, smooth=False),
        "**quad-winslow --polish off**": partial(network, 0),
        "**quad-winslow --polish 1**": partial(network, 1),
        "**quad-winslow --polish 2**": partial(network, 2),
    }
    goals = [winslow(boundary, tol=1e-8).grid for boundary in boundaries]
    return distances(f"{len(boundaries)} domains, {n} x {n}", boundaries, goals, _coarser(ways, n))


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
        "**quad-general --polish off**": partial(network, 0),
        "**quad-general --polish 5**": partial(network, 5),
    }
    lines = [
        f"\n## An arch, {n} x {n}\n",
        "The arch is a unit square whose top side is half a sine wave.\n",
        "| method | folded cells | largest angle, degrees | mean angle, degrees | CPU time, ms |",
        "| --- | --- | --- | --- | --- |",
    ]
    for name, way in ways.items():
        runs = [figures(way, boundary) for _ in range(1 if name == "variational" else 3)]
        folds, largest, mean, spent = min(runs, key=lambda run: run[3])
        lines.append(f"| {name} | {folds} | {largest:.1f} | {mean:.2f} | {1e3 * spent:.1f} |")
    return "\n".join(lines)


def batches(model: str, clock: bool) -> str:
    """Return the table of batches at 65 x 65 nodes, in memory, with rates by the `clock` when asked."""
    boundaries = domains(65, 80)[:64]
    lines = [
        "\n## 64 domains in one batch, 65 x 65\n",
        "*float32* is single precision, *float64* double precision.\n",
        "| method | CPU time per grid, ms | speed-up over the first row |",
        "| --- | --- | --- |",
    ]
    ways: dict[str, Callable[[], object]] = {
        "variational --coarse 33, one by one": lambda: [
            solve_coarse(b, variational, 33, smooth=True) for b in boundaries
        ]
    }
    for dtype in ("float32", "float64"):
        for polish in (0, 2):
            name = f"**quad-general --polish {polish or 'off'}, {dtype}**"
            ways[name] = partial(load(model).solve, boundaries, polish, dtype=dtype)
    spent = dict.fromkeys(ways, np.inf)
    for _ in range(8):  # in turn: the machine's speed changes
        for name, way in ways.items():
            spent[name] = min(spent[name], clocked(way)[0] / len(boundaries))
    first = next(iter(spent.values()))
    lines += [f"| {name} | {1e3 * each:.2f} | {first / each:.1f} |" for name, each in spent.items()]
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
## Shapes of the MeshONet paper, 101 x 101

Each row is for six shapes of a [family](../reference/families.md). An entry is the median distance to
Winslow's solution and, in brackets, the number of grids with folded cells. *MeshONet* is the network of the
paper, *MeshONet-hard* a variant of it. Both were [trained](paper/index.md) on 30 shapes of each family,
`quad-winslow` on none. *interpolation* shapes are inside the range of the training shapes, *extrapolation*
shapes outside. Winslow's own grids of the wrench have folded cells.

| family | quad-winslow --polish off | quad-winslow --polish 1 | MeshONet | MeshONet-hard |
| --- | --- | --- | --- | --- |"""
HEAD = """# The neural operator for four-sided domains: accuracy and time

<!-- made by python benchmarks/bench_quads.py --page docs/benchmarks/quad-operator.md -->

Use this page to decide whether the grids of the neural network `quad-general` are good enough for batches of
four-sided domains. `quad-general` predicts the grid of the variational solver. The network's second
[output](../theory/operators.md), `quad-winslow`, predicts the grid of Winslow's solver. CPU times are medians
for one thread.

- *TFI*: transfinite interpolation.
- *Winslow*, *variational*: the solvers `solve-pde --method winslow` and `solve-pde --method variational`.
- *--coarse n*: the solver runs on n x n nodes, and its grid is interpolated to all nodes.
- *--polish n*: n iterations of the variational solver after `quad-general`, or n multigrid cycles of
  Winslow's solver after `quad-winslow`. *off*: none.
- *valid*: share of grids without folded cells, before repair.
- *largest angle*, *mean angle*: each cell has a largest angle. The columns give the maximum and the mean of
  these angles over the cells of a grid, averaged over the domains.
- *gain in mean angle*: 0 % is the mean angle of Winslow's grids, 100 % that of variational grids. Domains
  whose Winslow grid has folded cells do not count. A gain can exceed 100 %, because the variational method
  does not minimise the mean angle itself.
- *distance*: RMS distance of the nodes from Winslow's converged grid, divided by the RMS distance of that
  grid's nodes from their centroid.
"""
TAIL = """
## Conclusions

- **One domain**: use `solve-pde --method variational` with `--coarse 33` or 65, which takes 6 to 13 ms per
  grid, with a gain of 99 to 100 %. `quad-general --polish off` takes 2 to 5 ms, but its gain is only
  94 to 96 %.
- **Batches**: use `infer --model quad-general --polish off`. A grid takes 1.1 ms in a batch, and 8.4 ms with
  the solver. Up to 0.9 % of the grids have folded cells, which `infer` repairs. With `--polish 2` all 372
  grids of the first three tables are valid, and a grid takes 5.5 ms in a batch.
- **Single precision**: in Python `load("quad-general").solve(boundaries, "off", dtype="float32")` takes 0.6
  ms of CPU time per grid.
- **Winslow's grid**: use `solve-pde`. On 65 x 65 nodes, Winslow's solver takes 2.8 ms and `quad-winslow` 4.0
  ms. On 385 x 385 nodes, `quad-winslow` is about as fast and as accurate as *Winslow --coarse 65*.
"""

if __name__ == "__main__":
    main()
