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
from functools import partial
from pathlib import Path

import numpy as np
from gains import operate, published
from judged import Way, rows, table
from kept import Kept
from page import arguments, processor, publish
from shapes import Shape, airfoil_files, members, random_airfoils, random_domains

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families.family import FAMILIES, family
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.pipeline.choose_method import Best
from meshonet.solvers.pipeline.coarse import solve_coarse
from meshonet.solvers.pipeline.named import method_named
from meshonet.solvers.solution import Solution

OURS = "**infer**"
SOLVER = "Winslow, all nodes"
FULL = "variational, all nodes"
SIZES = (100, 200, 400, 800, 1600, 3200)
LARGEST = {FULL: 800}
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
    FULL: variational,
}
AIRFOILS: dict[str, Way] = {
    **COMMON,
    "**airfoil-o**": lambda b: infer(b, polish="off"),
    "**airfoil-o, polished**": lambda b: infer(b, model="airfoil-o"),
    OURS: infer,
}
DOMAINS: dict[str, Way] = {
    "TFI": COMMON["TFI"],
    **{f"Winslow, coarse {n}": coarse(winslow, n) for n in (33, 65)},
    SOLVER: winslow,
    **{f"variational, coarse {n}": coarse(variational, n) for n in (33, 65)},
    FULL: variational,
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
        yield table(f"{title} ({len(shapes)})", rows(kept, title, shapes, 2, ways))
    yield families(kept)
    yield times(kept)
    yield WHICH


def airfoil_tables(options: argparse.Namespace):  # type: ignore[no-untyped-def]
    """Yield title, shapes, how much finer the reference is, and the ways where they are not all."""
    yield "Procedural airfoils, random spacing, 200x200", random_airfoils(options.count, 200), 4, None
    if options.files:
        for spacing in (None, "cosine", "uniform"):
            title = f"Airfoil files, {spacing or 'default'} spacing, 200x200"
            every = list(airfoil_files(options.files, 200, spacing))
            yield title, every if spacing is None else every[:: options.every], 4, None
        every = list(airfoil_files(options.files, 800, None))
        some = every[:: max(1, len(every) // options.large)][: options.large]
        ways = {way: AIRFOILS[way] for way in (SOLVER, "**airfoil-o, polished**", OURS)}
        yield "Airfoil files, default spacing, 800x800", some, 2, ways


def folds(kept: Kept, count: int) -> str:
    """Return a table: how many procedural airfoils have no folded cell before the guard."""
    lines = [
        f"\n## Grids without folded cells, {count} procedural airfoils, 200x200\n",
        f"| spacing of wall nodes | {OURS}, % | {SOLVER}, % |",
        "| --- | --- | --- |",
    ]

    def folded(shape: Shape) -> list[bool]:
        edges = shape.make(1)
        return [count_folded(make(edges).grid.nodes) > 0 for make in (infer, winslow)]

    for spacing in ("conformal", "cosine", "curvature", None):
        shapes = random_airfoils(count, 200, spacing)  # type: ignore[arg-type]
        label = "random, with random cells at leading and trailing edge" if spacing is None else str(spacing)
        folds = [kept.row(("folds", label, one.name), partial(folded, one)) for one in shapes]
        share = 100.0 * (1.0 - np.array(folds).mean(axis=0))
        lines.append(f"| {label} | {share[0]:.1f} | {share[1]:.1f} |")
    return "\n".join(lines) + "\n"


def families(kept: Kept) -> str:
    """Return the table of the paper's families: median distance and grids with folds."""
    quad = {
        "TFI": COMMON["TFI"],
        "Winslow, coarse 33": DOMAINS["Winslow, coarse 33"],
        SOLVER: winslow,
        "network": partial(operate, "quad-winslow", 0),
        "network, polished": partial(operate, "quad-winslow", 2),
    }
    ring = {**quad, "network": lambda b: infer(b, polish="off"), "network, polished": infer}
    plate = {
        **quad,
        "network": partial(operate, "hole-winslow", 0),
        "network, polished": partial(operate, "hole-winslow", 2),
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
    network = {way: AIRFOILS[way] for way in ("**airfoil-o, polished**",)}
    general = {way: DOMAINS[way] for way in ("**quad-general**", "**quad-general, 5 steps**")}
    for label, shape, ways in (
        ("sharp edge", sharp, {OURS: infer}),
        ("blunt edge", blunt, {OURS: infer, **network, **COMMON}),
        ("arch", partial(family("arch").boundary, 0.3), {**general, **COMMON}),
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


def best(make: Way, edges: Boundary, repeats: int = 3) -> float:
    """Return the least milliseconds of `repeats` runs."""
    spent = []
    for _ in range(repeats):
        begun = time.process_time()
        held = make(edges)
        spent.append(time.process_time() - begun)
        del held
        if spent[0] > 5.0:
            break
    return 1e3 * min(spent)


HEAD = """# All methods compared: airfoils and four-sided domains

<!-- made by python benchmarks/bench_operator.py --page docs/benchmarks/o-grids.md (make bench) -->

Use this page to compare solvers and neural networks by the quality of their grids and by CPU time. The grids
are O grids around airfoils, and grids in four-sided domains. For short advice see [choosing a
method](../start/choosing-a-method.md).

Measured on {machine}.

Rows of the tables (bold: `infer` and the networks):

| row | how the grid is generated |
| --- | --- |
| **infer** | Winslow's equations, solved after a [conformal map](../theory/o-grids.md): the default |
| TFI | transfinite interpolation |
| Winslow, all nodes | Winslow's equations by multigrid, to the discretisation error |
| variational, all nodes | minimum of the [variational functional](../theory/variational.md) |
| Winslow or variational, coarse N | solution on N x N nodes, interpolated to all nodes and smoothed |
| **airfoil-o** | the network `airfoil-o` alone, which predicts Winslow's O grid |
| **airfoil-o, polished** | `airfoil-o`, then iterations for Winslow's equations until nodes hardly move |
| **quad-winslow** | network for Winslow's grid of a four-sided domain; *2 cycles*: then 2 multigrid cycles |
| **quad-general** | network for variational grids of four-sided domains; *5 steps*: and 5 solver iterations |

Terms and columns:

- *procedural airfoils*: random airfoils that a formula generates; none was used to train a network.
  *spacing*: how the wall nodes are distributed (`--spacing`).
- *(60)* in a heading: number of shapes. The table has fewer if Winslow's equations have no converged
  solution for some of them.
- *grids without folded cells*: share of grids, before repair.
- *distance*: root mean square distance of the nodes from those of a reference grid, divided by the root mean
  square distance of the reference nodes from the centre of the shape.
- *reference grid*: Winslow's converged solution, extrapolated from two grids; the finer has 2 or 4 times as
  many cells per direction as the tested grid. The error of this solution is about 1e-4 for uniform spacing.
  For the rows *variational* and *quad-general* the reference grid is the row *variational, all nodes*.
- *near the wall*: only nodes within 1.5 chords of the centre of the airfoil. In four-sided domains:
  at each side, the nearest 10 % of the rows.
- *largest angle*, *mean angle*: each cell has a largest angle. The columns give the maximum and the mean of
  these angles over the cells. *relative to Winslow*: divided by the value of Winslow's converged grid on the
  same boundary. Smaller is better.
- *CPU time*: to generate the grid, without reading, writing and repair; median over the shapes.
"""
FAMILIES_NOTE = """
## The six families of the MeshONet paper, 101x101

Each row is for six shapes of a family of the MeshONet paper (arXiv 2501.11937). The table gives the median
distance of all nodes from Winslow's converged solution and, in brackets, the number of grids with folded
cells.

- *interpolation*, *extrapolation*: shapes inside and outside the range of the training shapes of MeshONet.
- *network*: `quad-winslow` for the first four families, `airfoil-o` for the airfoil, and `hole-winslow` for
  the plate with a hole. These networks were not trained on the families.
- *network, polished*: 2 multigrid cycles after the network; for the airfoil the grid of `infer`.
- *MeshONet*: the network of the paper. *MeshONet-hard*: a similar network that keeps the given boundary
  nodes. [Both](paper/index.md) were trained on 30 shapes of each family. The distances of these two
  networks are from the grid of `solve-pde` with 101x101 nodes.
"""
TIMES_HEAD = """
## CPU time in milliseconds, best of 3

*sharp edge*, *blunt edge*: NACA 2412 with a closed and with a blunt trailing edge. *arch*: a four-sided
domain. With more than 513 nodes per side, the 5 steps of `quad-general` run on 257 nodes per side. Empty
cells were not measured.
"""
WHICH = """
## Conclusions

- **Airfoils**: use `infer`. For 39 airfoil files on 200x200 nodes the median time is 3.9 ms with `infer`, 6.2
  ms with the polished network and 8.9 ms with Winslow's equations on all nodes. Near the wall `infer` is
  closer to the reference grid than the network alone, in every table of airfoils on 200x200 nodes.
- **Folded cells**: none of 100 grids of `infer` around procedural airfoils has folded cells before repair. Of
  Winslow's grids 5 to 31 % have some, depending on the spacing.
- **Four-sided domains**: use the variational method. On 65x65 nodes its mean angle is 7 % smaller than that
  of Winslow's grids, and no variational grid has folded cells. The method takes 8.6 ms, or 5.4 ms with
  `--coarse 33`.
- **Batches**: in four-sided domains `quad-general` takes 2.6 ms for one grid of 65x65 nodes, and less per
  grid in a batch ([measurements](quad-operator.md)).
"""

if __name__ == "__main__":
    main()
