"""Sparse symmetric linear systems, factored without pivoting."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.errors import SolverError
from meshonet.kernels._native import sparse_analyse, sparse_factor, sparse_multiply, sparse_solve


class SparsePattern:
    """Positions of the entries of a symmetric matrix, and an elimination order of its unknowns.

    A pattern serves all matrices with the same positions. The order is approximate minimum degree (Amestoy,
    Davis, Duff, SIAM J. Matrix Anal. Appl. 17 (1996) 886-905).

    Parameters
    ----------
    size : number of rows, n.
    rows, columns : (m,) position of each entry, on one side of the diagonal; entries at one position add up.
    block : 1 if entries are numbers, 2 if they are matrices (2, 2).

    Attributes
    ----------
    arrays : the pattern as arrays for compiled code.
    slot : (m,) index of the stored value to which each entry is added.
    entries : number of stored values.

    >>> pattern = SparsePattern(2, np.array([0, 0, 1]), np.array([0, 1, 1]))
    >>> pattern.factor(np.array([2.0, 1.0, 2.0])).solve(np.array([3.0, 3.0])).tolist()
    [1.0, 1.0]
    """

    def __init__(self, size: int, rows: Indices, columns: Indices, block: int = 1) -> None:
        self.size = size * block
        rows, columns = (np.ascontiguousarray(i, dtype=np.intp) for i in (rows, columns))
        self.arrays, self.slot = sparse_analyse(size, rows, columns, block)
        self.entries = int(self.arrays[2][-1])

    @property
    def places(self) -> Indices:
        """Position (n,) of each row of the matrix in the order of elimination."""
        order = self.arrays[0]
        places = np.empty(len(order), dtype=np.intp)
        places[order] = np.arange(len(order))
        return places

    @property
    def fill(self) -> int:
        """Number of nonzero entries below the diagonal of the matrix factor."""
        return int(self.arrays[4][-1])

    def matrix(self, values: Floats) -> "SparseMatrix":
        """Return the matrix with the entries `values` (m,), for a pattern with a `block` of 1."""
        summed = np.bincount(self.slot, np.asarray(values, dtype=np.float64), self.entries)
        return SparseMatrix(self, np.asarray(summed, dtype=np.float64))

    def singular(self, row: int) -> SolverError:
        """Return the error for a matrix whose pivot in row `row` is zero or not finite."""
        return SolverError(f"a system of {self.size} equations is singular in row {row}")

    def factor(self, values: Floats) -> "Factor":
        """Return the factors of the matrix whose entries have `values` (m,); see `SparseMatrix.factor`."""
        return self.matrix(values).factor()


@dataclass(frozen=True, eq=False)
class SparseMatrix:
    """A symmetric matrix A."""

    pattern: SparsePattern
    values: Floats  # values of the distinct entries, in the internal order of the pattern

    def times(self, x: Floats) -> Floats:
        """Return the product of A and a vector or matrix x, (n,) or (n, k)."""
        columns = np.ascontiguousarray(x, dtype=np.float64).reshape(self.pattern.size, -1)
        product = np.empty_like(columns)
        sparse_multiply(self.pattern.arrays, self.values, columns, product)
        return product.reshape(np.shape(x))

    def factor(self) -> "Factor":
        """Return the factors of A = P^T L D L^T P; A must be positive definite or quasi-definite.

        A quasi-definite matrix is ((K, C^T), (C, -E)) with positive definite K and E: Vanderbei, SIAM J.
        Optim. 5 (1995) 100-113. Raises SolverError if a pivot is zero or not finite.
        """
        factor, failed = sparse_factor(self.pattern.arrays, self.values)
        if failed >= 0:
            raise self.pattern.singular(failed)
        return Factor(self.pattern, factor)


@dataclass(frozen=True, eq=False)
class Factor:
    """A matrix A in factored form."""

    pattern: SparsePattern
    arrays: tuple[NDArray[np.intc], Floats, Floats]
    """Row indices and values of L, column by column, without its unit diagonal, and pivots (n,)."""

    def solve(self, right: Floats) -> Floats:
        """Return the solution x of A x = right; both are (n,) or (n, k)."""
        x = np.array(right, dtype=np.float64, order="C").reshape(self.pattern.size, -1)
        sparse_solve(self.pattern.arrays, self.arrays, x)
        return x.reshape(np.shape(right))

    def refine(self, matrix: SparseMatrix, right: Floats, steps: int) -> Floats:
        """Return x of ``matrix x = right``, by `steps` corrections; `matrix` is close to the factored one."""
        x = self.solve(right)
        for _ in range(steps):
            x += self.solve(right - matrix.times(x))
        return x
