"""The elliptic solvers: seconds, rate a cycle, memory, order of convergence; sources at walls; channels.

    python benchmarks/bench_elliptic.py [--sizes 400,1600] [--largest 3200] [--page PAGE.md]

One thread, float64, processor seconds, so that neighbours on the machine count little. Construct2D's figures
and those of the paper stand beside ours as they were measured or published; they are not measured here.
"""

import tracemalloc
from collections.abc import Callable, Iterator
from typing import TypeVar

import numpy as np
from clock import clocked
from page import arguments, processor, publish

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.families.family import FAMILIES, family
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.growth import growing_steps
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.elliptic.solve import solve, solve_thomas_middlecoff
from meshonet.solvers.elliptic.steger_sorenson import solve_steger_sorenson
from meshonet.solvers.layers.first_cells import Heights
from meshonet.solvers.layers.redistribute import spread, worst_first_cell
from meshonet.solvers.layers.slide_nodes import slide_walls

Result = TypeVar("Result")

HEAD = """# Elliptic solvers: time, convergence, memory

<!-- made by python benchmarks/bench_elliptic.py --largest 3200 --page docs/benchmarks/elliptic.md -->

Use this page to find the CPU time, the convergence and the memory of the [elliptic
solvers](../theory/elliptic.md), the methods `winslow`, `thomas-middlecoff` and `steger-sorenson` of
`solve-pde`. The cases are the six shapes of the MeshONet paper, NACA 0012 and channels. Times are for one
thread of {processor}.

- *default*: the iteration stops when its error is below the discretisation error. *to 1e-8*: it stops when
  the residual is 1e-8 times the initial residual.
- *reduction per cycle*: residual after a multigrid cycle divided by the residual before it; geometric mean
  over the cycles.
- *memory*: peak memory of the solver with the grid, in float64 numbers per node.
- *folded cells*: number before repair.
"""

OTHERS = """
## Compared with other programs

The table gives seconds for an elliptic grid, or for the most similar grid that the program makes. The times
of the MeshONet paper (arXiv 2501.11937) and of Construct2D, a grid generator for airfoils, were measured on
other machines. Empty cells: time unknown.

| program | 100x100 | 200x200 | 250x100 | 400x400 | 800x800 | 1600x1600 | 3200x3200 |
| --- | --- | --- | --- | --- | --- | --- | --- |
| MeshONet paper, PDE solver | 140.3 | 586.2 | | 2360.7 | 9795.9 | | |
| MeshONet paper, TFI | 0.087 | 0.218 | | 0.928 | 3.8 | 15.2 | 72.1 |
| MeshONet paper, network on a GPU | 0.001 | 0.002 | | 0.002 | 0.006 | 0.026 | 0.278 |
| Construct2D, elliptic O grid, not converged | | | 10 to 17 | | | | |
| Construct2D, hyperbolic O grid | | | 0.15 | | 15.6 | | |
| gmsh, transfinite grid, without writing | | | | | | | 4.95 |
"""
CONTROLS = """
The control functions of `--method thomas-middlecoff` continue the node distribution of the sides into the
interior.

- *prescribed first-cell height*: first spacing of the nodes on the west and east sides.
- *median first-cell height*: median over the cells at the south side.
"""
CHANNELS_NOTE = """
- *steger-sorenson*: control functions make grid lines normal to the walls. *winslow, --slide*: nodes move
  along the walls until grid lines are normal to them.
- *relative error of first-cell height*: maximum over both walls.
- *largest angle to wall normal*: angle between the grid lines that leave the walls and the wall normal.
"""
CONCLUSIONS = """
## Conclusions

- **Time**: by default a Winslow grid takes 0.03 to 0.05 s on 400x400 nodes, and 3.5 to 4.0 s on 3200x3200
  nodes. With the rule *to 1e-8* it takes two to four times as long.
- **Folded cells**: only grids of the wrench have folded cells. `solve-pde` repairs them.
- **First cells**: with the control functions of Thomas and Middlecoff the median first-cell height is the
  prescribed height on the arch, and 1.8 times this height on the hexagon.
- **Channels**: use `winslow --slide` for grid lines normal to the walls, if nodes may move along the walls.
  The angles to the wall normal are then at most 0.19 degrees; without `--slide` they are 6 to 37 degrees.
  `winslow --slide` takes 81 to 195 ms, `steger-sorenson` 359 to 410 ms.
"""


def shapes(n: int) -> Iterator[tuple[str, Boundary]]:
    """Yield the six families and NACA 0012, n x n nodes each."""
    for name in FAMILIES:
        one = family(name)
        yield name, one.boundary(0.5 * (one.low + one.high), n, n)
    yield "NACA 0012, sharp", naca("0012-sharp").boundary(Sampling(n, n))


def doubles_a_node(edges: Boundary) -> float:
    """Return the most memory that solving takes, in float64 numbers a node."""
    tracemalloc.start()
    solve(edges)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most / 8 / (edges.ni * edges.nj)


