"""Marched grids for boundary layers: folds, first cell, angles, growth, time from file to nodes.

    python benchmarks/bench_hyperbolic.py [--files FOLDER] [--count 40] [--page docs/benchmarks/marching.md]

Shapes are NACA sections, procedural airfoils, and the ``.dat`` files of FOLDER when one is given; one thread.
Deviation is that of all four corners of every cell from 90 degrees; growth is the largest step in size
between neighbouring cells, anywhere in the grid.
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from page import arguments, processor, publish

from meshonet.formats.registry import read_shapes
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.families import procedural
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.hyperbolic.march import hyperbolic
from meshonet.solvers.pipeline.automatic import elliptic, fewer_on_quads
from meshonet.solvers.pipeline.methods import method_named

SEED = 20_000_003
REPEAT = 3
SIZES = (
    (250, 100, 1e-5),
    (400, 150, 1e-5),
    (800, 200, 1e-5),
    (250, 120, 1e-6),
    (400, 150, 1e-6),
    (800, 200, 1e-6),
)
HEAD = """# Marched grids for boundary layers: quality and time

<!-- made by python benchmarks/bench_hyperbolic.py --page docs/benchmarks/marching.md -->

Read this page to see how good marched grids are at a given size and first cell. How to make them is in
[boundary layers](../guide/boundary-layers.md), how the method works in [marching](../theory/marching.md).

All grids: `solve-pde --first-cell H`, H in chords, wall nodes spaced by curvature, far field at 15 chords. In
C grids the node count includes both sides of the wake: of 250 nodes, about 140 lie on the wall. Blunt
trailing edges are closed by a wedge in C grids.

- *first cell error*: largest relative error over all wall nodes.
- *deviation*: difference of a cell's corner angles from 90 degrees. *max* is over all cells, *away* over
  cells more than 3 cells from the trailing edge, *mean* over all corners.
- *growth*: largest relative change in size between neighbouring cells, along the wall (xi) and away from it
  (eta).
- Groups of shapes show the median / the 90th percentile.
- *CPU ms*: processor time from the file (for procedural airfoils: from the boundary) to nodes in memory, best
  of {repeat} (procedural: one run), one thread of {machine}, while other programs used the machine.

A sharp trailing edge puts an angle near 180 degrees into one line of any O grid. It therefore gets a C grid
unless `--topology` says otherwise.

![C grid around NACA 2412, trailing edge](../img/c-grid-edge.png)
"""
CONSTRUCT2D = """
## Compared with Construct2D

The same figures for Construct2D's hyperbolic grids: 250x100, first cell 1e-5, all corners of all cells.
Construct2D rounds blunt trailing edges, so its O grids compare with ours with the edge rounded.

| grid | deviation, max / mean | ours |
| --- | --- | --- |
| O, NACA 0012, blunt | 18.7 / 3.5 | {0} |
| O, LS(1)-0417, blunt | 24.8 / 3.3 | see the blunt, rounded files |
| C, NACA 0012, sharp | 14.2 / 1.8 | {1} |

Construct2D's growth is 0.10 to 0.18 along the wall and 0.13 away from it. Its first cell is exact. It takes
150 to 270 ms at 250x100 and 1.24 s at 500x200.

The walls of the procedural airfoils are spaced by every law. In some of them neighbouring cells differ by a
factor of three, and cells at the trailing edge are hardly longer than high.
"""
DEFAULT_FIRST_CELL = """
## C grids without a first cell

`--topology c` without `--first-cell`. *marched* (`--method auto`) uses a first cell of one twentieth of the
smallest cell along the wall, or a higher one where rows are few. *variational* is `--method variational`.
*first cells*: lowest and highest first cell at the wall, in chords. Other columns as above.

