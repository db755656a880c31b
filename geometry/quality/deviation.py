"""How far the angles at the corners of cells are from 90 degrees."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, percentiles_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.layout.lattice import ring_of
from meshonet.geometry.polygon.corners import angle_between
from meshonet.geometry.summary import Quality


@dataclass(frozen=True)
class Deviation:
    """Degrees: the mean over all corners, and the 99th percentile over the worst corner of each cell.

    `max` is that of cell `at`, (block, i, j) or (block, i, j, k). A corner of a volume has three angles, of
    which the worst counts. `p99` is None where percentiles were not computed.
    """

    mean: float
    p99: float | None
    max: float
    at: tuple[int, ...]


def deviation(grid: Grid) -> Deviation:
    """Return the deviation of the corners of all blocks of two directions; in the plane it is up to 270."""
    every = [corner_deviations(block.nodes) for block in grid.blocks]
    worst = [corners.max(axis=0) for corners in every]
    block = int(np.argmax([cells.max() for cells in worst]))
    i, j = divmod(int(worst[block].argmax()), worst[block].shape[1])
    corners = sum(values.size for values in every)
    return Deviation(
        mean=float(sum(values.sum() for values in every)) / corners,
        p99=percentiles_of(np.concatenate([cells.ravel() for cells in worst]), (99,))[0],
        max=float(worst[block].max()),
        at=(block, i, j),
    )


def solid_deviation(quality: Quality) -> Deviation:
    """Return the deviation of the corners of volumes out of their metrics."""
    worst = quality["skewness"]  # of 90 degrees
    p99 = None if worst.p99 is None else 90.0 * worst.p99
    return Deviation(quality["deviation"].mean, p99, 90.0 * worst.max, worst.worst)


def corner_deviations(nodes: Floats) -> Floats:
    """Return the deviations (4, ni-1, nj-1) of the corners of the cells of `nodes` (ni, nj, 2 or 3)."""
    ring = ring_of(nodes)
    ahead = np.roll(ring, -1, axis=0) - ring
    angle = angle_between(ahead, -np.roll(ahead, 1, axis=0))
    return np.asarray(np.abs(np.degrees(angle) % 360.0 - 90.0))
