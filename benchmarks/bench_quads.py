"""Four-sided domains by the quad network beside every way without one: folds, angles, distances, time.

    python benchmarks/bench_quads.py [--sizes 65:120,193:60,385:30] [--page docs/quad-operator.md]

Domains are the random ones of the tests, of a generator that no model was trained on, and the paper's
families. Folds are counted before the guard. Processor time of one thread, in one run.
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from gains import Way, clocked, distances, figures, gains, operate, published

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "solvers"))
from random_quads import random_quad
from solver_shapes import arch

from meshonet.formats.registry import read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.quad.coarse_grids import evaluate
from meshonet.solvers.neural.quad.edges import Edges
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
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", default="65:120,193:60,385:30", help="nodes:domains")
    parser.add_argument("--large", type=int, default=800, help="one more size, of the arch alone")
    parser.add_argument("--model", default="quad-general")
    parser.add_argument("--twin", default="quad-winslow")
    parser.add_argument("--clock", action="store_true", help="rates by the clock too, of an idle machine")
    parser.add_argument("--page", type=Path, help="markdown page to write")
    options = parser.parse_args()
    network = partial(operate, options.model)
    parts = [HEAD]
    for size in options.sizes.split(","):
        n, count = (int(word) for word in size.split(":"))
        boundaries = domains(n, count)
        parts += [angles(n, boundaries, network), to_winslow(n, boundaries, partial(operate, options.twin))]
    parts += [large(options.large, network), batches(options.model, options.clock)]
    parts += [families(options.twin), TAIL]
    text = "\n".join(parts)
    print(text)
    if options.page:
        options.page.write_text(text)


def domains(n: int, count: int) -> list[Boundary]:
    """Return random domains with n x n nodes, as many as `count` seeds give."""
    return [b for seed in range(FIRST, FIRST + count) if (b := random_quad(seed, n, n)) is not None]


def angles(n: int, boundaries: list[Boundary], network: Callable[..., Solution]) -> str:
    """Return the table of folds and angles at n x n nodes."""
    ways: dict[str, Way] = {
        "TFI": lambda b: Solution(tfi(b), "tfi"),
        "Winslow": winslow,
        "Winslow --coarse 65": partial(solve_coarse, method=winslow, n=65, smooth=True),
        "variational": variational,
        "variational --coarse 33": partial(solve_coarse, method=variational, n=33, smooth=True),
        "variational --coarse 65": partial(solve_coarse, method=variational, n=65, smooth=True),
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
        "Winslow --coarse 33": partial(solve_coarse, method=winslow, n=33, smooth=False),
        "Winslow --coarse 65": partial(solve_coarse, method=winslow, n=65, smooth=False),
        NEAR: near,
        "**quad-winslow**": partial(network, 0),
        "**quad-winslow, 1 cycle**": partial(network, 1),
        "**quad-winslow, 2 cycles**": partial(network, 2),
    }
    goals = [winslow(boundary, tol=1e-8).grid for boundary in boundaries]
    return distances(boundaries, goals, _coarser(ways, n))


def near(boundary: Boundary) -> Solution:
    """Return the grid that the network goes out from, evaluated as its own are."""
    edges = Edges.of([boundary])
    thin = edges.thinned(LATENT, LATENT)
    base = thin.interpolated(thin.laws())
    z = base[:, 0] + 1j * base[:, 1]
    middle, factor = frame(z, np)
    z = approach((z - middle) * factor, np)[0] / factor + middle
    (planes,) = evaluate(np.stack([z.real, z.imag], axis=1), edges)
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
        "variational --coarse 129": partial(solve_coarse, method=variational, n=129, smooth=True),
        "**network**": partial(network, 0),
        "**network, 5 steps**": partial(network, 5),
    }
    lines = [
        f"\n## The arch at {n} x {n}\n",
        "| way | folded | max / mean angle | CPU ms |",
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
        "\n## 64 domains together, 65 x 65\n",
        "| way | CPU ms a grid | grids a second and core | times the solves one by one |",
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
            ways[name] = partial(load, boundaries, model, polish, dtype)
    spent = dict.fromkeys(ways, np.inf)
    for _ in range(8):  # in turn: the machine's speed changes
        for name, way in ways.items():
            spent[name] = min(spent[name], clocked(way) / len(boundaries))
    first = next(iter(spent.values()))
    lines += [
        f"| {name} | {1e3 * each:.2f} | {1 / each:.0f} | {first / each:.1f} |" for name, each in spent.items()
    ]
    if clock:
        many = 4 * boundaries
        rates = [rate(partial(load, many, model, 0, "float32", n), len(many)) for n in (1, 2)]
        told = "\nBy the clock, float32: {:.0f} grids a second in one thread, {:.0f} in two."
        lines.append(told.format(*rates))
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
## The paper's families, 101 x 101, test members

Relative L2 to Winslow's solution, median, and grids with folds in brackets: Winslow's own wrenches fold.
`quad-winslow` has seen none of these shapes; the paper's models were trained on 30 members of each
([the paper, done again](paper/README.md)).

| family | quad-winslow | 1 cycle | MeshONet | MeshONet-hard |
| --- | --- | --- | --- | --- |"""
HEAD = """# The operator for four-sided domains

<!-- made by python benchmarks/bench_quads.py --page docs/quad-operator.md -->

`infer --model quad-general` makes the variational grid of any four-sided domain by one pass of a network on
33 x 33 nodes, evaluated at any resolution; `quad-winslow` is the same network's other answer, Winslow's grid.
`--polish N` takes up to N steps of descent after it (of multigrid for Winslow's): of five the first three are
steps of Newton's method on the network's own nodes, fewer where one gains little, the last two of L-BFGS on
all.

On these nodes four Picard steps from the harmonic grid go most of the way to Winslow's equations, with
differences of nearly fourth order and sine transforms for an inverse: the row "4 Picard steps", a tenth of a
millisecond in a batch. The network sees that grid and the last step, in a frame without place, turn and size,
and makes up for corners and tails, or goes on to the variational grid. Both commute with the eight
relabellings of a quad by construction, so a mirrored domain has the mirrored grid to rounding. Edges are met
bitwise. `quad-winslow` takes three more such steps after the network, on 65 x 65 nodes and extrapolated
(Anderson's method). An answer that folds is taken 95, 90 or 80 % of the way, where that does not. Grids may
fold before the guard all the same; its repairs are not in these tables.

Angles are the largest included angle of each cell, in degrees. The gain is what a way improves on Winslow's
figure, over what the full variational grid does. Processor time of one thread of a shared, busy machine.
"""
TAIL = """
## Which to use

For a single domain the coarse variational solve has the last percent of the mean angle, and it is what
`infer` does unless a model is named. For batches name `--model quad-general`: its members go through the
network together, at a fraction of the time of any solve, and `--polish 2` to 5 takes out folds and kinks.
For Winslow's grid the network earns nothing: the steps alone, with the three on 65 x 65 nodes, come as near,
and one cycle of multigrid is worth more than either.
In Python the fastest call is `load("quad-general").solve(boundaries, "off", "float32", threads=2)`: single
precision in the network, and a core for each thread; the grids do not depend on their number.

## Gradients

`meshonet.solvers.neural.differentiable.QuadGrids` is the same in torch, equal to 1e-12, with gradients from
every node to the nodes of the boundary; on a GPU with `device="cuda"`.
[`throat.py`](../examples/shape-optimisation/throat.py) finds the wall of a duct with
a given throat that leaves the least skewed cells:

![the duct, coloured by its largest angles](img/throat.png)
"""

if __name__ == "__main__":
    main()