def row(name: str, edges: Boundary) -> str:
    """Return one line of the table of shapes."""
    to_level, level = clocked(lambda: solve(edges), 2)
    to_exact, exact = clocked(lambda: solve(edges, tol=1e-8, max_cycles=60), 2)
    folded = count_folded(level.grid.nodes)
    rate = (exact.residual or 0.0) ** (1.0 / max(1, exact.cycles or 1))
    return (
        f"| {name} | {edges.ni} | {to_level:.3f} | {to_exact:.3f} | {exact.cycles} "
        f"| {rate:.2f} | {doubles_a_node(edges):.1f} | {folded} |"
    )


def speed(sizes: list[int], largest: int) -> Iterator[str]:
    """Yield the table of shapes; of the largest size some only."""
    yield "\n## Winslow's equations\n"
    yield (
        "| shape | nodes per side | CPU time, default, s | CPU time to 1e-8, s | cycles to 1e-8 "
        "| reduction per cycle | memory, doubles per node | folded cells |"
    )
    yield "| --- |" + " --- |" * 7
    for n in sizes:
        for name, edges in shapes(n):
            yield row(name, edges)
    if largest:
        for name, edges in shapes(largest):
            if name in ("arch", "hole", "NACA 0012, sharp"):
                yield row(name, edges)


def ours(largest: int) -> str:
    """Return our line of the table beside others."""
    cells = []
    for ni, nj in ((100, 100), (200, 200), (250, 100), (400, 400), (800, 800), (1600, 1600), (3200, 3200)):
        if max(ni, nj) > max(largest, 1600):
            cells.append("")
            continue
        spent, _ = clocked(
            lambda ni=ni, nj=nj: solve(naca("0012-sharp").boundary(Sampling(ni, nj))),  # type: ignore[misc]
            2,
        )
        cells.append(f"{spent:.3f}")
    return "| meshonet, O grid around NACA 0012, default | " + " | ".join(cells) + " |"


def conformal(n: int) -> Floats:
    """Return nodes of z = exp ζ over a rectangle, the exact solution of Winslow's equations."""
    z = np.exp(np.linspace(0, 1.5, 2 * n - 1)[:, None] + 1j * np.linspace(0, 1, n))
    return np.stack([z.real, z.imag], axis=-1)


def order() -> Iterator[str]:
    """Yield errors against the conformal map, and the fitted slope."""
    yield "\n## Order of convergence\n"
    yield "The exact grid is polar: radii exp ξ, angles η. The error is the largest error of a coordinate.\n"
    yield "| nodes | error |\n| --- | --- |"
    counts, errors = np.array([17, 33, 65, 129, 257]), []
    for n in counts.tolist():
        exact = conformal(n)
        edges = Boundary(exact[:, 0], exact[:, -1], exact[0], exact[-1])
        errors.append(float(np.abs(solve(edges, tol=1e-10, max_cycles=60).grid.nodes - exact).max()))
        yield f"| {2 * n - 1} x {n} | {errors[-1]:.1e} |"
    slope = -np.polyfit(np.log(counts - 1), np.log(errors), 1)[0]
    yield f"\nThe order of convergence, fitted to these errors, is {slope:.2f}."


def ramp(x: Floats, steepness: float) -> Floats:
    """Return a smooth step from 0 to 1 at x = 2."""
    return np.asarray(1.0 / (1.0 + np.exp(-steepness * (x - 2.0))))


CHANNELS: dict[str, Callable[[Floats], tuple[Floats, Floats]]] = {
    "bump": lambda x: (0.2 * np.exp(-8 * (x - 2) ** 2), 1 + 0 * x),
    "two bumps": lambda x: (0.2 * np.exp(-8 * (x - 1.5) ** 2), 1 - 0.15 * np.exp(-10 * (x - 2.3) ** 2)),
    "nozzle": lambda x: (0 * x, 1 - 0.5 * np.exp(-3 * (x - 2) ** 2)),
    "contraction": lambda x: (0 * x, 1 - 0.4 * ramp(x, 6)),
    "S-duct": lambda x: (0.6 * ramp(x, 5), 1 + 0.6 * ramp(x, 5)),
    "diffuser": lambda x: (0 * x, 1 + 0.3 * (x / 4) ** 2 * (3 - x / 2)),
    "hills": lambda x: (0.05 * (1 - np.cos(np.pi * x)), 1 + 0 * x),
}


def channel(name: str, ni: int, nj: int) -> Boundary:
    """Return a channel of length 4 with straight ends."""
    x = np.linspace(0, 4, ni)
    floor, roof = CHANNELS[name](x)
    south, north = np.stack([x, floor], axis=1), np.stack([x, roof], axis=1)
    t = np.linspace(0, 1, nj)[:, None]
    sides = [(1 - t) * south[k] + t * north[k] for k in (0, -1)]
    for side, k in zip(sides, (0, -1), strict=True):
        side[0], side[-1] = south[k], north[k]
    return Boundary(south, north, *sides, name=name)


