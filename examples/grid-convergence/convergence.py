"""Grid convergence of a potential between a body and its far field, on a family of nested grids.

    python convergence.py GRID GRID GRID...        finest first, each with half the cells of the one before

Solves Laplace's equation with 1 on the wall and 0 on the far field (bilinear elements, 2 x 2 Gauss points) on
every grid and prints the capacitance C = integral of |grad phi|², the order p that three grids in a row show,
Richardson's extrapolation to cells of no size, and the grid convergence index (P. J. Roache, J. Fluids Eng.
116 (1994) 405-413, safety factor 1.25) of each grid. The elements are of second order, so p should be 2.
"""

from __future__ import annotations

import math
import sys

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from meshonet.formats.registry import read_grids
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid

_AT = 0.5 + np.array([-0.5, 0.5]) / math.sqrt(3)


def capacitance(grid: Grid) -> float:
    """Return the integral of |grad phi|² over an O grid, phi 1 on its wall and 0 on its far field."""
    ni, nj = grid.ni - 1, grid.nj  # the last column is the first
    number = np.arange(ni * nj).reshape(ni, nj)
    ring = np.concatenate([number, number[:1]])
    corners = np.stack([ring[:-1, :-1], ring[1:, :-1], ring[1:, 1:], ring[:-1, 1:]], axis=-1).reshape(-1, 4)
    nodes = grid.nodes[:-1].reshape(-1, 2)
    local = stiffness(nodes[corners])
    rows, columns = np.repeat(corners, 4, axis=1), np.tile(corners, (1, 4))
    size = ni * nj
    whole = coo_array((local.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size)).tocsr()
    phi = np.zeros(size)
    phi[number[:, 0]] = 1.0
    inside = number[:, 1:-1].ravel()
    phi[inside] = spsolve(whole[inside][:, inside].tocsc(), -(whole @ phi)[inside])
    return float(phi @ (whole @ phi))


def stiffness(corners: Floats) -> Floats:
    """Return the matrices (cells, 4, 4) of bilinear elements from `corners` (cells, 4, 2), in a ring."""
    total = np.zeros((len(corners), 4, 4))
    for s in _AT:
        for t in _AT:
            along = np.array([[t - 1, 1 - t, t, -t], [s - 1, -s, s, 1 - s]])  # of the shape functions
            jacobian = np.einsum("dk,ckx->cdx", along, corners)
            gradient = np.linalg.solve(jacobian, np.broadcast_to(along, (len(corners), 2, 4)))
            area = 0.25 * np.linalg.det(jacobian)
            total += area[:, None, None] * np.einsum("cxk,cxl->ckl", gradient, gradient)
    return total


def main(paths: list[str]) -> None:
    """Print the table of a family."""
    values = [capacitance(next(iter(read_grids(path)))) for path in paths]
    print("grid, C, order, extrapolated, GCI")
    for k, (path, value) in enumerate(zip(paths, values, strict=True)):
        columns = [path, f"{value:.8f}"]
        if k + 2 < len(values):
            order = math.log2((values[k + 2] - values[k + 1]) / (values[k + 1] - value))
            change = (values[k + 1] - value) / (2**order - 1)
            columns += [f"{order:.3f}", f"{value - change:.8f}", f"{1.25 * abs(change / value):.1e}"]
        print(", ".join(columns))


if __name__ == "__main__":
    main(sys.argv[1:])