"""
SQUARE = (100, 200, 400)


@dataclass(frozen=True)
class Case:
    """A shape made anew for every timing, how its trailing edge is taken, and the kind of grid."""

    name: str
    make: Callable[[], Any]
    te: str
    topology: str = "o"


def main() -> None:
    """Measure and print; write the page when asked."""
    parser = arguments(__doc__)
    parser.add_argument("--files", type=Path, help="folder of airfoil .dat files")
    parser.add_argument("--count", type=int, default=40, help="procedural airfoils")
    parser.add_argument("--repeat", type=int, default=3, help="times that each grid is made")
    options = parser.parse_args()
    global REPEAT  # one setting of all timings
    REPEAT = options.repeat
    groups = {
        "NACA 0012, blunt edge rounded": [Case("0012", reader("naca:0012"), "round")],
        "NACA 0012, blunt edge exact": [Case("0012", reader("naca:0012"), "exact")],
        "NACA 0012, C": [Case("0012", reader("naca:0012"), "wedge", "c")],
    }
    if options.files:
        groups |= of_files(sorted(options.files.glob("*.dat")))
    heads = "shapes|nodes|H|folded|first cell error|deviation, max|away|mean|growth xi|growth eta|CPU ms"
    rows = [f"| {heads.replace('|', ' | ')} |", "| --- " * 11 + "|"]
    for name, cases in groups.items():
        rows += [row(name, cases, *size) for size in SIZES]
    rows += [procedural_row(options.count, *size) for size in SIZES]
    ours = [angles(groups[name][0]) for name in ("NACA 0012, blunt edge rounded", "NACA 0012, C")]
    page = "\n".join([HEAD.format(machine=processor(), repeat=REPEAT), *rows, CONSTRUCT2D.format(*ours)])
    most = max((group for name, group in groups.items() if name.endswith(", C")), key=len)
    page += DEFAULT_FIRST_CELL + "\n".join(default_rows(most)) + "\n"
    publish(page, options.page)


def reader(text: str) -> Callable[[], Any]:
    """Return what reads the one shape of a file or designation."""
    return lambda: next(iter(read_shapes(text)))


def of_files(paths: list[Path]) -> dict[str, list[Case]]:
    """Return the readable airfoils of `paths` by the kind of their trailing edge, blunt ones twice."""
    blunt, sharp = [], []
    for path in paths:
        try:
            (blunt if reader(str(path))().blunt else sharp).append(path)
        except MeshonetError:
            continue  # surfaces that cross: there is no grid to measure
    kinds = (
        ("files, C", [*blunt, *sharp], "wedge", "c"),
        ("sharp files, C", sharp, "exact", "c"),
        ("blunt, rounded files", blunt, "round", "o"),
        ("blunt, exact files", blunt, "exact", "o"),
        ("sharp files", sharp, "exact", "o"),
    )
    return {
        f"{len(found)} {kind}": [Case(path.stem, reader(str(path)), te, topology) for path in found]
        for kind, found, te, topology in kinds
        if found
    }


def angles(case: Case) -> str:
    """Return the largest and the mean deviation of one shape at 250x100, first cell 1e-5."""
    found = measured(case, 250, 100, 1e-5)
    return f"{found[2]:.1f} / {found[4]:.2f}"


def row(name: str, cases: list[Case], ni: int, nj: int, first: float) -> str:
    """Return the line of a group of shapes at one size."""
    table = np.array([measured(case, ni, nj, first) for case in cases])
    return line(name, table, ni, nj, first)


def procedural_row(count: int, ni: int, nj: int, first: float) -> str:
    """Return the line of `count` random airfoils with random wall spacing."""
    rng = np.random.default_rng(SEED)
    table = []
    for _ in range(count):
        edges = procedural.boundary(rng, ni, nj)
        begun = time.process_time()
        nodes = hyperbolic(edges, wall_spacing=first).grid.nodes
        table.append([*figures(nodes, first * edges.chord, 0), 1e3 * (time.process_time() - begun)])
    return line(f"{count} procedural, every wall spacing law", np.array(table), ni, nj, first)


def default_rows(cases: list[Case]) -> list[str]:
    """Return the table of C grids without a first cell."""
    heads = "method|nodes|folded|deviation, max|mean|growth xi|growth eta|first cells|CPU ms"
    rows = [f"| {heads.replace('|', ' | ')} |", "| --- " * 9 + "|"]
    for n in SQUARE:
        for name in ("auto", "variational"):
            table = np.array([defaults(case, name, n) for case in cases])
            cells = ["marched" if name == "auto" else name, f"{n}x{n}", f"{table[:, 0].sum():.0f}"]
            for k, digits in ((1, 1), (2, 2), (3, 2), (4, 3)):
                values = np.median(table[:, k]), np.quantile(table[:, k], 0.9)
                cells.append(" / ".join(f"{value:.{digits}f}" for value in values))
            low, high, spent = np.median(table[:, 5:], axis=0)
            rows.append("| " + " | ".join([*cells, f"{low:.1g} to {high:.1g}", f"{spent:.0f}"]) + " |")
    return rows


def defaults(case: Case, name: str, n: int) -> list[float]:
    """Return folded cells, two angles, two growths, the least and greatest first cell, and milliseconds."""
    edges = case.make().boundary(Sampling(n, n, "c", te=case.te))  # type: ignore[arg-type]
    begun = time.process_time()
    nodes = (
        (elliptic() if name == "auto" else fewer_on_quads(method_named(name))).solve([edges])[0].grid.nodes
    )
    spent = 1e3 * (time.process_time() - begun)
    wake = edges.wake + 1
    found = figures(nodes, 1.0, wake)
    wall = nodes[wake - 1 : n - wake + 1, :2]
    heights = np.hypot(*(wall[:, 1] - wall[:, 0]).T) / edges.chord
    return [found[0], found[2], *found[4:], heights.min(), heights.max(), spent]


def line(name: str, table: Floats, ni: int, nj: int, first: float) -> str:
    """Return a table row of figures (shapes, 8)."""
    cells = [name, f"{ni}x{nj}", f"{first:g}", f"{table[:, 0].sum():.0f}", f"{table[:, 1].max():.0e}"]
    for k, digits in ((2, 1), (3, 1), (4, 2), (5, 2), (6, 3), (7, 1)):
        values = [np.median(table[:, k]), np.quantile(table[:, k], 0.9)]
        cells.append(" / ".join(f"{value:.{digits}f}" for value in values[: 1 if len(table) == 1 else 2]))
    return "| " + " | ".join(cells) + " |"


def measured(case: Case, ni: int, nj: int, first: float) -> list[float]:
    """Return folded cells, error of the first cell, three angles, two growths and milliseconds."""
    sampling = Sampling(ni, nj, case.topology, "curvature", te=case.te, viscous=True)  # type: ignore[arg-type]
    spent = []
    for _ in range(REPEAT):
        begun = time.process_time()
        edges = case.make().boundary(sampling)
        nodes = hyperbolic(edges, wall_spacing=first).grid.nodes
        spent.append(1e3 * (time.process_time() - begun))
    wake = edges.wake + 1 if edges.wake else 0
    return [*figures(nodes, first * edges.chord, wake), min(spent)]


def figures(nodes: Floats, first: float, wake: int) -> list[float]:
    """Return folded cells, error of the first cell, deviations, growths; `wake` nodes make it a C."""
    corners = [nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]]
    off = np.zeros(corners[0].shape[:2])
    total = 0.0
    for k, at in enumerate(corners):
        u, v = corners[(k + 1) % 4] - at, corners[k - 1] - at
        angle = np.arctan2(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0], (u * v).sum(axis=-1))
        deviation = np.abs(np.degrees(angle) - 90.0)
        off, total = np.maximum(off, deviation), total + deviation.mean()
    along = np.hypot(*np.moveaxis(np.diff(nodes, axis=0), -1, 0))
    away = np.hypot(*np.moveaxis(np.diff(nodes, axis=1), -1, 0))
    edge = max(wake - 1, 0)
    error = np.abs(away[edge : len(away) - edge, 0] / first - 1.0).max()
    cell = np.arange(len(off)) + 0.5
    far = np.minimum(np.abs(cell - edge), np.abs(cell - (len(off) - edge))) > 3
    turns = [off.max(), off[far].max(), 0.25 * total]
    closed = along if wake else np.vstack([along[-1:], along])
    return [count_folded(nodes), error, *turns, growth(closed), growth(away.T)]


def growth(sizes: Floats) -> float:
    """Return the largest relative step between neighbours along the first axis."""
    ratio = sizes[1:] / sizes[:-1]
    return float(np.maximum(ratio, 1.0 / ratio).max() - 1.0)


if __name__ == "__main__":
    main()
