"""One thread beside two (or more) on single large grids, of the plane and in space: time, and the same bits.

    python benchmarks/bench_threads.py [--threads 2] [--size 3200] [--side 129] [--page threads.md]

Wall-clock seconds, the counts of threads in turn and the least of several rounds, so that a busy machine
slows them alike. The machine should be idle otherwise: a thread without a core of its own only costs time.
"""

import hashlib
import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from bench_volumes import random_faces
from page import arguments, publish

sys.path.append(str(Path(__file__).parents[1] / "tests" / "solvers"))
import surface_shapes

from meshonet.geometry.arrays import Floats, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import count_folded, measure
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.geometry.surface.surface import surface_of
from meshonet.geometry.threads import limited_to
from meshonet.solvers.algebraic.resample.grids import refine_grid, thinned
from meshonet.solvers.algebraic.tfi import interpolate, parameters, tfi
from meshonet.solvers.elliptic.control import thomas_middlecoff
from meshonet.solvers.elliptic.multigrid import Multigrid
from meshonet.solvers.energy.functional import Weights
from meshonet.solvers.energy.preconditioner import Descent
from meshonet.solvers.hyperbolic.march import hyperbolic
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface
from meshonet.solvers.pipeline.make_grid import make_grid
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.volumes.interpolate import arc_laws
from meshonet.solvers.volumes.interpolate import interpolate as fill
from meshonet.solvers.volumes.tfi import tfi as volume_tfi
from meshonet.solvers.volumes.variational import variational
from meshonet.solvers.volumes.winslow import winslow

HEAD = """# Threads

<!-- made by python benchmarks/bench_threads.py --page docs/benchmarks/threads.md -->

Use this page to find how much a second thread speeds up one large grid. The tables give wall-clock times of
solvers and of whole commands. [Threads and GPUs](../guide/threads-and-gpu.md) explains how to set the number
of threads.

*1 thread* and *2 threads* are the shortest of several runs; *speed-up* is their ratio. The times of commands
are without reading and writing files. One and two threads make bitwise identical grids.
"""

WHY = """
## Conclusions

- **Solvers**: with two threads Winslow's solver is 1.42 to 1.65 times as fast, hyperbolic marching 1.45 to
  1.69 times, and the variational method in two dimensions 1.89 times.
- **Volumes by the variational method** gain nothing, because the method iterates on 33³ nodes only.
- **Commands**: two threads speed up `tfi` by a factor of 1.36 and `infer` of a duct by 1.59. `infer` of an
  airfoil and commands with a first-cell height gain nothing. For many such grids use `--jobs`.
"""

Work = Callable[[], Callable[[], object]]
"""Prepares, and returns what is timed; that returns what must be the same."""


@dataclass(frozen=True)
class Case:
    """Something to time on so many nodes."""

    name: str
    nodes: str
    work: Work
    rounds: int = 3


def digest(value: object) -> str:
    """Return a hash of the bits of arrays, grids or plain values."""
    if isinstance(value, Grid):
        value = [block.nodes for block in value.blocks]
    if isinstance(value, np.ndarray):
        return hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()
    if isinstance(value, list):
        return "".join(map(digest, value))
    return repr(value)


def duct(n: int) -> Boundary:
    """Return four wavy sides of n nodes each."""
    t = np.linspace(0.0, 1.0, n)
    south = np.stack([t, -0.1 * np.sin(np.pi * t) * np.sin(3.0 * np.pi * t)], axis=1)
    north = np.stack([t, 1.0 + 0.1 * np.sin(2.0 * np.pi * t)], axis=1)
    west = np.stack([0.1 * np.sin(np.pi * t), t], axis=1)
    east = np.stack([1.0 - 0.05 * np.sin(2.0 * np.pi * t), t], axis=1)
    west[[0, -1]], east[[0, -1]] = [south[0], north[0]], [south[-1], north[-1]]
    return Boundary(south, north, west, east)


