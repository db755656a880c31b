"""Quad grids by TFI, Winslow and the variational method, directly and through a coarse solve.

    python benchmarks/bench_variational.py [--sizes 65,129,800] [--domains 60] [--page PAGE.md]

Folded cells, included angles (largest of each cell), deviation from orthogonal at the walls, relative L2
distance to the full solve, and processor time of one thread; beside it, the time to copy the grid.
"""

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeVar

import numpy as np
from clock import clocked
from page import arguments, publish

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "solvers"))
from random_quads import random_quad
from solver_shapes import arch, bump, hexagon, wrench

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import count_folded, measure
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.algebraic.resample.grids import thinned
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.neural.registry import load
from meshonet.solvers.pipeline.choose_method import Best
from meshonet.solvers.pipeline.coarse import solve_coarse
from meshonet.solvers.solution import Solution

Way = Callable[[Boundary], Solution]
T = TypeVar("T")
SHAPES = (arch, hexagon, bump, wrench)


def main() -> None:
    """Measure and print; write the page and its picture when asked."""
    parser = arguments(__doc__)
    parser.add_argument("--sizes", default="65,129,800")
    parser.add_argument("--large", type=int, default=3200, help="one more size, of the arch alone")
    parser.add_argument("--domains", type=int, default=60, help="random domains to try")
    parser.add_argument("--bodies-at", default="200x100", help="nodes around bodies")
    options = parser.parse_args()
    parts = [HEAD, PAPER]
    for n in (int(word) for word in options.sizes.split(",")):
        parts.append(shapes(n))
    parts.append(shapes(options.large, (arch,)))
    parts.extend(domains(n, options.domains) for n in (65, 129))
    parts.append(bodies(options.bodies_at))
    publish("\n".join(parts) + "\n", options.page)
    if options.page:
        picture(options.page.parents[1] / "img" / "quad-grids.png")


def ways(n: int) -> dict[str, Way]:
    """Return the ways to compare at n x n nodes; full variational solves up to 800."""
    methods: dict[str, Way] = {"TFI": lambda b: Solution(tfi(b), "tfi"), "winslow": winslow}
    counts = [m for m in (33, 65, 129) if m < n]
    for m in counts:
        methods[f"winslow --coarse {m}"] = partial(solve_coarse, solve=winslow, n=m, smooth=True)
    if n <= 800:
        methods["**variational**"] = variational
    for m in counts:
        methods[f"**variational --coarse {m}**"] = partial(solve_coarse, solve=variational, n=m, smooth=True)
    methods["neural operator, quad-general"] = lambda b: load("quad-general").solve([b])[0]
    return methods


def shapes(n: int, makers: tuple[Callable[[int, int], Boundary], ...] = SHAPES) -> str:
    """Return the tables of the shapes at n x n nodes."""
    lines = [f"\n## {n} x {n}\n"]
    for make in makers:
        boundary = make(n, n)
        lines += [f"\n{boundary.name}\n", TABLE, RULE]
        reference: dict[str, Floats] = {}
        for name, way in ways(n).items():
            full_solve = "coarse" not in name
            seconds, nodes = best(way, boundary, 7 if n < 500 else 1 if full_solve else 4)
            family = "variational" if name.startswith("neural") else name.strip("*").split()[0]
            full = reference.setdefault(family, nodes)
            lines.append(row(name, nodes, full, seconds))
        copied = clocked(partial(full.copy, order="K"), 5)[0]
        lines.append(f"| copy of the grid in memory | | | | | {1e3 * copied:.1f} |")
    return "\n".join(lines)


def row(name: str, nodes: Floats, full: Floats, seconds: float) -> str:
    """Return one line of a table."""
    angles = measure(Grid.from_nodes(nodes), percentiles=True)["max_angle"]
    spread = np.linalg.norm(full - full.mean(axis=(0, 1)))
    apart = "" if nodes is full else f"{np.linalg.norm(nodes - full) / spread:.1e}"
    figures = f"{angles.max:.1f} / {angles.p99:.1f} / {angles.mean:.1f} | {wall(nodes):.1f}"
    return f"| {name} | {count_folded(nodes)} | {figures} | {apart} | {1e3 * seconds:.1f} |"


