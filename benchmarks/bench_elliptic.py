"""The elliptic solver: seconds to discretisation level and to 1e-8, cycles, rate, and the guard after it.

    python benchmarks/bench_elliptic.py [--sizes 100,400,800,1600]

One thread, float64, processor seconds, so that neighbours on the machine count little. The reference in the
same run is a copy of the grid into fresh memory: a cycle is told in such copies.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from typing import TypeVar

import numpy as np

from geometry.boundary import Boundary
from geometry.families.family import FAMILIES, family
from geometry.naca import naca
from geometry.quality import count_folded
from geometry.sampling import Sampling
from solvers.elliptic.solve import solve
from solvers.guard import guard

Result = TypeVar("Result")


def shapes(n: int) -> Iterator[tuple[str, Boundary]]:
    """Yield the six families and NACA 0012, n x n nodes each."""
    for name in FAMILIES:
        one = family(name)
        yield name, one.boundary(0.5 * (one.low + one.high), n, n)
    yield "NACA 0012, sharp", naca("0012-sharp").boundary(Sampling(n, n))


def timed(act: Callable[[], Result]) -> tuple[Result, float]:
    """Return the result of `act` and its processor seconds."""
    begun = time.process_time()
    result = act()
    return result, time.process_time() - begun


def row(name: str, edges: Boundary) -> str:
    """Return one line of the table."""
    level, to_level = timed(lambda: solve(edges))
    exact, to_exact = timed(lambda: solve(edges, tol=1e-8, max_cycles=60))
    _, copy = timed(np.ascontiguousarray(np.moveaxis(exact.grid.nodes, -1, 0)).copy)
    (grid, path), guarding = timed(lambda: guard(level.grid, edges))
    folded = count_folded(level.grid.nodes)
    rate = (exact.residual or 0.0) ** (1.0 / max(1, exact.cycles or 1))
    cycle = to_exact / max(1, exact.cycles or 1) / max(copy, 1e-9)
    told = " then ".join(path) or "nothing to do"
    return (
        f"| {name} | {edges.ni} | {to_level:.3f} | {level.cycles} "
        f"| {to_exact:.3f} | {exact.cycles} | {rate:.2f} "
        f"| {cycle:.0f} | {folded} | {told}, {guarding:.2f} s, {count_folded(grid.nodes)} left |"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", default="100,400,800,1600")
    sizes = [int(n) for n in parser.parse_args().sizes.split(",")]
    heads = ("shape", "nodes a side", "default, s", "cycles", "to 1e-8, s", "cycles", "rate")
    print("| " + " | ".join((*heads, "copies a cycle", "folded", "guard")) + " |")
    print("| --- |" + " --- |" * 9)
    for n in sizes:
        for name, edges in shapes(n):
            print(row(name, edges), flush=True)


if __name__ == "__main__":
    main()
