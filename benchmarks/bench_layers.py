"""Layers on a CPU: distance from the compiled solvers, folds, time of gradients.

    python benchmarks/bench_layers.py [--count 1000] [--nodes 65] [--page docs/benchmarks/layers.md]

The shapes are random four-sided domains, and random airfoils around which the far field is at 15 chords.
"""

import os
import sys

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import torch
from clock import clocked
from page import arguments, publish
from shapes import Shape, random_airfoils, random_domains  # before the next: it finds the tests' folder

from converged_o_grids import converged  # isort: skip

import meshonet
from meshonet import layer
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational

HEAD = """# Grids in torch: accuracy and time

<!-- made by python benchmarks/bench_layers.py; rows of about 32 grids with --count 32 -->

Use this page to find how exact and how fast [`meshonet.layer`](../guide/layers.md) generates grids in torch,
compared with the compiled solvers. CPU times are for one thread.

The shapes are random: airfoils for `conformal`, four-sided domains for all other functions. The boundary
nodes are given in double precision (*64 bits*), or rounded to single precision (*32 bits*). The compiled
solvers get the same boundary nodes.

- *distance*: largest distance between a node of `meshonet.layer` and the same node of the compiled solver,
  divided by the largest extent of the grid.
- *folded*: number of grids of `meshonet.layer` with folded cells. *folded in torch only*: number of shapes
  for which `meshonet.layer` folds cells and the compiled solver does not.
- *CPU ms*: CPU time to compute a grid, in milliseconds.
- *gradient*: CPU time to differentiate a function of the grid by the boundary nodes, divided by *CPU ms*.

1000 shapes are tried for each row, and 32 for the 32-bit rows of `variational` and `conformal`. Invalid
domains and airfoils without a conformal map are left out.
"""

TAIL = """
- If torch computes in double precision, the grids agree with those of the compiled solvers to 2e-11. In
  single precision they agree to the rounding error of nodes, 6e-8.
- `meshonet.layer` folds no cells that the compiled solvers do not fold. `solve-pde` repairs folded cells;
  `meshonet.layer` does not.
- A gradient takes 0.15 to 1.8 times the CPU time of the grid.
- For this table, the compiled `variational` and `conformal` solvers iterated longer than in `solve-pde`.
"""

FUNCTIONS = "transfinite,winslow,variational,conformal"


def exact(name: str, boundary: Boundary, nodes: Floats) -> Floats:
    """Return the nodes of the compiled solver; `nodes` are those of the layer."""
    if name == "transfinite":
        return tfi(boundary).nodes
    if name == "winslow":
        return winslow(boundary, tol=1e-12, max_cycles=100).grid.nodes
    if name == "conformal":
        return converged(boundary)
    grid = variational(boundary, tol=1e-8, max_cycles=1000).grid
    return meshonet.optimum_derivative(grid.with_nodes(nodes)).grid.nodes


def rows(count: int, n: int, functions: Sequence[str], precisions: Sequence[str]) -> Iterator[str]:
    """Yield the table."""
    yield "| function | precision | grids | distance | folded | folded in torch only | CPU ms | gradient |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    domains = [shape.make(1) for shape in random_domains(count, n)]
    airfoils = mapped(random_airfoils(count, n)) if "conformal" in functions else []
    for name in functions:
        drawn, names = domains, ("south", "north", "west", "east")
        function: Callable[..., Any] = getattr(layer, name)
        if name == "conformal":
            drawn, names, function = airfoils, names[:2], lambda *sides: layer.conformal(*sides, n)
        for dtype in (getattr(torch, f"float{bits}") for bits in precisions):
            sides = [torch.tensor(np.stack([getattr(b, side) for b in drawn]), dtype=dtype) for side in names]
            row = f"| `{name}` | {str(dtype)[-2:]} bits | {' | '.join(words(name, function, sides, drawn))} |"
            print(row, file=sys.stderr, flush=True)
            yield row


def mapped(shapes: Sequence[Shape]) -> list[Boundary]:
    """Return the airfoils that have a conformal map; print how many have none."""
    drawn = [shape.make(1) for shape in shapes]
    sides = (torch.tensor(np.stack([getattr(body, name) for body in drawn])) for name in ("south", "north"))
    nodes = layer.AirfoilGrids("base", 0)(*sides, 5, failed="nan")
    have = nodes.isfinite().all((1, 2, 3)).tolist()
    print(f"{have.count(False)} of {len(drawn)} airfoils have no conformal map", file=sys.stderr, flush=True)
    return [body for body, has in zip(drawn, have, strict=True) if has]


def words(
    name: str, function: Callable[..., Any], sides: Sequence[Any], drawn: Sequence[Boundary]
) -> Iterator[str]:
    """Yield the cells of a row."""
    yield str(len(drawn))
    for side in sides:
        side.requires_grad_()
    function(*(side[:1] for side in sides))  # loads what torch loads late
    forward, nodes = clocked(partial(function, *sides))
    backward, _ = clocked(nodes.double().square().sum().backward)
    grids = nodes.detach().double().numpy()
    far, folded, more = 0.0, 0, 0
    for k, own in enumerate(grids):
        edges = [side[k].detach().double().numpy() for side in sides]
        compiled = exact(name, within(edges, drawn[k]), own)
        far = max(far, float(np.abs(compiled - own).max() / np.ptp(own, axis=(0, 1)).max()))
        folds = count_folded(own) > 0
        folded, more = folded + folds, more + (folds and not count_folded(compiled))
    yield f"{far:.0e} | {folded} | {more} | {1e3 * forward / len(grids):.1f} | {backward / forward:.2f}"


def within(sides: Sequence[Floats], like: Boundary) -> Boundary:
    """Return the boundary with four sides, or with the body and the far field of one `like` it."""
    if len(sides) == 4:
        return Boundary(*sides)
    cut = np.linspace(sides[0][0], sides[1][0], like.nj)
    return replace(like, south=sides[0], north=sides[1], west=cut, east=cut)


def main() -> None:
    """Print the page, or write it."""
    parser = arguments(__doc__)
    parser.add_argument("--count", type=int, default=1000, help="seeds of domains, and airfoils")
    parser.add_argument("--nodes", type=int, default=65, help="along a side")
    parser.add_argument("--functions", default=FUNCTIONS, help="some of these, separated by commas")
    parser.add_argument("--precisions", default="64,32", help="bits of the sides, separated by a comma")
    options = parser.parse_args()
    torch.set_num_threads(1)
    chosen = options.functions.split(","), options.precisions.split(",")
    publish(
        "\n".join([HEAD, *rows(options.count, options.nodes, *chosen), TAIL]),
        options.page,
    )


if __name__ == "__main__":
    main()