def wall(nodes: Floats) -> float:
    """Return the mean deviation from 90 degrees of the lines that leave the four edges."""
    angles = []
    for side in (nodes, nodes[:, ::-1], nodes.swapaxes(0, 1), nodes.swapaxes(0, 1)[:, ::-1]):
        along, off = side[2:, 0] - side[:-2, 0], side[1:-1, 1] - side[1:-1, 0]
        cosine = (along * off).sum(axis=-1)
        cosine /= np.linalg.norm(along, axis=-1) * np.linalg.norm(off, axis=-1)
        angles.append(np.degrees(np.arcsin(np.clip(np.abs(cosine), 0, 1))))
    return float(np.concatenate(angles).mean())


def domains(n: int, count: int) -> str:
    """Return the table over random domains at n x n nodes."""
    boundaries = [b for seed in range(count) if (b := random_quad(seed, n, n)) is not None]
    lines = [f"\n## {len(boundaries)} random four-sided domains, {n} x {n}\n"]
    lines += ["| method | folded grids | max / mean angle, average | worse than Winslow's | CPU ms, median |"]
    lines += ["| --- | --- | --- | --- | --- |"]
    reference: list[tuple[float, float]] = []
    for name, way in ways(65).items():
        angles, folded, spent = [], 0, []
        for boundary in boundaries:
            seconds, solution = clocked(partial(way, boundary))
            summary = measure(solution.grid)["max_angle"]
            angles.append((summary.max, summary.mean))
            folded += count_folded(solution.grid.nodes) > 0
            spent.append(seconds)
        reference = angles if name == "winslow" else reference
        pairs = list(zip(angles, reference, strict=False))
        worse = sum(a[0] > r[0] + 1e-9 or a[1] > r[1] for a, r in pairs)
        highest, mean = np.mean(angles, axis=0)
        median = 1e3 * np.median(spent)
        report = worse if reference and name != "winslow" else ""
        lines.append(f"| {name} | {folded} | {highest:.1f} / {mean:.1f} | {report} | {median:.1f} |")
    return "\n".join(lines)


def bodies(res: str) -> str:
    """Return the table of O and C grids around airfoils at ``NIxNJ`` nodes."""
    ni, nj = (int(word) for word in res.split("x"))
    lines = [f"\n## Around airfoils, {ni} x {nj}\n", *BODIES]
    for name in ("0012", "0012-sharp", "4415", "23012"):
        for topology in ("o", "c"):
            boundary = naca(name).boundary(Sampling(ni, nj, topology=topology))
            around: dict[str, Way] = {"TFI": lambda b: Solution(tfi(b), "tfi")}
            around["winslow"] = lambda b: winslow(thinned(b, b.ni, b.nj))
            if topology == "o":
                around["infer, default"] = Best().solve_one
            around["**variational**"] = variational
            for way, solver in around.items():
                seconds, nodes = best(solver, boundary, 3)
                angles = measure(boundary.grid(nodes), percentiles=True)["max_angle"]
                figures = f"{angles.max:.1f} / {angles.p99:.1f} / {angles.mean:.2f}"
                start = f"| NACA {name}, {topology.upper()} | {way} | {count_folded(nodes)}"
                lines.append(f"{start} | {figures} | {1e3 * seconds:.0f} |")
    return "\n".join(lines)


