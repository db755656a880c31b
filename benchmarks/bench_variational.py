"""Quad grids by TFI, Winslow and the variational method, directly and through a coarse solve.

    python benchmarks/bench_variational.py [--sizes 65,129,800] [--domains 60] [--page PAGE.md]

Folded cells, included angles (largest of each cell), deviation from orthogonal at the walls, relative L2
distance to the full solve, and processor time of one thread.
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
    parts = [HEAD]
    for n in (int(word) for word in options.sizes.split(",")):
        parts.append(shapes(n))
    parts.append(shapes(options.large, (arch,)))
    parts.extend(domains(n, options.domains) for n in (65, 129))
    parts.append(bodies(options.bodies_at))
    publish("\n".join(parts) + "\n" + CONCLUSIONS, options.page)
    if options.page:
        picture(options.page.parents[1] / "img" / "quad-grids.png")


def ways(n: int) -> dict[str, Way]:
    """Return the ways to compare at n x n nodes; full variational solves up to 800."""
    methods: dict[str, Way] = {"TFI": lambda b: Solution(tfi(b), "tfi"), "winslow": winslow}
    counts = [m for m in (33, 65, 129) if m < n]
    for m in counts:
        methods[f"winslow --coarse {m}"] = partial(solve_coarse, solve=winslow, n=m, smooth=True)
    if n <= 800:
        methods["variational"] = variational
    for m in counts:
        methods[f"variational --coarse {m}"] = partial(solve_coarse, solve=variational, n=m, smooth=True)
    methods["network `quad-general`"] = lambda b: load("quad-general").solve([b])[0]
    return methods


def shapes(n: int, makers: tuple[Callable[[int, int], Boundary], ...] = SHAPES) -> str:
    """Return the table of the shapes at n x n nodes."""
    lines = [f"\n## {n} x {n} nodes\n", TABLE, RULE]
    for make in makers:
        boundary = make(n, n)
        reference: dict[str, Floats] = {}
        for name, way in ways(n).items():
            full_solve = "coarse" not in name
            seconds, nodes = best(way, boundary, 7 if n < 500 else 1 if full_solve else 4)
            if name in ("winslow", "variational"):
                reference[name] = nodes
            full = reference.get("variational" if name.startswith("network") else name.split()[0], nodes)
            lines.append(f"| {boundary.name} {row(name, nodes, full, seconds)}")
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
    lines = [f"\n## {len(boundaries)} random four-sided domains, {n} x {n} nodes\n"]
    lines += [DOMAINS]
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
    lines = [f"\n## Around airfoils, {ni} x {nj} nodes\n", *BODIES]
    for name in ("0012", "0012-sharp", "4415", "23012"):
        for topology in ("o", "c"):
            boundary = naca(name).boundary(Sampling(ni, nj, topology=topology))
            around: dict[str, Way] = {"TFI": lambda b: Solution(tfi(b), "tfi")}
            around["winslow"] = lambda b: winslow(thinned(b, b.ni, b.nj))
            if topology == "o":
                around["infer"] = Best().solve_one
            around["variational"] = variational
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


ANGLES = "largest angle of a cell, degrees: maximum / 99th percentile / mean"
TABLE = (
    f"| shape | method | folded cells | {ANGLES} | deviation from 90 degrees at the sides "
    "| distance to the solution on all nodes | CPU time, ms |"
)
RULE = "| --- | --- | --- | --- | --- | --- | --- |"
DOMAINS = (
    "| method | grids with folded cells | largest angle of a cell, degrees: maximum / mean "
    "| grids worse than Winslow's | CPU time, ms |"
)
BODIES = (
    f"| airfoil, topology | method | folded cells | {ANGLES} | CPU time, ms |",
    "| --- | --- | --- | --- | --- |",
)
HEAD = """# Four-sided domains: TFI, Winslow and variational grids

<!-- made by python benchmarks/bench_variational.py --page docs/benchmarks/variational.md -->

Use this page to choose a method for four-sided domains and NACA airfoils: `tfi`, `solve-pde --method
winslow` or `solve-pde --method variational`. It also helps to choose the number of nodes for `--coarse`,
with which the equations are solved on fewer nodes. For the methods see
[elliptic grids](../theory/elliptic.md) and [variational grids](../theory/variational.md).

- *arch*, *hexagon*, *wrench*: shapes of the MeshONet paper (arXiv 2501.11937). *bump*: a square with a half
  disc cut out of the south side.
- *--coarse N*: solution on N x N nodes, interpolated to all nodes.
- *network `quad-general`*: a [network](quad-operator.md) that predicts the variational grid.
- *infer*: `infer` without options. It maps the domain conformally to a strip, and solves Winslow's
  equations there.
- *NACA 0012-sharp*: NACA 0012 with a closed trailing edge.
- *folded cells*: number before repair.
- *maximum*, *99th percentile*, *mean*: of the largest angles of all cells; for random domains, averages of
  these values. The maximum cannot be below the largest corner angle of the boundary (arch 147.5 degrees,
  hexagon 135 degrees).
- *deviation from 90 degrees at the sides*: mean over the grid lines that leave the four sides.
- *distance to the solution on all nodes*: RMS distance from the grid without `--coarse` (for the
  network: from the variational grid), divided by the RMS distance of the nodes from their centroid.
- *grids worse than Winslow's*: number of grids whose maximum or mean is larger than in Winslow's grid.
- *CPU time*: of one thread, best of several runs; for random domains, the median over the domains.

![Grids of 33 x 33 nodes by five methods, coloured by the largest angle of each cell](../img/quad-grids.png)
"""
CONCLUSIONS = """
## Conclusions

The first three are for 52 random domains of 129 x 129 nodes.

- **Angles**: the mean of the largest angles of the cells is 96.0 degrees in variational grids, 106.4 in
  Winslow's grids and 111.6 in TFI grids.
- **Folded cells**: no variational grid has folded cells; 2 of Winslow's grids and 6 TFI grids have some.
- **Time**: the variational method takes 15.8 ms, Winslow's equations take 5.5 ms. With `--coarse 33` the
  variational method takes 5.0 ms, and one grid has folded cells.
- **Fine grids**: on 800 x 800 nodes `variational --coarse 129` takes 21 to 58 ms, `variational` takes 479 to
  642 ms. The mean angles of the two grids differ by at most 0.1 degrees.
- **Airfoils**: for O grids use `infer`, which takes 3 to 4 ms; a variational O grid takes 39 to 46 ms. For C
  grids use [marching](marching.md#c-grids-without-a-first-cell).
"""

if __name__ == "__main__":
    main()
