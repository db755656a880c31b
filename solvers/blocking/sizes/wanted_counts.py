"""Numbers of cells along the chords of a layout for given cell sizes."""

import numpy as np

from meshonet.geometry.arrays import Indices
from meshonet.geometry.elementary import exp, log
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.size_metric import SizeMetric

_PARTS = (0.2, 0.5, 0.8)  # of edges, where sizes are looked at


class WantedCounts:
    """Target numbers of cells of chords, computed for several metrics with equal points but other sizes."""

    def __init__(self, chords: Chords, metric: SizeMetric) -> None:
        self.chords = chords
        nodes = chords.layout.mesh.nodes
        start = nodes[np.concatenate([edge[:-1] for edge in chords.edges])]
        step = nodes[np.concatenate([edge[1:] for edge in chords.edges])] - start
        self.length = np.hypot(*step.T)
        self.near = [metric.near(start + part * step, step) for part in _PARTS]
        self.first = np.cumsum([0, *(len(edge) - 1 for edge in chords.edges)])[:-1]

    def counts(self, metric: SizeMetric, multiple: int = 1) -> Indices:
        """Return the multiples (chords,) of `multiple` that are nearest to the target numbers of cells.

        The target of a chord is the geometric mean of the targets of its edges.
        """
        parts = [self.length / near.length(metric) for near in self.near]
        chords = self.chords
        wanted = np.add.reduceat(np.mean(parts, axis=0), self.first)
        weight = np.bincount(chords.chord, wanted, chords.count)
        mean = np.bincount(chords.chord, wanted * log(np.maximum(wanted, 1e-9)), chords.count) / weight
        return multiple * chords.rounded(exp(mean) / multiple, chords.least)