def picture(path: Path) -> None:
    """Draw the shapes at 33 x 33 nodes, coloured by the largest included angle of each cell."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    drawn: dict[str, Way] = {
        "TFI": lambda b: Solution(tfi(b), "tfi"),
        "Winslow": winslow,
        "Winslow, coarse 17": partial(solve_coarse, solve=winslow, n=17, smooth=True),
        "variational": variational,
        "variational, coarse 17": partial(solve_coarse, solve=variational, n=17, smooth=True),
    }
    figure, axes = plt.subplots(len(SHAPES), len(drawn), figsize=(15, 13), layout="constrained")
    for line, make in zip(axes, SHAPES, strict=True):
        for axis, (name, way) in zip(line, drawn.items(), strict=True):
            nodes = way(make(33, 33)).grid.nodes
            x, y = nodes[..., 0], nodes[..., 1]
            angles = np.clip(largest_angles(nodes), 90, 150)
            mesh = axis.pcolormesh(x, y, angles, cmap="RdYlBu_r", vmin=90, vmax=150, lw=0.1, ec="k")
            axis.set(title=f"{make.__name__}: {name}", aspect="equal")
            axis.set_axis_off()
    figure.colorbar(mesh, ax=axes, shrink=0.5, label="largest included angle, degrees")
    figure.savefig(path, dpi=60)


def largest_angles(nodes: Floats) -> Floats:
    """Return the largest included angle of each cell (ni-1, nj-1), in degrees."""
    ring = [nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]]
    angles = []
    for k in range(4):
        u, v = ring[(k + 1) % 4] - ring[k], ring[k - 1] - ring[k]
        cross = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
        angles.append(np.degrees(np.arctan2(cross, (u * v).sum(axis=-1))) % 360)
    return np.asarray(np.max(angles, axis=0))


def best(way: Way, boundary: Boundary, repeats: int) -> tuple[float, Floats]:
    """Return the least processor seconds of `repeats` runs, and the nodes."""
    runs = [clocked(partial(way, boundary)) for _ in range(repeats)]
    return min(seconds for seconds, _ in runs), runs[0][1].grid.nodes


TABLE = "| method | folded | max / 99 % / mean angle | deviation at walls | distance to full solve | CPU ms |"
RULE = "| --- | --- | --- | --- | --- | --- |"
BODIES = (
    "| body | method | folded | max / 99 % / mean angle | CPU ms |",
    "| --- | --- | --- | --- | --- |",
)
HEAD = """# Four-sided domains: TFI, Winslow and variational grids

<!-- made by python benchmarks/bench_variational.py --page docs/benchmarks/variational.md -->

Use this page to choose between `tfi`, `solve-pde --method winslow` and `solve-pde --method variational`. The
option `--coarse N` solves on N x N nodes and interpolates. [Elliptic grids](../theory/elliptic.md),
[variational grids](../theory/variational.md) and [the neural operator](quad-operator.md) have their own
pages. The shape *bump* is a square with a half disc cut off; the row *infer, default* solves Winslow's
equations in a conformal strip.

- *max / 99 % / mean angle*: maximum, 99th percentile and mean, over the cells, of the largest angle of a
  cell, in degrees. The maximum cannot be below the largest corner angle of the boundary (arch 147.5, hexagon
  135). *average*: mean over the domains.
- *deviation at walls*: mean deviation from 90 degrees of the angle between the four sides and the grid
  lines that leave them.
- *distance to full solve*: relative L2 distance to the grid that the same method computes on all nodes (its
  first row in the table). The neural operator is compared with the variational grid. On 3200 x 3200 nodes the
  variational method is not run on all nodes; the grid of `variational --coarse 33` takes its place.
- *folded*: number of folded cells, before repair. *folded grids*: number of domains whose grid has such
  cells.
- *worse than Winslow's*: number of domains for which the maximum or the mean angle is larger than in
  Winslow's grid.
- *CPU ms*: CPU time of one thread, best of several runs (*median*: over the domains), while other programs
  used the machine.
- *copy of the grid in memory*: time to copy the finished grid once, for comparison.

On fine grids of the wrench the variational method takes many iterations, because of the notch; `--coarse
auto` then solves on fewer nodes. The distance between a solution on 33 x 33 nodes and the solution on all
nodes is the discretisation error of the coarse solution (second order). It is not an error of convergence:
with both solutions converged to 1e-6, the distance is the same.

![Grids by five methods, coloured by the largest included angle](../img/quad-grids.png)
"""
PAPER = """
## What the MeshONet paper reports
Xiao et al., arXiv 2501.11937, compare methods by colour maps of the largest included angle, without numbers.
They report that MeshONet's angles are better than those of their PDE solver and TFI on arches and hexagons,
equal to TFI's on wrenches, and not always better on semicircles. The table gives the times of the paper in
seconds. The programs of the paper are in Python and ran on another machine, MeshONet on a GPU.

| nodes | PDE | TFI | MeshONet |
| --- | --- | --- | --- |
| 100 x 100 | 140 | 0.09 | 0.001 |
| 800 x 800 | 9796 | 3.8 | 0.006 |
| 3200 x 3200 | - | 72 | 0.28 |
"""

if __name__ == "__main__":
    main()
