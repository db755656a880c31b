"""Folded grids of many blocks in space, smoothed: what becomes of them, and what an iteration costs.

    python benchmarks/bench_smooth_volumes.py [--size 0.6] [--surfaces DIRECTORY]

Nodes inside of a shell of six blocks, a bent pipe of five, and extruded blocks of the plane are moved at
random by up to `size` times the shortest edge at them. Printed are folded cells, the mean deviation from 90
degrees and the least scaled Jacobian of the grid, of what was made of it, and of that smoothed; processor
seconds; and nanoseconds of one thread for a node and an iteration of the descent. Blocks marched off the
`--surfaces` (a folder as of ``bench_marching.py``) are smoothed as they are: how far first cells change too.
"""

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from bench_marching import Case, cases_of
from block_grids import butterfly, o_ring
from joined_volumes import bend, perturbed, shell

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import measure
from meshonet.geometry.surface.surface import surface_of
from meshonet.geometry.threads import limited_to
from meshonet.geometry.volume.hex_mesh import hex_mesh_of
from meshonet.solvers.energy.hex_functional import OPTIMAL
from meshonet.solvers.energy.hexes import HexProblem
from meshonet.solvers.hyperbolic.volume.march import march_surface
from meshonet.solvers.smoothing.volume_spacing import wanted_edges
from meshonet.solvers.smoothing.volumes import smooth_volumes

ITERATIONS = 20
SHAPES: dict[str, Callable[[], Grid]] = {
    "shell, 6 blocks": lambda: shell(n=25, layers=32, first=0.01),
    "pipe bend, 5 blocks": lambda: bend(n=15, m=13, along=65),
    "extruded butterfly": lambda: extruded(butterfly(17, 13), np.linspace(0.0, 3.0, 49)),
    "extruded O ring": lambda: extruded(o_ring(n=17, m=25), np.linspace(0.0, 3.0, 49)),
}


def figures(grid: Grid) -> str:
    """Return folded cells, mean deviation and least scaled Jacobian."""
    quality = measure(grid)
    return f"{quality.folded:6} {quality['deviation'].mean:5.2f} {quality['scaled_jacobian'].min:6.3f}"


def cost(grid: Grid) -> float:
    """Return nanoseconds for a node and an iteration."""
    mesh = hex_mesh_of(grid)
    with limited_to(1):
        problem = HexProblem(mesh, ~mesh.outer, wanted_edges(mesh, ~mesh.outer))
    problem.descent.weigh(OPTIMAL.shape, OPTIMAL.smoothness)
    begun = time.process_time()
    done = problem.descent.run(0.0, ITERATIONS, ITERATIONS + 1)[2]
    return 1e9 * (time.process_time() - begun) / (done * len(mesh.nodes))


def first_cells(grid: Grid) -> Floats:
    """Return the lengths of the first steps off a surface."""
    steps = [block.nodes[:, :, 1] - block.nodes[:, :, 0] for block in grid.blocks]
    return np.concatenate([np.linalg.norm(step, axis=-1).ravel() for step in steps])


def marched(case: Case) -> str:
    """Return a line about blocks marched off a surface and smoothed, with 20 iterations."""
    grid = march_surface(surface_of(case.grid), case.march).grid
    begun = time.process_time()
    with limited_to(1):
        smoothed = smooth_volumes(grid, iterations=ITERATIONS).grid
    seconds = time.process_time() - begun
    old, new = first_cells(grid), first_cells(smoothed)
    nodes = sum(block.nodes[..., 0].size for block in grid.blocks)
    became = "  ".join(figures(each) for each in (grid, smoothed))
    change = 100.0 * float(np.abs(new / old - 1.0).max())
    return f"{case.name:24} {became} {nodes:8} {seconds:7.2f}  first cells within {change:.2g} %"


def main() -> None:
    """Print a line for each shape."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=float, default=0.6)
    parser.add_argument("--surfaces", type=Path)
    chosen = parser.parse_args()
    size = chosen.size
    print(f"{'folded, mean, least of':24} {'grid':>19}  {'spoilt':>19}  {'smoothed':>19}  nodes       s  ns")
    for name, make in SHAPES.items():
        grid = make()
        spoilt = perturbed(grid, size)
        begun = time.process_time()
        with limited_to(1):
            smoothed = smooth_volumes(spoilt).grid
        seconds = time.process_time() - begun
        nodes = sum(block.nodes[..., 0].size for block in grid.blocks)
        best = min(cost(perturbed(grid, 0.1)) for _ in range(3))
        became = "  ".join(figures(each) for each in (grid, spoilt, smoothed))
        print(f"{name:24} {became} {nodes:6} {seconds:7.2f} {best:3.0f}")
    for case in cases_of(chosen.surfaces) if chosen.surfaces else ():
        print(marched(case))


if __name__ == "__main__":
    main()
