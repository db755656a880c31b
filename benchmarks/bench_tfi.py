"""Transfinite interpolation beside a copy of its result into fresh memory, the same run.

    python benchmarks/bench_tfi.py [--repeats 5]

One thread, float64, a curved quad; seconds are medians. The bar is 2 copies at 3200x3200.
"""

import argparse
import statistics
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from meshonet.geometry.families.family import family
from meshonet.solvers.algebraic.tfi import tfi


def median_seconds(act: Callable[[], object], repeats: int) -> float:
    """Return the median wall-clock seconds of `act`, its result dropped before the next run."""
    spent = []
    for _ in range(repeats):
        begun = time.perf_counter()
        result = act()
        spent.append(time.perf_counter() - begun)
        del result
    return statistics.median(spent)


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    print("| nodes | linear, ms | arc length, ms | copy, ms | linear / copy | arc length / copy |")
    print("| --- | --- | --- | --- | --- | --- |")
    for n in (400, 800, 1600, 3200):
        edges = family("arch").boundary(0.3, n, n)
        result = np.ascontiguousarray(np.moveaxis(tfi(edges).nodes, -1, 0))
        linear = median_seconds(partial(tfi, edges, "linear"), repeats)
        arclength = median_seconds(partial(tfi, edges, "arclength"), repeats)
        copy = median_seconds(result.copy, repeats)
        times = " | ".join(f"{1e3 * t:.1f}" for t in (linear, arclength, copy))
        print(f"| {n}x{n} | {times} | {linear / copy:.2f} | {arclength / copy:.2f} |", flush=True)


if __name__ == "__main__":
    main()
