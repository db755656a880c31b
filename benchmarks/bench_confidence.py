"""Expected errors of networks' answers beside their true errors, on kinds of shapes that no network has seen.

    python benchmarks/bench_confidence.py [--count 40] [--page docs/benchmarks/confidence.md]

Shapes are those of benchmarks/yardstick. The trained network is `meshonet`, which learns arches and is asked
for other shapes too. A picture of all answers is written beside the page.
"""

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from page import arguments, publish
from scipy.stats import spearmanr
from yardstick.shapes import BODIES, KINDS, shapes

import meshonet
from meshonet import layer
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.confidence import THRESHOLD
from meshonet.solvers.neural.operator import Operator
from meshonet.solvers.neural.registry import load

SEED = 7


def _conformal(boundary: Boundary) -> Floats:
    walls = torch.tensor(boundary.south), torch.tensor(boundary.north)
    return layer.conformal(*walls, boundary.nj).numpy()


QUADS = tuple(kind for kind in KINDS if kind not in BODIES)
EXACT: dict[str, Callable[[Boundary], Grid]] = {
    "variational": lambda boundary: variational(boundary).grid,
    "winslow": lambda boundary: winslow(boundary, tol=1e-8).grid,
    "conformal": lambda boundary: boundary.grid(_conformal(boundary), {}),
}
"""The grids that networks imitate, to more accuracy than their answers have."""


@dataclass(frozen=True)
class Answer:
    """Errors of an answer, its number of folded cells, and the processor seconds of the estimate."""

    true: float
    expected: float
    folded: int
    seconds: float


def main() -> None:
    """Measure, print, and write the page and its picture."""
    parser = arguments(__doc__)
    parser.add_argument("--count", type=int, default=40, help="shapes of each kind")
    parser.add_argument("--epochs", type=int, default=2000, help="of the trained network")
    options = parser.parse_args()
    groups: dict[str, list[Answer]] = {}
    quads, bodies = (list(_drawn(kinds, options.count, nj)) for kinds, nj in ((QUADS, 65), (BODIES, 33)))
    for polish in ("auto", "off"):
        for model, drawn in (("quad-general", quads), ("hole-o", bodies), ("airfoil-o", bodies)):
            groups[f"`{model}`, `--polish {polish}`"] = list(answers(load(model), drawn, polish))
    trained = _trained(options.epochs)
    groups["`meshonet`, trained on arches"] = list(answers(trained, _others(options.count), "auto"))
    publish(
        "\n".join([HEAD.format(count=options.count, threshold=THRESHOLD), *COLUMNS, *rows(groups), TAIL]),
        options.page,
    )
    if options.page:
        draw(groups, options.page.with_suffix(".png"))


def answers(operator: Operator, boundaries: Iterable[Boundary], polish: str) -> Iterator[Answer]:
    """Yield the errors of an operator's answers; shapes for which there is no solution are left out."""
    for boundary in boundaries:
        try:
            exact = EXACT[operator.goal](boundary)
            solution = operator.solve([boundary], polish)[0]  # type: ignore[arg-type]
        except MeshonetError:
            continue
        if solution.model is None:
            continue
        begun = time.process_time()
        expected = operator.expected_error(boundary, solution)
        spent = time.process_time() - begun
        true = compare(solution.grid, exact).relative_l2
        yield Answer(true, expected, count_folded(solution.grid.nodes), spent)


def rows(groups: dict[str, list[Answer]]) -> Iterator[str]:
    """Yield the rows of the table."""
    for name, group in groups.items():
        true, expected = np.array([(a.true, a.expected) for a in group]).T
        folded = np.array([a.folded > 0 for a in group])
        low = expected <= THRESHOLD
        known = np.isfinite(expected)
        ratio = np.percentile(expected[known] / true[known], (5, 50, 95))
        cells = [
            name, f"{len(group)}", f"{np.median(true):.1e}", f"{true.max():.1e}",
            f"{spearmanr(true, expected)[0]:.2f}", " / ".join(f"{part:.2f}" for part in ratio),
            f"{low.sum()}", f"{(low & folded).sum()}", f"{(~low).sum()}", f"{(~low & folded).sum()}",
            f"{1e3 * np.median([a.seconds for a in group]):.1f}",
        ]  # fmt: skip
        yield "| " + " | ".join(cells) + " |"


