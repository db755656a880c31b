"""Sparse symmetric systems against SciPy's."""

import numpy as np
import pytest
import scipy.sparse
import scipy.sparse.linalg

from meshonet.geometry.errors import SolverError
from meshonet.solvers.least_squares import NormalEquations, Residuals
from meshonet.solvers.sparse import SparseMatrix, SparsePattern


def laplacian(n: int, m: int) -> scipy.sparse.coo_matrix:
    """Five-point star on n by m nodes, zero around."""
    line = [
        scipy.sparse.diags([-np.ones(k - 1), 2 * np.ones(k), -np.ones(k - 1)], [-1, 0, 1]) for k in (n, m)
    ]
    return scipy.sparse.kronsum(*line).tocoo()


def one_triangle(matrix) -> tuple[SparsePattern, np.ndarray]:
    lower = scipy.sparse.tril(matrix).tocoo()
    return SparsePattern(matrix.shape[0], lower.row, lower.col), lower.data


@pytest.mark.parametrize("sides", [(), (1,), (3,)])
def test_a_laplacian_is_solved(sides):
    matrix = laplacian(23, 31)
    right = np.random.default_rng(0).normal(size=(matrix.shape[0], *sides))
    pattern, values = one_triangle(matrix)
    other = scipy.sparse.linalg.spsolve(matrix.tocsc(), right).reshape(right.shape)
    assert np.allclose(pattern.factor(values).solve(right), other, atol=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_random_positive_definite_matrices_of_any_pattern(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 120))
    half = scipy.sparse.random(n, n, rng.uniform(0, 0.1), random_state=rng)
    matrix = half @ half.T + scipy.sparse.eye(n)
    pattern, values = one_triangle(matrix)
    x = rng.normal(size=n)
    assert np.allclose(pattern.factor(values).solve(matrix @ x), x, atol=1e-8)
    assert np.allclose(pattern.matrix(values).times(x), matrix @ x)


def test_quasi_definite_systems_hold_their_equations():
    """Minimum of x K x / 2 - f x under C x = 0, some equations twice, by a matrix with -1e-8 for 0."""
    rng = np.random.default_rng(1)
    stiff = laplacian(20, 20)
    n, m = stiff.shape[0], 40
    equations = scipy.sparse.random(m, n, 0.02, random_state=rng).tocoo()
    equations = scipy.sparse.vstack([equations, equations.tocsr()[:5]]).tocoo()
    lower = scipy.sparse.tril(stiff).tocoo()
    low = np.arange(n, n + m + 5)
    pattern = SparsePattern(
        n + m + 5,
        np.concatenate([lower.row, n + equations.row, low]),
        np.concatenate([lower.col, equations.col, low]),
    )
    values = [lower.data, equations.data]
    exact = pattern.matrix(np.concatenate([*values, np.zeros(m + 5)]))
    factor = pattern.factor(np.concatenate([*values, np.full(m + 5, -1e-8)]))
    right = np.r_[rng.normal(size=n), np.zeros(m + 5)]
    x = factor.refine(exact, right, 3)[:n]
    assert np.abs(equations @ x).max() < 1e-13
    basis = scipy.linalg.null_space(equations.toarray())
    dense = basis @ np.linalg.solve(basis.T @ stiff @ basis, basis.T @ right[:n])
    assert np.allclose(x, dense, atol=1e-10)


def test_entries_at_one_place_add_up_on_either_side_of_the_diagonal():
    rows, columns = np.array([0, 1, 0, 1, 0]), np.array([0, 0, 1, 1, 0])
    factor = SparsePattern(2, rows, columns).factor(np.array([1.0, 0.5, 0.5, 3.0, 1.0]))
    assert np.allclose(factor.solve(np.array([1.0, 2.0])), np.linalg.solve([[2, 1], [1, 3]], [1, 2]))


