"""Bodies in far fields by the network that goes round them, beside every way without one.

    python benchmarks/bench_bodies.py [--sizes 129x65:60,401x201:10] [--page docs/body-operator.md]

Bodies are random ones of seeds that no model was trained on, and the paper's moving hole, whose family no
model has seen. Folds are counted before the guard. Processor time of one thread, in one run.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

import numpy as np
from gains import Way, clocked, distances, figures, gains, operate, percent, published

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import SolverError
from meshonet.geometry.families.bodies import boundary as random_body
from meshonet.geometry.families.family import family
from meshonet.geometry.families.split import split
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.registry import load
from meshonet.solvers.pipeline.coarse import solve_coarse, thinned
from meshonet.solvers.solution import Solution

SEED = 1000
"""Of the bodies here; those of training have another."""


def main() -> None:
    """Measure and print; write the page when asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", default="129x65:60,401x201:10", help="NIxNJ:bodies")
    parser.add_argument("--model", default="hole-o")
    parser.add_argument("--twin", default="hole-winslow")
    parser.add_argument("--page", type=Path, help="markdown page to write")
    options = parser.parse_args()
    parts = [HEAD]
    for size in options.sizes.split(","):
        counts, _, members = size.partition(":")
        ni, nj = (int(word) for word in counts.split("x"))
        parts += tables(bodies(ni, nj, int(members)), options.model, options.twin)
    parts += [batches(options.model), holes(options.model, options.twin), wakes(), TAIL]
    text = "\n".join(parts)
    print(text)
    if options.page:
        options.page.write_text(text)


def bodies(ni: int, nj: int, count: int) -> list[Boundary]:
    """Return random boundaries with ni x nj nodes on which Winslow's equations have a solution."""
    found: list[Boundary] = []
    for k in range(count):
        edges = random_body(np.random.default_rng([SEED, k]), ni, nj)
        try:
            winslow(edges)
            variational(edges, max_cycles=1)
        except SolverError:
            continue
        found.append(edges)
    return found


