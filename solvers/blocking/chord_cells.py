"""Numbers of cells along the chords of a layout for target cell sizes, and initial positions of the nodes."""

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.elementary import exp, log, product
from meshonet.solvers.algebraic.resample.spline import spline_matrix
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.size_metric import SizeMetric

_PARTS = (0.2, 0.5, 0.8)  # of edges, where sizes are evaluated
SAMPLES = 64  # number of intervals of an edge in which sizes are sampled
ROUNDS = 4  # number of times opposite edges are averaged
STEEPEST = 8.0  # largest ratio of the largest to the smallest cell along an edge


class WantedCounts:
    """Computes cell counts of chords (rows of blocks) from target sizes at given points."""

    def __init__(self, chords: Chords, metric: SizeMetric) -> None:
        self.chords = chords
        nodes = chords.layout.mesh.nodes
        start = nodes[np.concatenate([edge[:-1] for edge in chords.edges])]
        step = nodes[np.concatenate([edge[1:] for edge in chords.edges])] - start
        self.length = np.hypot(*step.T)
        self.near = [metric.near(start + part * step, step) for part in _PARTS]
        self.first = np.cumsum([0, *(len(edge) - 1 for edge in chords.edges)])[:-1]

    def counts(self, metric: SizeMetric, multiple: int = 1) -> Indices:
        """Return cell counts (chords,) for each chord (row of blocks), as multiples of `multiple`.

        They are close to the numbers of cells that the target sizes `metric` give for the edges of blocks.
        """
        parts = [self.length / near.length(metric) for near in self.near]
        chords = self.chords
        wanted = np.add.reduceat(np.mean(parts, axis=0), self.first)
        weight = np.bincount(chords.chord, wanted, chords.count)
        mean = np.bincount(chords.chord, wanted * log(np.maximum(wanted, 1e-9)), chords.count) / weight
        return multiple * chords.rounded(exp(mean) / multiple, chords.least)


def metric_places(chords: Chords, counts: Indices, metric: SizeMetric) -> list[Floats]:
    """Return, for each edge of the blocks, the positions (cells + 1,) of its new nodes.

    A position is a fractional index: 2.5 is midway between the old nodes 2 and 3. Opposite edges of blocks
    belong to the same chord and get equal numbers of cells, `counts` (chords,). Cell lengths follow the
    target sizes `metric`. Positions on opposite edges of a block are averaged.
    """
    nodes = chords.layout.mesh.nodes
    cells = counts[chords.chord]
    lines = [product(spline_matrix(len(edge), SAMPLES + 1, False), nodes[edge]) for edge in chords.edges]
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


def _averaged(chords: Chords, shares: list[Floats]) -> list[Floats]:
    """Return shares of edges, averaged with those of the edges on the opposite sides of blocks."""
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
