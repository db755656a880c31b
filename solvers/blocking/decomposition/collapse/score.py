"""Score of a quad mesh, lower is better: its angles after optimisation, and a penalty for each block.

::

    mean deviation of corner angles from 90 degrees
    + 0.05 times the 99th percentile of the largest deviation in each cell
    + 0.1 times the excess of the largest deviation above 60 degrees
    + 0.15 times the excess above 35 degrees of the turning of a wall along one edge
    + 4 for each wall node with a wrong number of quads + `price` for each block
    + `SIZES` times the mean square of the logarithm of cell lengths relative to target lengths
"""

import numpy as np

from meshonet.geometry.arrays import Floats, percentiles_of
from meshonet.geometry.domain.wall_turning import turning_between
from meshonet.geometry.elementary import arctan2, exp, log
from meshonet.geometry.layout.periodic_sides import following
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.decomposition.collapse.base_complex import BaseComplex
from meshonet.solvers.blocking.decomposition.quads.padding import wrong_count

PRICE = 0.12  # price of a block in degrees of mean deviation
SIZES = 8.0  # price in degrees of mean deviation if all cells are too long or short by a factor e


def score(blocks: BaseComplex, price: float = PRICE, wanted: Floats | None = None) -> float:
    """Return the score of blocks, a weighted sum of penalties in degrees; lower is better.

    Penalties are for angles other than 90 degrees, for mesh edges along which a wall turns too much, for a
    wrong number of quads at wall nodes, and for uneven sizes. Each block adds `price`. `wanted` (e,) are
    target lengths of the edges; by default all edges have the same target.
    """
    mesh = blocks.mesh
    off = deviations(mesh)
    worst = off.max(axis=1)
    return float(
        off.mean()
        + 0.05 * percentiles_of(worst, (99,))[0]
        + 0.1 * max(0.0, worst.max() - 60.0)
        + 0.15 * max(0.0, largest_turning(mesh) - 35.0)
        + 4.0 * np.count_nonzero(wrong_count(mesh))
        + price * len(blocks.blocks)
        + SIZES * size_spread(blocks, wanted)
    )


def size_spread(blocks: BaseComplex, wanted: Floats | None) -> float:
    """Return how unequal the widths of each row of blocks are: the variance of log(width) within a row.

    A width is the length of a block side that the row crosses. Edge lengths are divided by targets `wanted`
    (e,), if given. The variance is averaged over all rows, weighted by areas.
    """
    lengths = log(blocks.side_lengths(wanted))
    chord = blocks.sides[2]
    across = exp(lengths).reshape(-1, 2, 2).mean(axis=2)
    area = np.repeat(across[:, 0] * across[:, 1], 4)
    weight = np.bincount(chord, area, blocks.chords)
    mean = np.bincount(chord, area * lengths.ravel(), blocks.chords) / weight
    return float((area * (lengths.ravel() - mean[chord]) ** 2).sum() / area.sum())


def deviations(mesh: QuadMesh) -> Floats:
    """Return |angle - 90| (m, 4) in degrees at each corner of each quad; above 90 for folded corners."""
    x, y = mesh.nodes.T
    sides = np.roll(mesh.quads, -1, axis=1)
    ux, uy = x[sides] - x[mesh.quads], y[sides] - y[mesh.quads]
    vx, vy = -np.roll(ux, 1, axis=1), -np.roll(uy, 1, axis=1)
    angle = np.degrees(arctan2(ux * vy - uy * vx, ux * vx + uy * vy)) % 360.0
    return np.abs(angle - 90.0)


def largest_turning(mesh: QuadMesh) -> float:
    """Return the largest angle in degrees by which a wall turns along one edge of the mesh."""
    after, arcs = following(mesh), mesh.places.arc
    most = 0.0
    for number, loop in enumerate(mesh.domain.loops):
        first = np.flatnonzero((after >= 0) & (mesh.places.loop == number))
        if first.size:
            start = arcs[first]
            length = np.mod(arcs[after[first]] - start, loop.length)
            most = max(most, float(turning_between(loop, start, start + length).max()))
    return most
