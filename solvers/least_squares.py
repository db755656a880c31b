"""Gauss-Newton steps for sums of squares of residuals that depend on few unknowns each."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.kernels._native import normal_terms
from meshonet.solvers.sparse import SparseMatrix, SparsePattern


@dataclass(frozen=True)
class Residuals:
    """Residuals of one kind, linearised at the current values of the unknowns."""

    derivatives: Floats  # (k, m) derivatives of each residual with respect to its m unknowns
    weight: Floats  # (k,) second derivatives of the total sum with respect to each residual
    slope: Floats  # (k,) first derivatives of the total sum with respect to each residual


class NormalEquations:
    """Normal equations of a least-squares problem; all steps use the same elimination order.

    Parameters
    ----------
    size : number n of unknowns, or of pairs of unknowns.
    kinds : for each kind of residual, an array (k, m): row i has the indices of the m unknowns on which
        residual i depends. An index -1 stands for a quantity that is fixed.
    block : 2 if an index stands for two unknowns, such as x and y; `Residuals.derivatives` are then (k, 2 m).

    The example minimises ((x - 1)² + (x - 3)²) / 2 from x = 0:

    >>> equations = NormalEquations(1, [np.array([[0], [0]])])
    >>> two = Residuals(np.array([[1.0], [1.0]]), np.ones(2), np.array([-1.0, -3.0]))
    >>> equations.step([two], diagonal=np.zeros(1), slope=np.zeros(1)).tolist()
    [2.0]
    """

    def __init__(self, size: int, kinds: Sequence[Indices], block: int = 1) -> None:
        self._shape = size, block
        ends = [unknowns.T[np.array(np.triu_indices(unknowns.shape[1]))] for unknowns in kinds]
        known = [(pairs >= 0).all(axis=0) for pairs in ends]
        rows, columns = (
            np.concatenate([np.arange(size), *(p[end][own] for p, own in zip(ends, known, strict=True))])
            for end in (0, 1)
        )
        self.pattern = SparsePattern(size, rows, columns, block)
        places, self._diagonal = self.pattern.places, self.pattern.slot[:size]
        entries = 2 * self.pattern.slot + (places[rows] < places[columns])
        self._kinds, done = [], size
        for unknowns, own in zip(kinds, known, strict=True):
            entry, count = np.full(own.shape, -1, dtype=np.intp), int(own.sum())
            entry[own] = entries[done : done + count]
            self._kinds.append((unknowns, entry))
            done += count

    def step(self, residuals: Sequence[Residuals], diagonal: Floats, slope: Floats) -> Floats:
        """Return the changes of n unknowns, (n,), or of n pairs of unknowns, (2 n,), in a Gauss-Newton step.

        `slope` and `diagonal` are first and second derivatives of additional terms, each a function of one
        unknown. Raises SolverError if the equations are singular.
        """
        size, block = self._shape
        values, right = np.zeros(self.pattern.entries * block**2), -slope.reshape(size, block)
        for k in range(block):
            values.reshape(-1, block, block)[self._diagonal, k, k] = diagonal[k::block]
        for (unknowns, entry), each in zip(self._kinds, residuals, strict=True):
            derivatives = each.derivatives.reshape(*unknowns.shape, block)
            normal_terms(unknowns, entry, derivatives, each.weight, each.slope, values, right)
        return SparseMatrix(self.pattern, values).factor().solve(right.ravel())
