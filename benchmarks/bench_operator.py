"""The operators beside every way without a network: valid grids, distances, angles, time. One honest page.

    python benchmarks/bench_operator.py [--files FOLDER] [--keep FOLDER] [--page docs/benchmarks/o-grids.md]

Shapes are procedural airfoils of a seed that no model was trained on, the ``.dat`` files of FOLDER, random
four-sided domains and the paper's families. All ways of a table run on the same boundaries, one thread; with
--keep a run that was cut short goes on where it stopped. Sample sizes are options: the defaults take about a
quarter of an hour on one core.
"""

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import argparse
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from gains import operate, published
from judged import Way, rows, table
from kept import Kept
from page import arguments, processor, publish
from shapes import Shape, airfoil_files, members, random_airfoils, random_domains

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.families.family import FAMILIES, family
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.conformal.harmonic import extend
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.pipeline.choose_method import Best
from meshonet.solvers.pipeline.coarse import solve_coarse
from meshonet.solvers.pipeline.fallback import guard
from meshonet.solvers.pipeline.named import method_named
from meshonet.solvers.solution import Solution

OURS = "**infer, default**"
SOLVER = "multigrid Winslow"
SIZES = (100, 200, 400, 800, 1600, 3200)
LARGEST = {"variational": 800}
"""Nodes along a direction up to which a way is timed."""


def coarse(method: Way, n: int) -> Way:
    """Return the way that solves on n x n nodes and is evaluated at all."""
    return partial(solve_coarse, solve=method, n=n, smooth=True)


def infer(boundary: Boundary, **settings: object) -> Solution:
    """Return the grid of the operator with `settings`, or what measures best."""
    method = method_named("operator", **settings) if settings else Best()
    return method.solve([boundary])[0]


COMMON: dict[str, Way] = {
    "TFI": lambda b: Solution(tfi(b), "tfi"),
    "Winslow, coarse 65": coarse(winslow, 65),
    SOLVER: winslow,
    "variational, coarse 65": coarse(variational, 65),
    "variational": variational,
}
AIRFOILS: dict[str, Way] = {
    **COMMON,
    "harmonic base": lambda b: infer(b, model="base", polish="off"),
    "base + 1 Picard step": lambda b: infer(b, model="base", polish=1),
    "**network alone**": lambda b: infer(b, polish="off"),
    "**network + 1 Picard step**": lambda b: infer(b, polish=1),
    "**network, polish auto**": lambda b: infer(b, model="airfoil-o"),
    OURS: infer,
}
DOMAINS: dict[str, Way] = {
    **COMMON,
    "harmonic base": lambda b: Solution(Grid.from_nodes(extend(b), b.topology), "harmonic"),
    "Winslow, coarse 33": coarse(winslow, 33),
    "variational, coarse 33": coarse(variational, 33),
    "**quad-winslow**": partial(operate, "quad-winslow", 0),
    "**quad-winslow, 2 cycles**": partial(operate, "quad-winslow", 2),
    "**quad-general**": partial(operate, "quad-general", 0),
    "**quad-general, 5 steps**": partial(operate, "quad-general", 5),
}


def main() -> None:
    """Measure and print; write the page when asked."""
    parser = arguments(__doc__)
    parser.add_argument("--files", type=Path, help="folder of airfoil .dat files")
    parser.add_argument("--count", type=int, default=40, help="procedural airfoils")
    parser.add_argument("--many", type=int, default=500, help="procedural airfoils whose folds are counted")
    parser.add_argument("--every", type=int, default=2, help="every so many files with other spacings")
    parser.add_argument("--large", type=int, default=12, help="files at 800x800")
    parser.add_argument("--domains", default="65:40,193:15", help="four-sided domains, nodes:domains")
    parser.add_argument("--keep", type=Path, help="folder for finished rows; go on from those in it")
    options = parser.parse_args()
    kept = Kept(options.keep)
    parts = [HEAD.format(machine=f"{processor()}, one thread")]
    for part in sections(options, kept):
        print(part, flush=True)
        parts.append(part)
    publish("\n".join(parts), options.page, shown=True)


