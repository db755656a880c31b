"""Makes the grid lines that leave a corner of the wall bisect its angle."""

from itertools import repeat

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.conformal.lift import Lift
from meshonet.geometry.elementary import exp, product, sin
from meshonet.kernels._native import lift_bisect
from meshonet.solvers.conformal.evaluate import StripGrid

CELLS = 4.0  # reach of a shift, in cells either way; with 3 some cells fold
LARGEST = 0.4  # of a cell's width: beyond it the neighbours would suffer
SWEEPS = 3  # over the corners, which influence each other a little


def shifts(grid: StripGrid, lift: Lift, wall: Complexes, corners: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return weights (n, corners) and shifts (corners,) that make grid lines bisect the angles at corners.

    The shifts are along the wall. A node moves by the sum of all shifts, each multiplied by the node's weight
    for that corner. `wall` (n,) are the wall nodes, counter-clockwise; `corners` are indices of nodes.
    """
    n, step = len(wall), 2.0 * np.pi / len(wall)
    between = np.subtract.outer(corners, corners) % n
    apart = np.minimum(between, n - between) + n * np.eye(len(corners))
    width = np.minimum(CELLS, 0.5 * apart.min(axis=0))
    first = grid.at(corners, 1)
    beside = grid.at((np.add.outer(corners, (-1, 1)) % n).ravel().tolist(), 1).reshape(-1, 2)
    cells = np.abs(np.remainder((beside - first[:, None]).imag + np.pi, 2.0 * np.pi) - np.pi).min(axis=1)
    limit = LARGEST * np.maximum(cells, step)  # evenly spaced walls have wide cells at an edge
    offset = np.subtract.outer(np.arange(n), corners)
    reach = exp(-((sin(np.pi * offset / n) / (np.pi * width / n)) ** 2))
    at = np.array(corners)
    pull = reach[at]
    shift = np.zeros(len(corners))
    for _ in range(SWEEPS):
        moved = first + 1j * (product(pull, shift) - shift)  # by the other corner alone
        nodes = wall[at], wall[(at + 1) % n], wall[at - 1]
        shift = np.array(list(map(lift_bisect, repeat(lift), *nodes, moved, shift, limit)))
    return reach, shift


def fading(eta: Floats, first: float) -> Floats:
    """Return factors that fade a shift of nodes: 1 where `eta` equals `first`, 0 at wall and far field."""
    cells = eta / first
    return np.asarray(cells * exp((1.0 - cells) / CELLS) * (1.0 - eta) / (1.0 - first))
