"""Linear algebra of small matrices, bitwise the same on every processor.

Sums, products, quotients and roots are in a fixed order, unlike those of LAPACK and BLAS.
"""

import math
from itertools import combinations
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import product
from meshonet.kernels._native import solve_systems

_SWEEPS = 60  # largest number of sweeps of Jacobi rotations; they converge quadratically, in 4 to 10 sweeps
_SMALL = 2**-58  # relative size of off-diagonal entries at which sweeps end: they no longer change any digit
_RIGHT_ANGLE = 2**-50  # largest cosine of the angle between columns that count as orthogonal


def solve(matrix: Any, right: Any) -> Floats:
    """Return the solutions x of ``matrix @ x = right`` by Gaussian elimination with partial pivoting.

    The matrices are (..., m, m). `right` is (..., m), a vector per matrix, or (..., m, n), with the same
    leading axes. The result has the shape of `right`. Raises ValueError: a matrix is singular.
    """
    left = np.array(matrix, np.float64, order="C")
    values = np.asarray(right, np.float64)
    size, stack = left.shape[-1], left.shape[:-2]
    left = left.reshape(math.prod(stack), size, size)
    out = values.reshape(len(left), size, math.prod(values.shape[len(stack) + 1 :])).copy()
    if not solve_systems(left, out):
        raise ValueError("the matrix is singular")
    return out.reshape(values.shape)


def inverse(matrix: Any) -> Floats:
    """Return the inverse of each matrix (..., m, m). Raises ValueError: a matrix is singular."""
    square = np.asarray(matrix, np.float64)
    return solve(square, np.broadcast_to(np.eye(square.shape[-1]), square.shape))


def symmetric_eigen(matrix: Any) -> tuple[Floats, Floats]:
    """Return the ascending eigenvalues (..., m) of matrices (..., m, m), and unit eigenvectors as columns.

    By cyclic Jacobi rotations (Golub & Van Loan, Matrix Computations, 2013, section 8.5).
    """
    a = np.array(matrix, np.float64)
    size = a.shape[-1]
    vectors = np.broadcast_to(np.eye(size), a.shape).copy()
    least = _SMALL * np.abs(a).max(axis=(-2, -1), initial=0.0)
    for _ in range(_SWEEPS):
        turned = False
        for p, q in combinations(range(size), 2):
            off = a[..., p, q]
            on = np.abs(off) > least
            if not on.any():
                continue
            turned = True
            cosine, sine = _rotation(a[..., p, p], a[..., q, q], np.where(on, off, 0.0))
            _turn_columns(a, p, q, cosine, sine)
            _turn_columns(a.swapaxes(-2, -1), p, q, cosine, sine)
            a[..., p, q] = a[..., q, p] = np.where(on, 0.0, off)
            _turn_columns(vectors, p, q, cosine, sine)
        if not turned:
            break
    values = np.diagonal(a, axis1=-2, axis2=-1)
    order = np.argsort(values, axis=-1, kind="stable")
    return np.take_along_axis(values, order, -1), np.take_along_axis(vectors, order[..., None, :], -1)


def singular_values(matrix: Any) -> tuple[Floats, Floats, Floats]:
    """Return u (n, m), descending s (m,) and v (m, m) such that ``matrix`` (n, m) is ``u @ diag(s) @ v``.

    Where s is 0, the column of u is 0. By one-sided Jacobi rotations (Hestenes, J. SIAM 6, 1958).
    """
    columns = np.array(matrix, np.float64)
    size = columns.shape[1]
    ways = np.eye(size)
    for _ in range(_SWEEPS):
        turned = False
        for p, q in combinations(range(size), 2):
            pair = columns[:, [p, q]]
            (first, off), (_, second) = product(pair.T, pair)
            if not abs(off) > _RIGHT_ANGLE * math.sqrt(first) * math.sqrt(second):
                continue
            turned = True
            cosine, sine = _rotation(first, second, off)
            _turn_columns(columns, p, q, cosine, sine)
            _turn_columns(ways, p, q, cosine, sine)
        if not turned:
            break
    sizes = np.sqrt((columns**2).sum(axis=0))
    order = np.argsort(-sizes, kind="stable")
    s = sizes[order]
    return columns[:, order] / np.where(s > 0.0, s, 1.0), s, ways[:, order].T


def least_squares(matrix: Any, right: Any) -> Floats:
    """Return the least-squares solution, (m,) or (m, k), of ``matrix @ x = right`` with the smallest norm."""
    u, s, v = singular_values(matrix)
    seen = s > np.finfo(float).eps * len(u) * s[:1]
    share = np.where(seen, 1.0 / np.where(seen, s, 1.0), 0.0)
    return np.asarray(product(v.T * share, product(u.T, right)))


def nearest_rotation(maps: Any) -> Floats:
    """Return the rotation nearest, in the Frobenius norm, to each matrix (..., d, d), where d is 2 or 3.

    Determinants may be zero or negative. In three dimensions, unit quaternions are used (Horn, J. Opt.
    Soc. Am. A 4, 1987).
    """
    m = np.asarray(maps, np.float64)
    if m.shape[-1] == 2:
        cosine, sine = m[..., 0, 0] + m[..., 1, 1], m[..., 1, 0] - m[..., 0, 1]
        size = np.hypot(cosine, sine)
        cosine, size = np.where(size == 0.0, 1.0, [cosine, size])
        return _matrices([[cosine / size, -sine / size], [sine / size, cosine / size]])
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = np.moveaxis(m, (-2, -1), (0, 1))
    rows = [
        [xx + yy + zz, zy - yz, xz - zx, yx - xy],
        [zy - yz, xx - yy - zz, yx + xy, zx + xz],
        [xz - zx, yx + xy, yy - xx - zz, zy + yz],
        [yx - xy, zx + xz, zy + yz, zz - xx - yy],
    ]
    w, x, y, z = np.moveaxis(symmetric_eigen(_matrices(rows))[1][..., -1], -1, 0)
    size = w * w + x * x + y * y + z * z
    a, b, c = 2.0 * x / size, 2.0 * y / size, 2.0 * z / size
    return _matrices(
        [
            [1.0 - b * y - c * z, a * y - c * w, a * z + b * w],
            [a * y + c * w, 1.0 - a * x - c * z, b * z - a * w],
            [a * z - b * w, b * z + a * w, 1.0 - a * x - b * y],
        ]
    )


def _rotation(first: Any, second: Any, off: Any) -> tuple[Any, Any]:
    """Return cosine and sine of the rotations that diagonalise [[first, off], [off, second]]."""
    half = 0.5 * (second - first)
    to = np.abs(half) + np.hypot(half, off)
    tangent = np.where(half < 0.0, -off, off) / np.where(to > 0.0, to, 1.0)
    cosine = 1.0 / np.sqrt(1.0 + tangent * tangent)
    return cosine, tangent * cosine


def _turn_columns(a: Floats, p: int, q: int, cosine: Any, sine: Any) -> None:
    """Rotate columns `p` and `q` of each matrix (..., n, m), in place."""
    c, s = np.asarray(cosine)[..., None], np.asarray(sine)[..., None]
    one, two = a[..., p], a[..., q]
    a[..., p], a[..., q] = c * one - s * two, s * one + c * two


def _matrices(rows: list[list[Any]]) -> Floats:
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