def sections(options: argparse.Namespace, kept: Kept):  # type: ignore[no-untyped-def]
    """Yield the page part by part."""
    for title, shapes, k, ways in airfoil_tables(options):
        yield table(f"{title} ({len(shapes)})", rows(kept, title, shapes, k, ways or AIRFOILS))
    yield folds(kept, options.many)
    for size in options.domains.split(","):
        n, count = (int(word) for word in size.split(":"))
        title, shapes = f"Random four-sided domains, {n}x{n}", random_domains(count, n)
        ways = {way: make for way, make in DOMAINS.items() if n > 65 or not way.endswith("65")}
        yield table(f"{title} ({len(shapes)})", rows(kept, title, shapes, 2, ways), DOMAINS_NOTE)
    yield families(kept)
    yield times(kept)
    yield WHICH


def airfoil_tables(options: argparse.Namespace):  # type: ignore[no-untyped-def]
    """Yield title, shapes, how much finer the reference is, and the ways where they are not all."""
    yield "Procedural airfoils, every spacing law, 200x200", random_airfoils(options.count, 200), 4, None
    if options.files:
        for spacing in (None, "cosine", "uniform"):
            title = f"Airfoil files, {spacing or 'default'} spacing, 200x200"
            every = list(airfoil_files(options.files, 200, spacing))
            yield title, every if spacing is None else every[:: options.every], 4, None
        every = list(airfoil_files(options.files, 800, None))
        some = every[:: max(1, len(every) // options.large)][: options.large]
        ways = {way: AIRFOILS[way] for way in (SOLVER, "**network, polish auto**", OURS)}
        yield "Airfoil files, default spacing, 800x800", some, 2, ways


def folds(kept: Kept, count: int) -> str:
    """Return a table: how many procedural airfoils have no folded cell before and after the guard."""
    lines = [
        f"\n## Share of grids without folded cells, {count} procedural airfoils, 200x200\n",
        f"| spacing | {OURS} | infer, after repair | {SOLVER} |",
        "| --- | --- | --- | --- |",
    ]

    def folded(shape: Shape) -> list[bool]:
        edges = shape.make(1)
        solution = infer(edges)
        first = count_folded(solution.grid.nodes) > 0
        after = first and count_folded(guard(solution, edges, allow_invalid=True).grid.nodes) > 0
        return [first, after, count_folded(winslow(edges).grid.nodes) > 0]

    for spacing in ("conformal", "cosine", "curvature", None):
        shapes = random_airfoils(count, 200, spacing)  # type: ignore[arg-type]
        label = (
            "every law, random cell lengths at leading and trailing edge" if spacing is None else str(spacing)
        )
        folds = [kept.row(("folds", label, one.name), partial(folded, one)) for one in shapes]
        share = 100.0 * (1.0 - np.array(folds).mean(axis=0))
        lines.append(f"| {label} | {share[0]:.1f} % | {share[1]:.1f} % | {share[2]:.1f} % |")
    return "\n".join(lines) + "\n"


def families(kept: Kept) -> str:
    """Return the table of the paper's families: median distance and grids with folds."""
    quad = {
        "TFI": COMMON["TFI"],
        "harmonic base": DOMAINS["harmonic base"],
        "Winslow, coarse 33": DOMAINS["Winslow, coarse 33"],
        SOLVER: winslow,
        "operator": partial(operate, "quad-winslow", 0),
        "operator, polish": partial(operate, "quad-winslow", 2),
    }
    ring = {**quad, "operator": lambda b: infer(b, polish="off"), "operator, polish": infer}
    plate = {
        **quad,
        "operator": partial(operate, "hole-winslow", 0),
        "operator, polish": partial(operate, "hole-winslow", 2),
    }
    lines = [FAMILIES_NOTE, "| family | " + " | ".join([*quad, "MeshONet", "MeshONet-hard"]) + " |"]
    lines.append("| --- |" + " --- |" * (len(quad) + 2))
    for name in FAMILIES:
        for split in ("interpolation", "extrapolation"):
            title = f"{name}, {split}"
            shapes = members(name, split, 101)
            ways: dict[str, Way] = {"airfoil": ring, "hole": plate}.get(name, quad)
            result = rows(kept, title, shapes, 2, ways)
            cells = [f"{np.median(one[:, 2]):.1e} ({(one[:, 0] > 0).sum()})" for one in result.values()]
            cells += [published(f"{name}.{split}.{kind}.raw") for kind in ("meshonet", "meshonet-hard")]
            lines.append(f"| {title} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def times(kept: Kept) -> str:
    """Return a table of grid-stage milliseconds around airfoils and inside the arch."""
    lines = [TIMES_HEAD, "| method | " + " | ".join(f"{n}x{n}" for n in SIZES) + " |"]
    lines.append("| --- |" + " --- |" * len(SIZES))
    sharp, blunt = (partial(section, name) for name in ("2412-sharp", "2412"))
    network = {way: AIRFOILS[way] for way in ("**network, polish auto**",)}
    general = {way: DOMAINS[way] for way in ("**quad-general**", "**quad-general, 5 steps**")}
    copy: dict[str, Way | None] = {"copying the grid in memory": None}
    for label, shape, ways in (
        ("sharp edge", sharp, {OURS: infer}),
        ("blunt edge", blunt, {OURS: infer, **network, **COMMON}),
        ("arch", partial(family("arch").boundary, 0.3), {**general, **COMMON}),
        ("for comparison", sharp, copy),
    ):
        for way, make in ways.items():
            sizes = [n for n in SIZES if n <= LARGEST.get(way, n)]
            results = [
                kept.row(("times", label, way, str(n)), lambda n=n, do=make, of=shape: best(do, of(n, n)))
                for n in sizes
            ]
            cells = [f"{spent:.1f}" for spent in results] + [""] * (len(SIZES) - len(sizes))
            lines.append(f"| {label}: {way} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def section(designation: str, ni: int, nj: int) -> Boundary:
    """Return the default O boundary of a NACA section."""
    return naca(designation).boundary(Sampling(ni, nj, "o"))


def best(make: Callable[[Boundary], Solution] | None, edges: Boundary, repeats: int = 3) -> float:
    """Return the least milliseconds of `repeats` runs; of a copy of a grid when `make` is None."""
    nodes: Floats = np.ones((2, edges.ni, edges.nj))
    spent = []
    for _ in range(repeats):
        begun = time.process_time()
        held = nodes.copy() if make is None else make(edges)
        spent.append(time.process_time() - begun)
        del held
        if spent[0] > 5.0:
            break
    return 1e3 * min(spent)


HEAD = """# All methods compared: airfoils and four-sided domains

<!-- made by python benchmarks/bench_operator.py --page docs/benchmarks/o-grids.md (make bench) -->

Use this page to find, for each method, the CPU time, the angles, and the distance of the grid to a
converged solution. For short advice see [choosing a method](../start/choosing-a-method.md).

**Timing.** All methods of a table ran on the same boundaries, in one run, on {machine}, while other
programs used the machine. *ms* is the CPU time to generate the grid, including set-up, without reading,
writing and repair. Each time is the median over the shapes, with one run for each shape; the last digits
are not significant. Bold rows are the networks and the default of `infer`.

**Methods.** `infer, default` is the command without options. The other rows:

| row | how the grid is made |
| --- | --- |
| TFI | transfinite interpolation |
| multigrid Winslow | Winslow's equations on all nodes, to an iteration error below the discretisation error |
| variational | minimum of the variational functional on all nodes |
| Winslow (or variational), coarse N | this solution on N x N nodes, interpolated and smoothed |
| harmonic base | harmonic extension of boundary nodes; around airfoils in a [strip](../theory/o-grids.md) |
| base + 1 Picard step | harmonic base, then one fixed-point step for Winslow's equations in the strip |
| network alone | the network `airfoil-o` corrects the harmonic base |
| network + 1 Picard step | one Picard step after the network |
| network, polish auto | Picard steps after the network, until they hardly change the grid |
| quad-general (5 steps) | the network for variational grids (then 5 steps of minimisation) |
| quad-winslow (2 cycles) | the network for Winslow's grids (then 2 cycles of multigrid) |
| MeshONet | the network of the paper; its boundary nodes approximate the given nodes |
| MeshONet-hard | a similar network, whose boundary nodes are exactly the given nodes |

**Distance** (columns *near the wall* and *all nodes*) is a relative L2 norm: the root mean square distance of
the nodes to the reference nodes, divided by the root mean square distance of the reference nodes to the
centre of the shape. *Near the wall*, it is taken over the nodes within 1.5 chords of the centre of an
airfoil, or over the 10 % of the rows nearest to each side of a four-sided domain.

**Reference.** Winslow's equations are solved to a residual of 1e-8 on two finer grids, with twice and with
four times as many cells in each direction as the grids of the table. (For 800x800 nodes: with as many and
with twice as many.) The reference is extrapolated from these two solutions. The reference of variational
grids is the converged variational grid of the same size.

**Angles** are divided by the angles of Winslow's grid, which multigrid solves to a residual of 1e-8 on the
same nodes. A value below 1 means smaller angles than in Winslow's grid. *Valid* is the share of grids without
a folded cell, before any repair.

Remarks:

- *Procedural airfoils* are random airfoils generated by a formula; none was used in training. A *spacing
  law*, a value of `--spacing`, is a distribution of the wall nodes.
- A TFI grid distributes its interior nodes differently from Winslow's grid, so its distance says little about
  its quality.
- The conformal map cannot resolve the wall cells of some bodies. For these bodies `infer` uses multigrid or
  the model `hole-o`; the largest distances of `infer` occur there.
- In the tables of distances, the nodes of a boundary are every fourth node of a finer boundary (every second
  node for 800x800 nodes). A corner of a blunt trailing edge may not be among these nodes; this changes the
  largest angle by a few percent.
- For walls with uniform spacing the reference is accurate only to about 1e-4, because Winslow's solution
  converges only with order 1.4 at trailing edges. The network also differs from the reference by design: its
  grid line at the trailing edge bisects the angle there.
- The titles of tables give the number of shapes in brackets. A few of these shapes have no converged
  reference and are left out of the table.
"""
DOMAINS_NOTE = """The reference of `quad-winslow` is Winslow's solution, that of `quad-general` the
converged variational grid."""
FAMILIES_NOTE = """
## The six families of the MeshONet paper, 101x101, test members

Each row is for six test members of a family. The table gives the median relative L2 distance of all nodes to
Winslow's converged solution and, in brackets, the number of grids with folded cells. Winslow's own grids of
the wrench have folded cells. The operator is `quad-winslow` for the first four families, `airfoil-o` for the
airfoil and `hole-winslow` for the plate with a hole, without training on these shapes. *Polish* adds 2
multigrid cycles; for the airfoil this column shows `infer` without options. The paper's models, MeshONet and
MeshONet-hard, were trained on 30 members of each family; *interpolation* is inside and *extrapolation*
outside the range of training. The errors of the paper's models are from [the reproduction of the
paper](paper/index.md) and are measured from the grid of the PDE solver.
"""
TIMES_HEAD = """
## CPU time to generate the grid in milliseconds, float64, best of 3

*sharp edge*, *blunt edge*: NACA 2412 with a closed and with a blunt trailing edge. *arch*: a four-sided
domain. With more than 513 nodes per side, the 5 steps of `quad-general` run on 257 nodes per side. Empty
cells were not measured.
"""
WHICH = """
## Consequences for the defaults of `infer`

- **O grids around airfoils**: the default is the conformal map with Picard iteration, without the network.
  With the network a grid takes more time; its distance to the solution and its angles are about the same.
  `--model airfoil-o` or `--polish off` selects the network.
- **Four-sided domains**: the default is the variational method; if fewer nodes resolve all sides, it runs on
  these and the grid is interpolated. For a single grid this method is better than any network. For batches,
  `--model quad-general` is many times faster ([measurements](quad-operator.md)).
- **C grids**: the default is hyperbolic marching from the wall and the wake, or the variational method if
  marching fails. The network for four-sided domains generates worse C grids than TFI
  ([measurements](body-operator.md#c-grids-no-model)).
- **Batches of airfoils** take hardly less time per airfoil than single airfoils: only the network is
  evaluated for many airfoils at once.
"""

if __name__ == "__main__":
    main()