def tables(edges: list[Boundary], model: str, twin: str) -> list[str]:
    """Return the tables of angles and of distances to Winslow's solution."""
    ways: dict[str, Way] = {
        "TFI": lambda b: Solution(tfi(b), "tfi"),
        "Winslow": winslow,
        "Winslow --coarse 65": partial(solve_coarse, method=winslow, n=65, smooth=True),
        "variational": variational,
        "variational --coarse 65": partial(solve_coarse, method=variational, n=65, smooth=True),
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
    lines = ["\n## 32 bodies together, 65 x 33\n", "| way | CPU ms a grid |", "| --- | --- |"]
    for dtype in ("float32", "float64"):
        spent = min(clocked(partial(load, edges, model, 0, dtype)) for _ in range(5)) / len(edges)
        lines.append(f"| **network in {dtype}** | {1e3 * spent:.2f} |")
    return "\n".join(lines)


def holes(model: str, twin: str) -> str:
    """Return the table of the paper's moving hole: test members of the random split, and beyond the range."""
    kind = family("hole")
    drawn = [float(v) for v in np.random.default_rng(0).uniform(kind.low, kind.high, 36)]
    kept = split(drawn, "random")
    groups = {
        "random": [v for v, use in zip(drawn, kept, strict=True) if use == "test"],
        "beyond, to 0.5": [-0.5, -0.45, 0.45, 0.5],
    }
    lines = [HOLES]
    for name, parameters in groups.items():
        edges = [kind.boundary(v, 101, 101) for v in parameters]
        goals = [winslow(one, tol=1e-8, max_cycles=60).grid for one in edges]
        cells = []
        for polish in (0, 2):
            grids = [found.grid for found in load(twin).solve(edges, polish)]
            errors = [compare(grid, goal).relative_l2 for grid, goal in zip(grids, goals, strict=True)]
            cells.append(f"{np.median(errors):.1e} ({sum(count_folded(grid.nodes) > 0 for grid in grids)})")
        judgements = [
            [figures(partial(operate, model, polish), one) for one in edges] for polish in (0, 5)
        ] + [[figures(winslow, one) for one in edges]]
        angles = ["{:.1f} / {:.1f}".format(*np.array(rows)[:, 1:3].mean(axis=0)) for rows in judgements]
        told = [published(f"hole.random.{kind}") for kind in ("meshonet.raw", "meshonet-hard.raw")]
        told = told if name == "random" else ["", ""]
        lines.append(f"| {name} | {' | '.join([*cells, *told, *angles])} |")
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

A C grid is a four-sided domain whose south side is wake, airfoil and wake. Three sections, far fields of 5
and 15 chords, 201 x 65. The network for four-sided domains was shown none, and 33 nodes are few for such a
side: alone it is worse than TFI. No `airfoil-c` is shipped; `infer` marches C grids from the wall.

| way | valid % | max / mean angle, averaged | CPU ms, median |
| --- | --- | --- | --- |"""
HOLES = """
## The paper's moving hole, 101 x 101

Relative L2 to Winslow's solution, median, grids with folds in brackets; then the largest and mean angle,
averaged, of `hole-o` and of Winslow's grid. No hole of this family was shown to the network; the paper's
models were trained on 30 of them ([the paper, done again](paper/README.md)).

| split | hole-winslow | 2 cycles | MeshONet | MeshONet-hard | hole-o | hole-o, 5 steps | Winslow |
| --- | --- | --- | --- | --- | --- | --- | --- |"""
HEAD = """# The operator for bodies

<!-- made by python benchmarks/bench_bodies.py --page docs/body-operator.md -->

`infer --model hole-o` makes the variational O grid between any body and any far field by one pass of a
network; `hole-winslow` is its other answer, Winslow's grid. `--polish N` takes N steps of descent after it
(of multigrid for Winslow's).

It is the network of [four-sided domains](quad-operator.md), taught on: around a body the logarithm of the
distance from its middle unrolls the domain to a strip, where Winslow's equations are the same and only one
thing is new, that steps and layers go round along xi. So walls are bitwise those given, a body moved, turned
or scaled has the same grid moved, a mirrored one the mirrored, and one whose nodes begin an eighth of the way
further round the same one from there, all to rounding. Steps after the network are taken in a frame of the
body's own, on walls rounded to 1e-9 of their size there, so that all but the last hold for them too.

It was taught on 5,710 random bodies, six times over, about nine minutes of one core; that is little. Grids
may fold before the guard; its repairs are not in these tables. Angles are the largest included angle of each
cell, in degrees. The gain is what a way improves on Winslow's figure, over what the variational grid does,
summed over bodies where Winslow's is valid. Bodies where Winslow's equations have no discrete solution, a
few in a hundred, are left out. Processor time of one thread of a shared, busy machine.
"""
TAIL = """
## Which to use

`infer` without a model gives `hole-o` the compact bodies that the airfoil operator refuses, unless its
answer on 65 x 33 nodes has folds; then the elliptic solver makes the grid. With its five steps it is
valid where a quarter of Winslow's grids are folded before the guard, and nearer to right angles, in up to
four times the time; alone, none of these folds. `solve-pde --method variational` has the best of all, in
four times the time again. What both pay is evenness: they draw lines together where a body stands near
its far field. Smooth bodies in round far fields stay with `airfoil-o`, as do thin ones. A body whose
centroid lies outside it (a clip, a crescent, an angle) is seen from where it is thickest. No such body
was shown to the network: its answer often folds, and the five steps, or the guard's repair, unfold it; of
25 plates, crescents and angles all were valid after the steps, and nearly as near to right angles as the
variational grids.

## Gradients

`meshonet.solvers.neural.differentiable.BodyGrids` is the same in torch, equal to 1e-12, with gradients
from every node to the nodes of body and far field, which finite differences confirm; on a GPU with
`device="cuda"`, as `infer --device cuda` has it. Where the hole is that a given grid was made around:

```python
import torch
from meshonet.geometry.families.family import family
from meshonet.solvers.neural.differentiable import BodyGrids

edges, grids = family("hole").boundary(0.3, 65, 33), BodyGrids()
hole, square = (torch.tensor(side)[None] for side in (edges.south, edges.north))
wanted = grids(hole + torch.tensor([0.1, -0.2]), square, 33)
place = torch.zeros(2, dtype=torch.float64, requires_grad=True)
optimiser = torch.optim.LBFGS([place], line_search_fn="strong_wolfe")

def missed():
    optimiser.zero_grad()
    loss = (grids(hole + place, square, 33) - wanted).square().mean()
    loss.backward()
    return loss

for _ in range(2):
    optimiser.step(missed)
print(place.tolist())  # about 0.1 and -0.2
```
"""

if __name__ == "__main__":
    main()
