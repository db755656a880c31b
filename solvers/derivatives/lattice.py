"""The sparse Jacobian of equations on a structured grid, by finite differences with graph colouring.

Curtis, Powell, Reid, J. Inst. Maths. Applics. 13 (1974) 117-119.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices

STEP = 1e-5  # of central differences, relative to the shortest edge at a node; errors are about its square

Equations = Callable[[Floats], Floats]
"""Function from nodes (2, ni, nj) to residuals of the same shape; only those at inner nodes are used."""


@dataclass(frozen=True, eq=False)
class Jacobian:
    """The nonzero entries of the derivative J of equations at inner nodes by the coordinates of all nodes."""

    rows: Indices  # (m,) row of each entry: flat index of the equation in (2, ni, nj)
    columns: Indices  # (m,) column of each entry: flat index of the coordinate in (2, ni, nj)
    values: Floats  # (m,) value of each entry
    size: int  # number of coordinates, 2 ni nj

    def times(self, x: Floats) -> Floats:
        """Return the product J x for x (size,)."""
        return np.bincount(self.rows, self.values * x[self.columns], self.size).astype(float, copy=False)

    def transposed_times(self, y: Floats) -> Floats:
        """Return the product Jᵀ y for y (size,)."""
        return np.bincount(self.columns, self.values * y[self.rows], self.size).astype(float, copy=False)


def jacobian(equations: Equations, nodes: Floats, reach: int) -> Jacobian:
    """Return the Jacobian of `equations` at `nodes` (2, ni, nj); stencils extend `reach` nodes each way."""
    _, ni, nj = nodes.shape
    step, period = STEP * shortest_edges(nodes), 2 * reach + 1
    number = np.arange(nodes.size).reshape(nodes.shape)
    equation = number[:, 1:-1, 1:-1]
    parts: list[tuple[Indices, Indices, Floats]] = []
    for a in range(period):
        for b in range(period):
            i, j = np.meshgrid(_seen(a, period, ni), _seen(b, period, nj), indexing="ij")
            there = (i >= 0) & (i < ni) & (j >= 0) & (j < nj)
            i, j = i[there], j[there]
            for axis in (0, 1):
                ahead, back = nodes.copy(), nodes.copy()
                ahead[axis, a::period, b::period] += step[a::period, b::period]
                back[axis, a::period, b::period] -= step[a::period, b::period]
                change = (equations(ahead) - equations(back))[:, 1:-1, 1:-1]
                for row in (0, 1):
                    values = change[row][there] / (2.0 * step[i, j])
                    parts.append((equation[row][there], number[axis, i, j], values))
    rows, columns, values = (np.concatenate(each) for each in zip(*parts, strict=True))
    return Jacobian(rows, columns, values, nodes.size)


def _seen(first: int, period: int, n: int) -> Indices:
    """Return which of `first`, `first` + `period` ... is in the stencil of each inner one of n nodes."""
    return first + period * np.round((np.arange(1, n - 1) - first) / period).astype(np.intp)


def shortest_edges(nodes: Floats) -> Floats:
    """Return the length (ni, nj) of the shortest edge at each of `nodes` (2, ni, nj)."""
    shortest = np.full(nodes.shape[1:], np.inf)
    for axis in (0, 1):
        edge = np.hypot(*np.diff(nodes, axis=axis + 1))
        ends = np.moveaxis(shortest, axis, 0)
        edge = np.moveaxis(edge, axis, 0)
        np.minimum(ends[1:], edge, out=ends[1:])
        np.minimum(ends[:-1], edge, out=ends[:-1])
    return shortest
