"""Sums of squares of residuals in few unknowns each, minimised by steps of Gauss-Newton."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.sparse import SparsePattern


@dataclass(frozen=True)
class Residuals:
    """Residuals of one kind, near where the unknowns are.

    Parameters
    ----------
    derivatives : (k, m) by the unknowns of each.
    weight : (k,) second derivatives of the sum by the residuals.
    slope : (k,) first ones.
    """

    derivatives: Floats
    weight: Floats
    slope: Floats


class NormalEquations:
    """The equations of a step, factored in an order that serves every step.

    Parameters
    ----------
    size : the unknowns, n.
    kinds : for each kind of residuals the numbers (k, m) of the unknowns of each, -1 for what stays.

    >>> equations = NormalEquations(1, [np.array([[0], [0]])])
    >>> two = Residuals(np.array([[1.0], [1.0]]), np.ones(2), np.array([-1.0, -3.0]))
    >>> equations.step([two], np.zeros(1), np.zeros(1)).tolist()
    [2.0]
    """

    def __init__(self, size: int, kinds: Sequence[Indices]) -> None:
        self._size, self._kinds = size, kinds
        self._pairs: list[list[tuple[int, int, NDArray[np.bool_]]]] = []
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
        """Return the moves (n,) of the unknowns.

        `diagonal` (n,) and `slope` (n,) are second and first derivatives of what depends on one unknown.
        Raises SolverError: the equations are singular.
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