def leans(nodes: Floats, edges: Boundary) -> float:
    """Return the largest angle between first cells and the normals of both walls, in degrees."""
    most = 0.0
    for wall, (one, two) in ((edges.south, (0, 1)), (edges.north, (-1, -2))):
        curve, out = Curve(wall), nodes[:, two] - nodes[:, one]
        sine = (out * curve.tangent(curve.knots)).sum(axis=1) / np.hypot(*out.T)
        most = max(most, float(np.degrees(np.arcsin(np.abs(sine).max()))))
    return most


def walls(ni: int, nj: int) -> Iterator[str]:
    """Yield the table of channels with first cells of 1e-5 at both walls."""
    yield f"\n## Channels with first cells of 1e-5 at both walls, {ni} x {nj} nodes"
    yield CHANNELS_NOTE
    yield (
        "| channel | method | folded cells | relative error of first-cell height "
        "| largest angle to wall normal, degrees | CPU time, ms |"
    )
    yield "| --- " * 6 + "|"
    heights = Heights(south=1e-5, north=1e-5)

    def plain(edges: Boundary) -> tuple[object, Boundary]:
        return solve(edges), edges

    def turned(edges: Boundary) -> tuple[object, Boundary]:
        return solve_steger_sorenson(edges, heights={"south": 1e-5, "north": 1e-5}), edges

    def slid(edges: Boundary) -> tuple[object, Boundary]:
        moved, controls = slide_walls(edges)
        return solve(moved, controls=controls), moved

    ways = {"winslow": plain, "steger-sorenson": turned, "winslow, --slide": slid}
    for name in CHANNELS:
        edges = channel(name, ni, nj)
        for way, make in ways.items():

            def act(make=make, edges=edges):  # type: ignore[no-untyped-def]
                made, moved = make(edges)
                return spread(made, moved, heights), moved

            spent, (made, moved) = clocked(act, 2)
            nodes = made.grid.nodes
            yield (
                f"| {name} | {way} | {count_folded(nodes)} | {worst_first_cell(made):.0e} "
                f"| {leans(nodes, moved):.2f} | {1e3 * spent:.0f} |"
            )


def clustered(edges: Boundary, first: float) -> Boundary:
    """Return `edges` with west and east growing from `first` at the south."""
    sides = []
    for side in (edges.west, edges.east):
        length = float(np.hypot(*(side[-1] - side[0])))
        steps = np.concatenate([[0.0], np.cumsum(growing_steps(first, length, edges.nj - 1))]) / length
        steps[-1] = 1.0
        sides.append(side[0] + steps[:, None] * (side[-1] - side[0]))
        sides[-1][-1] = side[-1]
    return Boundary(edges.south, edges.north, *sides, name=edges.name)


def controls(sizes: tuple[int, ...]) -> Iterator[str]:
    """Yield the table of Thomas and Middlecoff's control functions."""
    yield "\n## Control functions of Thomas and Middlecoff"
    yield CONTROLS
    yield (
        "| shape | nodes per side | prescribed first-cell height | median first-cell height | folded cells "
        "| CPU time to 1e-8, s | cycles to 1e-8 |"
    )
    yield "| --- |" + " --- |" * 6
    for n in sizes:
        for name in ("arch", "hexagon"):
            for first in (1e-3, 1e-5):
                one = family(name)
                edges = clustered(one.boundary(0.5 * (one.low + one.high), n, n), first)
                spent, made = clocked(
                    lambda edges=edges: solve_thomas_middlecoff(edges, tol=1e-8, max_cycles=60),  # type: ignore[misc]
                    2,
                )
                nodes = made.grid.nodes
                median = float(np.median(np.hypot(*(nodes[:, 1] - nodes[:, 0]).T)))
                yield (
                    f"| {name} | {n} | {first:g} | {median:.1e} | {count_folded(nodes)} "
                    f"| {spent:.3f} | {made.cycles} |"
                )


def page(sizes: list[int], largest: int) -> Iterator[str]:
    """Yield the page line by line."""
    yield HEAD.format(processor=processor())
    yield from speed(sizes, largest)
    yield OTHERS.rstrip("\n")
    yield ours(largest)
    yield from order()
    yield from controls((400, 800))
    yield from walls(401, 121)
    yield CONCLUSIONS.rstrip()


def main() -> None:
    """Print the page, and write it to --page."""
    parser = arguments(__doc__)
    parser.add_argument("--sizes", default="400,1600")
    parser.add_argument("--largest", type=int, default=0, help="one more size, for three of the shapes")
    options = parser.parse_args()
    lines = []
    for line in page([int(n) for n in options.sizes.split(",")], options.largest):
        print(line, flush=True)
        lines.append(line)
    publish("\n".join(lines) + "\n", options.page, shown=True)


if __name__ == "__main__":
    main()