def planar_cases(n: int) -> Iterator[Case]:
    """Yield the kernels in the plane, on n x n nodes."""
    nodes = f"{n} x {n}"
    sides = duct(n)
    four = sides.south, sides.north, sides.west, sides.east
    shape = naca("2412")

    def interpolated() -> Callable[[], object]:
        out, laws = planar_nodes(n, n), parameters(four, "arclength")
        interpolate(out[..., 0], out[..., 1], four, laws)
        return lambda: interpolate(out[..., 0], out[..., 1], four, laws) or out

    def cycles(controlled: bool) -> Work:
        def begin() -> Callable[[], object]:
            start = planar_nodes(n, n)
            levels = Multigrid(start, four, False, None, thomas_middlecoff(sides) if controlled else None)
            levels.interpolate_edges(0)

            def act() -> object:
                levels.cycle()
                return start

            return act

        return begin

    def descent() -> Callable[[], object]:
        start = tfi(sides).nodes.copy(order="K")
        under_way = Descent(start, Weights())

        def act() -> object:
            under_way.run(1e-9, 4)
            return start

        return act

    def evaluated() -> Callable[[], object]:
        coarse = tfi(thinned(sides, 65, 65)).nodes
        return lambda: refine_grid(coarse, sides)

    def measured() -> Callable[[], object]:
        grid = tfi(sides)
        return lambda: measure(grid)

    def tested() -> Callable[[], object]:
        grid = tfi(sides)
        return lambda: count_folded(grid.nodes)

    def marched() -> Callable[[], object]:
        wall = shape.boundary(Sampling(n, n, "o"))
        return lambda: hyperbolic(wall, wall_spacing=1e-5).grid

    def whole(what: object, **options: object) -> Work:
        request = GridRequest(Sampling(n, n), **options)  # type: ignore[arg-type]
        return lambda: lambda: make_grid(what, request).grid  # type: ignore[arg-type]

    yield Case("transfinite interpolation", nodes, interpolated, 7)
    yield Case("Winslow, one multigrid cycle", nodes, cycles(False))
    yield Case("Winslow with control functions, one multigrid cycle", nodes, cycles(True))
    yield Case("variational, four iterations", nodes, descent)
    yield Case("hyperbolic marching from an airfoil", nodes, marched)
    yield Case("spline evaluation of a 65 x 65 grid", nodes, evaluated, 5)
    yield Case("test for folded cells", nodes, tested, 7)
    yield Case("quality metrics", nodes, measured, 5)
    yield Case("`tfi`, without file access", nodes, whole(sides, method="tfi"))
    yield Case("`infer` of a duct, without file access", nodes, whole(sides))
    yield Case("`infer` of an airfoil, without file access", nodes, whole(shape))
    yield Case(
        "`infer --first-cell` of an airfoil, without file access", nodes, whole(shape, first_cell=1e-5)
    )
    yield Case(
        "Winslow with first-cell height, without file access",
        nodes,
        whole(sides, method="winslow", first_cell=1e-5),
    )


def solid_cases(side: int) -> Iterator[Case]:
    """Yield the kernels in space, on blocks of `side` nodes along each direction."""
    large = max(side, 161) if side >= 129 else side
    nodes, more = f"{side}³", f"{large}³"

    def interpolated() -> Callable[[], object]:
        faces = random_faces(1, large, 0.03)
        laws, out = arc_laws(faces), np.zeros((3, large, large, large))
        return lambda: fill(faces, laws, out=out)

    def tested() -> Callable[[], object]:
        block: Floats = volume_tfi(random_faces(1, large, 0.03)).grid.nodes
        return lambda: count_folded(block)

    def solved(method: Callable[..., object]) -> Work:
        faces = random_faces(1, side, 0.03)
        return lambda: lambda: method(faces).grid  # type: ignore[attr-defined]

    def marched() -> Callable[[], object]:
        march = VolumeMarch(1e-3, 41, 4.0)
        surface = surface_of(surface_shapes.grid_of(surface_shapes.sphere(side - 1)))
        return lambda: march_surface(surface, march).grid

    yield Case("transfinite interpolation", more, interpolated, 5)
    yield Case("test for folded cells", more, tested, 5)
    yield Case("Winslow, to the discretisation error", nodes, solved(winslow), 1)
    yield Case("variational on 33³ nodes, interpolated to all", nodes, solved(variational), 1)
    yield Case("hyperbolic marching from a sphere", f"6 x {side} x {side} x 41", marched, 1)


def row(case: Case, threads: int) -> str:
    """Return the line of a table: seconds with one thread and with more.

    Raises ArithmeticError: the results differ.
    """
    least: dict[int, float] = {}
    bits: dict[int, list[str]] = {1: [], threads: []}
    acts = {}
    for count in bits:
        with limited_to(count):
            acts[count] = case.work()
    for _ in range(case.rounds):
        for count, act in acts.items():
            with limited_to(count):
                begun = time.perf_counter()
                result = act()
                spent = time.perf_counter() - begun
            least[count] = min(spent, least.get(count, np.inf))
            bits[count].append(digest(result))
    if bits[1] != bits[threads]:
        raise ArithmeticError(f"{case.name}: other bits with {threads} threads")
    line = f"| {case.name} | {case.nodes} | {least[1]:.3f} | {least[threads]:.3f} "
    return f"{line}| {least[1] / least[threads]:.2f} |"


def table(cases: Iterator[Case], threads: int) -> str:
    """Return the table of some cases, each printed as soon as it is there."""
    lines = [f"| computation | nodes | 1 thread, s | {threads} threads, s | speed-up |"]
    lines.append("| --- | --- | --- | --- | --- |")
    for case in cases:
        lines.append(row(case, threads))
        print(lines[-1], flush=True)
    return "\n".join(lines)


def main() -> None:
    """Print the tables; write the page when asked."""
    parser = arguments(__doc__)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--size", type=int, default=3200, help="nodes along both directions of the plane")
    parser.add_argument("--side", type=int, default=129, help="nodes along the three directions in space")
    chosen = parser.parse_args()
    load = os.getloadavg()[0]
    plane = table(planar_cases(chosen.size), chosen.threads)
    space = table(solid_cases(chosen.side), chosen.threads)
    busy = f"\nMeasured on {os.cpu_count()} cores, with a load average of {load:.1f} at the start.\n"
    text = f"{HEAD}{busy}\n## Two-dimensional grids\n\n{plane}\n\n## Volumes\n\n{space}\n{WHY}"
    publish(text, chosen.page, shown=True)


if __name__ == "__main__":
    main()