@pytest.mark.parametrize("sides", [(), (1,), (2,), (5,)])
def test_blocks_of_two_unknowns_are_eliminated_together(sides):
    """Blocks of any order and both triangles: the same matrix, spread out, is solved by NumPy."""
    rng = np.random.default_rng(3)
    n, m = 60, 150
    rows, columns = np.concatenate([np.tile(np.arange(n), (2, 1)), rng.integers(0, n, (2, m))], axis=1)
    pattern = SparsePattern(n, rows, columns, block=2)
    values = np.zeros((pattern.entries, 2, 2))
    dense = np.zeros((n, 2, n, 2))
    blocks = rng.normal(size=(n + m, 2, 2))
    for row, column, slot, block in zip(rows, columns, pattern.slot, blocks, strict=True):
        block = block + block.T + 40.0 * np.eye(2) if row == column else block
        late, early = (row, column) if pattern.places[row] >= pattern.places[column] else (column, row)
        values[slot] += block
        dense[late, :, early, :] += block
        if row != column:
            dense[early, :, late, :] += block.T
    matrix = SparseMatrix(pattern, values.ravel())
    x = rng.normal(size=(2 * n, *sides))
    right = np.tensordot(dense.reshape(2 * n, 2 * n), x, axes=1)
    assert np.allclose(matrix.times(x), right)
    assert np.allclose(matrix.factor().solve(right), x, atol=1e-12)


@pytest.mark.parametrize("block", [1, 2])
def test_a_step_of_gauss_newton_solves_the_normal_equations(block):
    """Against NumPy's dense product of derivatives; some unknowns are held, some residuals have one twice."""
    rng = np.random.default_rng(block)
    n, k, m = 20, 90, 3
    unknowns = rng.integers(-1, n, (k, m))
    derivatives, weight, slope = rng.normal(size=(k, m * block)), rng.uniform(0.5, 1.5, k), rng.normal(size=k)
    twice = unknowns[:, 1] == unknowns[:, 0]
    derivatives.reshape(k, m, block)[twice, 1] = 0.0
    twice = (unknowns[:, 2] == unknowns[:, 0]) | (unknowns[:, 2] == unknowns[:, 1])
    derivatives.reshape(k, m, block)[twice, 2] = 0.0
    diagonal, pull = rng.uniform(0.5, 1.0, n * block), rng.normal(size=n * block)
    jacobian = np.zeros((k, n + 1, block))
    for j in range(m):
        jacobian[np.arange(k), unknowns[:, j]] += derivatives.reshape(k, m, block)[:, j]
    jacobian = jacobian[:, :n].reshape(k, n * block)
    step = NormalEquations(n, [unknowns], block).step([Residuals(derivatives, weight, slope)], diagonal, pull)
    matrix = jacobian.T @ (weight[:, None] * jacobian) + np.diag(diagonal)
    assert np.allclose(step, np.linalg.solve(matrix, -pull - jacobian.T @ slope), atol=1e-12)


def test_the_order_keeps_factors_about_as_sparse_as_superlu_does():
    matrix = laplacian(60, 60).tocsc()
    pattern, _ = one_triangle(matrix)
    superlu = scipy.sparse.linalg.splu(
        matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    assert pattern.fill < 1.1 * superlu.L.nnz


def test_an_order_is_a_permutation_whatever_the_graph():
    star = SparsePattern(50, np.zeros(50, int), np.arange(50))
    assert star.fill == 49
    alone = SparsePattern(7, np.arange(7), np.arange(7))
    assert alone.factor(np.arange(1.0, 8.0)).solve(np.ones(7)).tolist() == [1 / k for k in range(1, 8)]
    assert SparsePattern(0, np.zeros(0, int), np.zeros(0, int)).fill == 0


def test_singular_matrices_are_named():
    with pytest.raises(SolverError, match="singular in row"):
        SparsePattern(2, np.array([0, 1, 1]), np.array([0, 0, 1])).factor(np.ones(3))
    with pytest.raises(ValueError, match="outside"):
        SparsePattern(2, np.array([0]), np.array([2]))