def draw(groups: dict[str, list[Answer]], path: Path) -> None:
    """Draw true over expected errors."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(6.5, 5), layout="constrained")
    for k, (name, group) in enumerate(groups.items()):
        known = [a for a in group if np.isfinite(a.expected)]
        at = [a.expected for a in known], [a.true for a in known]
        axes.loglog(*at, ".", ms=4, color=f"C{k}", alpha=0.6, label=name.replace("`", ""))
        bad = [a for a in known if a.folded]
        axes.loglog([a.expected for a in bad], [a.true for a in bad], "kx", ms=6, mew=1)
    ends = np.array([1e-8, 1.0])
    axes.loglog(ends, ends, "k-", lw=0.7)
    axes.axvline(THRESHOLD, color="k", ls=":", lw=0.8)
    axes.set(xlabel="expected error", ylabel="true error", xlim=ends, ylim=ends)
    axes.legend(fontsize=7)
    figure.savefig(path, dpi=110, metadata={"Software": None})
    plt.close(figure)


def _drawn(kinds: Sequence[str], count: int, nj: int, ni: int = 65) -> Iterator[Boundary]:
    for kind in kinds:
        for s in shapes(kind, SEED, count, ni, nj):
            yield Boundary(s.south, s.north, s.west, s.east, s.topology, name=s.name)  # type: ignore[arg-type]


def _trained(epochs: int) -> Operator:
    """Return `meshonet` trained on 30 arches of 33 x 33 nodes."""
    with tempfile.TemporaryDirectory() as folder:
        names = [f"{folder}/{k}.h5" for k in range(36)]
        for name, edges in zip(names, meshonet.sample_family("arch", 36, res=33), strict=True):
            meshonet.solve_pde(edges, method="winslow", tol=1e-8).write(name)
        path = f"{folder}/arch.safetensors"
        meshonet.train(names, path, model="meshonet", split="interpolation", epochs=epochs)
        return load(path)


def _others(count: int) -> Iterator[Boundary]:
    """Yield arches within the range of the training and beyond, and shapes of other families."""
    for family in ("arch", "hexagon", "semicircle"):
        yield from meshonet.sample_family(family, count, res=33)
    yield from _drawn(("wavy", "bumps"), count, 33, 33)


HEAD = """# Expected errors of neural networks

<!-- made by python benchmarks/bench_confidence.py --page docs/benchmarks/confidence.md -->

Read this page to decide whether you can rely on the *expected error* that `infer --model` reports. The page
compares expected and true errors of four networks, mostly on kinds of shapes that were not used in training.

- *expected error*: a few solver steps move the nodes of the predicted grid. The expected error is the RMS
  length of these moves, divided by the RMS distance of the nodes from their centroid.
- *true error*: RMS distance of the nodes from the converged grid of the solver that the network imitates,
  divided in the same way.
- *--polish auto*: before the estimate, solver iterations improve the predicted grid. *off*: no iterations.
- *rank correlation*: Spearman's coefficient of expected and true errors.
- *expected / true*: 5th, 50th and 95th percentile of this ratio over the grids.
- *low*: number of grids with an expected error of at most {threshold:g}. *low, folded*: number of these grids
  that have folded cells. *high* and *high, folded*: the same for larger expected errors.
- *time*: CPU time per grid to compute the expected error; median, one thread.

`quad-general` was tested on six kinds of random four-sided domains with 65 x 65 nodes, `hole-o` and
`airfoil-o` on three kinds of random bodies with 65 x 33 nodes. There are {count} shapes of each kind. The
kinds are those of the [open comparison](yardstick.md).

The network `meshonet` of [the paper](paper/index.md) was trained on 30 arches. It was tested on 40 arches, 40
hexagons, 40 semicircles and 80 four-sided domains. This network also predicts boundary nodes. The given
boundary nodes replace them, and many cells beside the boundary are folded.
"""
COLUMNS = (
    "| network | grids | true error, median | true error, maximum | rank correlation | expected / true "
    "| low | low, folded | high | high, folded | time, ms |",
    11 * "| --- " + "|",
)

TAIL = """
![expected and true errors](confidence.png)

Each point is a grid; a cross marks a grid with folded cells. On the solid line both errors are equal. The
dotted line is the threshold of 0.03.

## Conclusions

- Expected and true errors rise and fall together: the rank correlation is 0.91 to 1.00.
- The expected error is more often too small than too large: the medians of its ratio to the true error are
  0.86 to 1.00.
- With `--polish auto`, all 480 grids of `quad-general`, `hole-o` and `airfoil-o` have low expected errors and
  no folded cells. Their largest true error is 0.057.
- A low expected error does not exclude folded cells: without polish, 15 of 456 grids with a low expected
  error have some. `infer --fallback` therefore uses the solver's grid if the network's grid has a high
  expected error or folded cells.
"""

if __name__ == "__main__":
    main()
