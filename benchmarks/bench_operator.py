"""The operator beside its rivals without a network: valid grids, distance to Winslow's, angles, time.

    python benchmarks/bench_operator.py [--files FOLDER] [--count 60] [--page docs/benchmarks.md]

Shapes are procedural airfoils of a seed that no model was trained on, and the ``.dat`` files of FOLDER when
one is given. All ways run on the same boundaries in the same run, one thread.
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import argparse
import platform
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from formats.registry import read_shapes
from geometry.arrays import Floats
from geometry.boundary import Boundary
from geometry.errors import MeshonetError
from geometry.families import procedural
from geometry.naca import naca
from geometry.nested import coarser_boundary
from geometry.quality import count_folded, per_cell
from geometry.sampling import Sampling
from solvers.elliptic.solve import solve
from solvers.guard import guard
from solvers.neural.operator import infer
from solvers.solution import Solution
from solvers.tfi import tfi

SEED = 20_000_003
OURS = "**infer (network, polish auto)**"
SOLVER = "multigrid Winslow, default stop"
WAYS: dict[str, Callable[[Boundary], Solution]] = {
    "TFI": lambda b: Solution(tfi(b), "tfi"),
    "harmonic base": lambda b: infer(b, model="base", polish="off"),
    "base + 1 Picard step": lambda b: infer(b, model="base", polish=1),
    "base, polish auto": lambda b: infer(b, model="base"),
    "network alone": lambda b: infer(b, polish="off"),
    "network + 1 Picard step": lambda b: infer(b, polish=1),
    OURS: infer,
    SOLVER: solve,
}


def main() -> None:
    """Measure and print; write the page when asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--files", type=Path, help="folder of airfoil .dat files")
    parser.add_argument("--count", type=int, default=60, help="procedural airfoils")
    parser.add_argument("--many", type=int, default=500, help="procedural airfoils whose folds are counted")
    parser.add_argument("--page", type=Path, help="markdown page to write")
    options = parser.parse_args()
    parts = [HEAD.format(machine=machine())]
    shapes = random_shapes(options.count, 200, 4)
    parts.append(accuracy(f"{options.count} procedural airfoils (every spacing law), 200x200", shapes, 4))
    if options.files:
        for spacing in ("auto", "cosine", "uniform"):
            shapes = files(options.files, spacing, 200, 4)
            parts.append(accuracy(f"Real airfoil files, {spacing} spacing, 200x200", shapes, 4))
        shapes = files(options.files, "auto", 800, 2)
        best_of = {way: WAYS[way] for way in (OURS, SOLVER)}
        parts.append(accuracy("Real airfoil files, auto spacing, 800x800", shapes, 2, best_of))
    parts.append(folds(options.many))
    parts.append(times())
    text = "\n".join(parts)
    print(text)
    if options.page:
        options.page.write_text(text)


def random_shapes(count: int, n: int, finer: int) -> Iterator[Boundary]:
    """Yield held-out procedural boundaries, with `finer` times the cells of n x n nodes."""
    rng = np.random.default_rng(SEED)
    nodes = finer * (n - 1) + 1
    for _ in range(count):
        yield procedural.boundary(rng, nodes, nodes)


def files(folder: Path, spacing: str, n: int, finer: int) -> Iterator[Boundary]:
    """Yield the boundary of every file that holds an airfoil, with `finer` times the cells of n x n nodes."""
    nodes = finer * (n - 1) + 1
    for path in sorted(folder.glob("*.dat")):
        try:
            shape = next(read_shapes(str(path)))
            yield shape.boundary(Sampling(nodes, nodes, "o", spacing=spacing, normalise=True))  # type: ignore[arg-type]
        except MeshonetError as error:
            print(f"refused: {error}")


