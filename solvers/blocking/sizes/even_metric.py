"""Initial positions of new nodes along the edges of a layout, such that cells have their target sizes.

Along each edge the integral of 1/size is divided into equal parts. The results for opposite edges of blocks
are then averaged repeatedly, so that lines across blocks are initially nearly straight.
"""

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.elementary import product
from meshonet.solvers.algebraic.resample.spline import spline_matrix
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.size_metric import SizeMetric

SAMPLES = 64
"""Number of intervals of an edge in which sizes are sampled."""
ROUNDS = 4
"""Number of times opposite edges are averaged."""
STEEPEST = 8.0
"""Largest ratio of the largest to the smallest cell along an edge."""


def metric_places(chords: Chords, counts: Indices, metric: SizeMetric) -> list[Floats]:
    """Return, for each edge, the positions (cells + 1,) of its new nodes as fractional indices of old nodes.

    `counts` (chords,) are the new numbers of cells.
    """
    nodes = chords.layout.mesh.nodes
    cells = counts[chords.chord]
    lines = [_dense(nodes[edge]) for edge in chords.edges]
    start = np.concatenate([line[:-1] for line in lines])
    step = np.concatenate([line[1:] for line in lines]) - start
    length = np.hypot(*step.T).reshape(len(lines), SAMPLES)
    size = metric.length(start + 0.5 * step, step).reshape(len(lines), SAMPLES)
    size = np.minimum(size, STEEPEST * size.min(axis=1, keepdims=True))
    along = [np.concatenate([[0.0], np.cumsum(row) / row.sum()]) for row in length]
    shares = []
    for row, weight, count in zip(along, length / size, cells.tolist(), strict=True):
        wanted = np.concatenate([[0.0], np.cumsum(weight) / weight.sum()])
        shares.append(np.interp(np.linspace(0.0, 1.0, count + 1), wanted, row))
    shares = _averaged(chords, shares)
    index = [np.linspace(0.0, len(edge) - 1.0, SAMPLES + 1) for edge in chords.edges]
    return [np.interp(share, row, at) for share, row, at in zip(shares, along, index, strict=True)]


def _dense(points: Floats) -> Floats:
    """Return a line (n, 2) at `SAMPLES` equal steps of the number of its nodes."""
    return np.asarray(product(spline_matrix(len(points), SAMPLES + 1, False), points))


def _averaged(chords: Chords, shares: list[Floats]) -> list[Floats]:
    """Return shares of edges, each with half of those of the edges on the other sides of its blocks."""
    pairs = [
        (sides[a], sides[b], bool(turned[a] != turned[b]))
        for sides, turned in zip(chords.sides.tolist(), chords.reversed.tolist(), strict=True)
        for a, b in ((0, 1), (2, 3))
    ]
    pairs += [(k, p, False) for k, p in enumerate(chords.partner.tolist()) if p >= 0]
    for _ in range(ROUNDS):
        total = [np.zeros_like(share) for share in shares]
        count = [0] * len(shares)
        for first, second, turned in pairs:
            for own, opposite in ((first, second), (second, first)):
                share = shares[opposite]
                total[own] += 1.0 - share[::-1] if turned else share
                count[own] += 1
        shares = [
            0.5 * share + 0.5 * mean / max(n, 1) if n else share
            for share, mean, n in zip(shares, total, count, strict=True)
        ]
    return shares
