"""Descents of the functional in a volume: unfolded where that is needed, then opened, then optimal."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.threads import MANY_VISITS, threads_for
from meshonet.kernels._native import VolumeDescent, volume_jacobians
from meshonet.solvers.volumes.functional import OPENING, UNFOLDING, VolumeWeights, inverse_lengths

RENEWED = 10
"""Iterations after which the preconditioner follows the nodes."""
STILL = 0.3
"""Moves, in cells: two steps on end below it that also gain little end a descent."""
REACH = 0.5
"""The farthest that a node may move in a first step, in cells."""
FLAT = 0.05
"""Smallest Jacobian, 1 in a cell of mean edges, below which cells are opened before all else."""

OPENED = 10
"""Iterations of each stage of opening."""

ROUNDS, ROUND = 14, 10
"""Rounds of unfolding at the most, and iterations of each."""
NARROW = 8  # rounds after which ε is 0.3 of what it would be


class PlanesDescent:
    """Descents from planes of nodes (3, ni, nj, nk), which they change in place, at inner nodes only."""

    def __init__(self, planes: Floats) -> None:
        self.planes, self.iterations = planes, 0
        self._over = inverse_lengths(planes)
        self._run = VolumeDescent(planes.shape[1:], threads_for(planes[0].size, MANY_VISITS))

    def jacobians(self) -> Floats:
        """Return the smallest corner Jacobian of each cell (ni-1, nj-1, nk-1), 1 in one of mean edges."""
        least = np.empty([n - 1 for n in self.planes.shape[1:]])
        volume_jacobians(self.planes, self._over, threads_for(least.size), least)
        return least

    @property
    def smallest(self) -> float:
        """The smallest corner Jacobian."""
        return float(self.jacobians().min())

    def run(self, weights: VolumeWeights, most: int, epsilon: float = 0.0) -> float:
        """Take `most` iterations, fewer where nothing moves any more; return the smallest Jacobian."""
        terms = weights.shape, weights.smoothness, weights.power
        over = (float(np.prod(self._over)) ** (1 / 3),) * 3 if weights.of_cubes else self._over
        limits = STILL, REACH, weights.gain
        _, smallest, done = self._run.run(self.planes, over, terms, epsilon, most, RENEWED, *limits)
        self.iterations += done
        return smallest

    def unfold(self, smallest: float, rounds: int = ROUNDS, iterations: int = ROUND) -> float:
        """Lower the regularised functional while a Jacobian is not positive; return the smallest.

        ε follows the smallest Jacobian: Escobar et al., Comput. Methods Appl. Mech. Engrg. 192 (2003)
        2775-2787.
        """
        for count in range(rounds):
            if smallest > 0.0:
                break
            epsilon = np.sqrt(1e-4 + 0.04 * smallest**2) * (1.0 if count < NARROW else 0.3)
            smallest = self.run(UNFOLDING, iterations, float(epsilon))
        return smallest

    def open(self) -> float:
        """Open flat cells of a valid grid; return the smallest Jacobian."""
        smallest = self.run(UNFOLDING, 2 * OPENED)
        for weights in OPENING:
            smallest = self.run(weights, OPENED)
        return smallest