def converged(fine: Boundary, k: int) -> Floats | None:
    """Return Winslow's solution at every k-th node of `fine`, the error of second order extrapolated away.

    None where the solver fails on one of the two sizes it takes.
    """
    try:
        one = solve(fine, tol=1e-8).grid.nodes
        half = solve(coarser_boundary(fine, 2), tol=1e-8).grid.nodes
    except MeshonetError:
        return None
    return np.asarray((4.0 * one[::k, ::k] - half[:: k // 2, :: k // 2]) / 3.0)


def accuracy(
    title: str,
    boundaries: Iterator[Boundary],
    k: int,
    ways: dict[str, Callable[[Boundary], Solution]] = WAYS,
) -> str:
    """Return a table: folds, distance to the converged solution within 1.5 chords, angles, seconds."""
    rows: dict[str, list[tuple[float, ...]]] = {way: [] for way in ways}
    left_out = 0
    for fine in boundaries:
        edges, goal = coarser_boundary(fine, k), converged(fine, k)
        try:
            same_nodes = solve(edges, tol=1e-8).grid
        except MeshonetError:
            goal = None
        if goal is None:
            left_out += 1
            continue
        middle = 0.5 * (edges.south[0] + edges.south[np.argmax(np.hypot(*(edges.south - edges.south[0]).T))])
        off = goal - middle
        near = np.hypot(off[..., 0], off[..., 1]) < 1.5
        angles = per_cell(same_nodes, "max_angle")
        for way, make in ways.items():
            begun = time.process_time()
            grid = make(edges).grid
            spent = time.process_time() - begun
            miss = grid.nodes - goal
            distance = float(np.sqrt((miss[near] ** 2).sum() / (off[near] ** 2).sum()))
            found = per_cell(grid, "max_angle")
            ratios = (found.max() / angles.max(), found.mean() / angles.mean())
            rows[way].append((count_folded(grid.nodes), distance, *ratios, spent))
    if left_out:
        title += f" ({left_out} left out: no converged solution)"
    lines = [
        f"## {title}\n",
        "| way | fold-free | relative L2, median, worst | max angle, median, worst | mean angle | ms |",
    ]
    lines.append("| --- | --- | --- | --- | --- | --- |")
    for way, found_rows in rows.items():
        folds, distance, largest, mean, spent = np.array(found_rows).T
        lines.append(
            f"| {way} | {100 * (folds == 0).mean():.1f} % "
            f"| {np.median(distance):.1e} / {distance.max():.1e} "
            f"| {np.median(largest):.4f} / {largest.max():.3f} | {np.median(mean):.4f} "
            f"| {1e3 * np.median(spent):.1f} |"
        )
    return "\n".join(lines) + "\n"


def folds(count: int) -> str:
    """Return a table: how many procedural airfoils have no folded cell before and after the guard."""
    lines = [
        f"## Folds before the guard and after it, {count} procedural airfoils, 200x200\n",
        "| spacing | fold-free | after the guard |",
        "| --- | --- | --- |",
    ]
    for spacing in ("conformal", "cosine", "curvature", None):
        rng = np.random.default_rng(SEED + 1)
        before = after = 0
        for _ in range(count):
            edges = procedural.boundary(rng, 200, 200, spacing)  # type: ignore[arg-type]
            grid = infer(edges).grid
            before += not count_folded(grid.nodes)
            after += not count_folded(guard(grid, edges, allow_invalid=True)[0].nodes)
        told = "every law, random steps at the edges" if spacing is None else spacing
        lines.append(f"| {told} | {100 * before / count:.1f} % | {100 * after / count:.1f} % |")
    return "\n".join(lines) + "\n"


def times() -> str:
    """Return a table of grid-stage milliseconds for a sharp and a blunt section."""
    sizes = (100, 200, 400, 800, 1600, 3200)
    lines = [
        "## Grid stage, milliseconds, float64, best of 3\n",
        "| way | " + " | ".join(f"{n}x{n}" for n in sizes) + " |",
    ]
    lines.append("| --- |" + " --- |" * len(sizes))
    for designation, way, make in (
        ("2412-sharp", "infer, sharp edge", infer),
        ("2412", "infer, blunt edge", infer),
        ("2412", "base + 1 Picard step, blunt edge", WAYS["base + 1 Picard step"]),
        ("2412", "multigrid Winslow, default stop", solve),
        ("2412", "TFI", WAYS["TFI"]),
        ("2412", "copy of the result into fresh memory", None),
    ):
        cells = []
        for n in sizes:
            edges = naca(designation).boundary(Sampling(n, n))
            cells.append(f"{1e3 * best(make, edges):.1f}")
        lines.append(f"| {way} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def best(make: Callable[[Boundary], Solution] | None, edges: Boundary, repeats: int = 3) -> float:
    """Return the least seconds of `repeats` runs; of a copy of a grid of that size when `make` is None."""
    nodes: Floats = np.ones((2, edges.ni, edges.nj))
    spent = []
    for _ in range(repeats):
        begun = time.process_time()
        kept = nodes.copy() if make is None else make(edges)
        spent.append(time.process_time() - begun)
        del kept
    return min(spent)


def machine() -> str:
    """Return the processor's name."""
    names = [
        line.split(":", 1)[1].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if line.startswith("model name")
    ]
    return f"{names[0] if names else platform.processor()}, one thread"


HEAD = """# Benchmarks

<!-- made by python benchmarks/bench_operator.py --page docs/benchmarks.md (make bench) -->

O-grids around airfoils, before the guard, on this machine: {machine}.
The reference of every distance is Winslow's solution on the same wall and outer nodes, converged to residual
1e-8 on grids of four and two times the cells (at 800x800: two times and the same) and extrapolated; it is the
relative L2 distance within 1.5 chords. Transfinite interpolation spaces its nodes otherwise across the field,
so its distance says little. Angles are ratios to the multigrid solution at residual 1e-8 on the same nodes.
Times are processor time.
"""

if __name__ == "__main__":
    main()
