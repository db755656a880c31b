"""The wall of a duct with a given throat that leaves the least skewed cells.

    python examples/shape-optimisation/throat.py [-o throat.vts]

The duct is 3 long and 1 high; its top comes down to 0.6 half way. Six waves shape the wall between. For each
shape the variational grid is made; what the nodes' places do to the skewness of the cells is taken back to
the boundary through the optimum, by one solve (`meshonet.optimum_derivative`), and on to the six numbers,
which Adam moves.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

import meshonet
from meshonet.geometry.arrays import Floats

LENGTH, HEIGHT, THROAT = 3.0, 1.0, 0.6
NODES = 61, 21
WAVES = 6
RATE = 0.02


def waves() -> Floats:
    """Return the waves (WAVES, ni) that shape the top."""
    t = np.linspace(0.0, 1.0, NODES[0])
    return np.stack([np.sin((2 * k + 1) * np.pi * t) * (-1.0) ** k for k in range(WAVES)])


def top(shape: Floats) -> tuple[Floats, Floats]:
    """Return heights (ni,) of the top of `shape` (WAVES,), and their derivatives (WAVES, ni)."""
    each = waves()
    bump, half = shape @ each, NODES[0] // 2
    part = bump / bump[half]
    slopes = (each - part * each[:, half, None]) / bump[half]
    return HEIGHT - (HEIGHT - THROAT) * part, -(HEIGHT - THROAT) * slopes


def boundary(heights: Floats) -> meshonet.Boundary:
    """Return the four sides of the duct with a top of these heights (ni,)."""
    t, s = (np.linspace(0.0, 1.0, n) for n in NODES)
    south, north = np.stack([LENGTH * t, 0.0 * t], axis=1), np.stack([LENGTH * t, heights], axis=1)
    west = np.stack([0.0 * s, HEIGHT * s], axis=1)
    return meshonet.Boundary(south, north, west, west + np.array([LENGTH, 0.0]))


def skewness(nodes: Floats) -> tuple[float, Floats]:
    """Return the mean of cos² of the angles at the corners of cells, and its derivative by `nodes`."""
    slope, total = np.zeros_like(nodes), 0.0
    u, v = np.diff(nodes, axis=0), np.diff(nodes, axis=1)
    weight = 1.0 / (4 * u[:, :-1, 0].size)
    for j in (0, 1):
        for i in (0, 1):
            p, q = u[:, j : u.shape[1] - 1 + j], v[i : v.shape[0] - 1 + i]
            r, pp, qq = ((a * b).sum(axis=-1, keepdims=True) for a, b in ((p, q), (p, p), (q, q)))
            total += weight * float((r**2 / (pp * qq)).sum())
            by_p = weight * 2.0 * r / (pp * qq) * (q - r / pp * p)
            by_q = weight * 2.0 * r / (pp * qq) * (p - r / qq * q)
            rows, columns = slice(i, i + by_q.shape[0]), slice(j, j + by_p.shape[1])
            slope[1:, columns] += by_p
            slope[:-1, columns] -= by_p
            slope[rows, 1:] += by_q
            slope[rows, :-1] -= by_q
    return total, slope


def optimise(steps: int) -> tuple[list[float], meshonet.Grid]:
    """Return the skewness before each step and after the last, and the last grid."""
    shape, mean, square = np.zeros(WAVES), np.zeros(WAVES), np.zeros(WAVES)
    shape[0] = 1.0
    skews = []
    for number in range(steps + 1):
        heights, slopes = top(shape)
        made = meshonet.solve_pde(boundary(heights), method="variational")
        derivative = meshonet.optimum_derivative(made)
        skew, by_nodes = skewness(derivative.grid.nodes)
        skews.append(skew)
        if number == steps:
            break
        by_shape = slopes @ derivative.transposed(by_nodes)[:, -1, 1]
        mean = 0.9 * mean + 0.1 * by_shape
        square = 0.999 * square + 0.001 * by_shape**2
        size = np.sqrt(square / (1.0 - 0.999 ** (number + 1))) + 1e-8
        shape = shape - RATE * mean / (1.0 - 0.9 ** (number + 1)) / size
    return skews, derivative.grid


def main() -> None:
    """Optimise and tell; write the last grid when asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, help="grid file to write")
    parser.add_argument("--steps", type=int, default=60)
    options = parser.parse_args()
    skews, grid = optimise(options.steps)
    print(
        f"mean of cos² at the corners: {skews[0]:.5f} at first, {skews[-1]:.5f} after {options.steps} steps"
    )
    if options.output:
        grid.write(options.output)


if __name__ == "__main__":
    main()
