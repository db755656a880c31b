"""Gauss-Newton steps for sums of squares of residuals that depend on few unknowns each."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.solvers.sparse import SparsePattern


@dataclass(frozen=True)
class Residuals:
    """Residuals of one kind, linearised at the current unknowns.

    Parameters
    ----------
    derivatives : (..., k, m) derivatives of each residual with respect to its m unknowns.
    weight : (..., k) second derivatives of the sum with respect to the residuals.
    slope : (..., k) first derivatives of the sum with respect to the residuals.
    """

    derivatives: Floats
    weight: Floats
    slope: Floats


class NormalEquations:
    """The normal equations, with an elimination order that is used in every step.

    Parameters
    ----------
    size : number of unknowns, n.
    kinds : for each kind of residuals the indices (..., k, m) of the unknowns, -1 for values that are held
        fixed. Those along the first axes are added one after the other.

    >>> equations = NormalEquations(1, [np.array([[0], [0]])])
    >>> two = Residuals(np.array([[1.0], [1.0]]), np.ones(2), np.array([-1.0, -3.0]))
    >>> equations.step([two], np.zeros(1), np.zeros(1)).tolist()
    [2.0]
    """

    def __init__(self, size: int, kinds: Sequence[Indices]) -> None:
        self._size = size
        self._kinds = [_Kind.of(unknowns, size) for unknowns in kinds]
        diagonal = np.arange(size)
        rows, columns = (
            np.concatenate([diagonal, *(kind.entries[end] for kind in self._kinds)]) for end in (0, 1)
        )
        self.pattern = SparsePattern(size, rows, columns)

    def step(self, residuals: Sequence[Residuals], diagonal: Floats, slope: Floats) -> Floats:
        """Return the changes (n,) of the unknowns.

        `diagonal` (n,) and `slope` (n,) are second and first derivatives of the terms that depend on a single
        unknown. Raises SolverError: the equations are singular.
        """
        values, right = [diagonal], -slope
        for kind, each in zip(self._kinds, residuals, strict=True):
            own, sums = kind.terms(each, self._size)
            values.append(own)
            for part in sums:
                right -= part
        return self.pattern.factor(np.concatenate(values)).solve(right)


@dataclass(frozen=True, eq=False)
class _Kind:
    """Which products of derivatives are added where.

    Parameters
    ----------
    shape : (l, k, m): l times k residuals of m unknowns each.
    pairs : (2, p) pairs of the unknowns of a residual.
    entries : (2, e) rows and columns of the matrix to which products are added.
    products : (e,) which of (l, p, k) these are.
    moving : (f,) which of derivatives (l, m, k) are by unknowns.
    bins : (f,) where these are added, in sums (l m, n).
    """

    shape: tuple[int, int, int]
    pairs: Indices
    entries: Indices
    products: Indices
    moving: Indices
    bins: Indices

    @classmethod
    def of(cls, unknowns: Indices, size: int) -> Self:
        """Return the kind with unknowns (..., k, m) of `size`."""
        k, m = unknowns.shape[-2:]
        own = np.ascontiguousarray(unknowns.reshape(math.prod(unknowns.shape[:-2]), k, m).swapaxes(1, 2))
        pairs = np.array(np.triu_indices(m))
        ends = own[:, pairs]
        products = np.flatnonzero((ends >= 0).all(axis=1))
        moving = np.flatnonzero(own >= 0)
        return cls(
            (len(own), k, m), pairs, ends.swapaxes(0, 1).reshape(2, -1)[:, products], products, moving,
            own.ravel()[moving] + size * (moving // max(k, 1)),
        )  # fmt: skip

    def terms(self, residuals: Residuals, size: int) -> tuple[Floats, Floats]:
        """Return the contributions of some residuals to the entries of the matrix and to the right-hand side.

        The first (e,) are weighted products of derivatives. The second (l m, n) are sums, for each unknown,
        of slopes times derivatives.
        """
        count, k, m = self.shape
        columns = np.ascontiguousarray(residuals.derivatives.reshape(count, k, m).swapaxes(1, 2))
        weighted = residuals.weight.reshape(count, 1, k) * columns
        products = weighted[:, self.pairs[0]] * columns[:, self.pairs[1]]
        sloped = (residuals.slope.reshape(count, 1, k) * columns).ravel()[self.moving]
        sums = np.bincount(self.bins, sloped, count * m * size)
        return products.ravel()[self.products], np.asarray(sums, dtype=np.float64).reshape(-1, size)
