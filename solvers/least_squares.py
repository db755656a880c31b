"""Gauss-Newton steps for sums of squares of residuals that depend on few unknowns each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.solvers.sparse import SparsePattern


@dataclass(frozen=True)
class Residuals:
    """Residuals of one kind, linearised at the current unknowns.

    Parameters
    ----------
    derivatives : (k, m) derivatives of each residual with respect to its m unknowns.
    weight : (k,) second derivatives of the sum with respect to the residuals.
    slope : (k,) first derivatives of the sum with respect to the residuals.
    """

    derivatives: Floats
    weight: Floats
    slope: Floats


class NormalEquations:
    """The normal equations, with an elimination order that is used in every step.

    Parameters
    ----------
    size : number of unknowns, n.
    kinds : for each kind of residuals the indices (k, m) of the unknowns, -1 for values that are held fixed.

    >>> equations = NormalEquations(1, [np.array([[0], [0]])])
    >>> two = Residuals(np.array([[1.0], [1.0]]), np.ones(2), np.array([-1.0, -3.0]))
    >>> equations.step([two], np.zeros(1), np.zeros(1)).tolist()
    [2.0]
    """

    def __init__(self, size: int, kinds: Sequence[Indices]) -> None:
        self._size, self._kinds = size, kinds
        self._pairs: list[list[tuple[int, int, Bools]]] = []
        diagonal = np.arange(size)
        rows, columns = [diagonal], [diagonal]
        for unknowns in kinds:
            moves = unknowns.T >= 0
            m = len(moves)
            pairs = [(i, j, moves[i] & moves[j]) for i in range(m) for j in range(i, m)]
            rows += [unknowns[both, i] for i, _, both in pairs]
            columns += [unknowns[both, j] for _, j, both in pairs]
            self._pairs.append(pairs)
        self._pattern = SparsePattern(size, np.concatenate(rows), np.concatenate(columns))

    def step(self, residuals: Sequence[Residuals], diagonal: Floats, slope: Floats) -> Floats:
        """Return the changes (n,) of the unknowns.

        `diagonal` (n,) and `slope` (n,) are second and first derivatives of the terms that depend on a single
        unknown. Raises SolverError: the equations are singular.
        """
        values, right = [diagonal], -slope
        for unknowns, pairs, each in zip(self._kinds, self._pairs, residuals, strict=True):
            columns = np.ascontiguousarray(each.derivatives.T)
            weighted = each.weight * columns
            values += [(weighted[i] * columns[j])[both] for i, j, both in pairs]
            for i, column in enumerate(columns):
                moves = unknowns[:, i] >= 0
                right -= np.bincount(unknowns[moves, i], (each.slope * column)[moves], self._size)
        return self._pattern.factor(np.concatenate(values)).solve(right)
