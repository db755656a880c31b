"""Compiled part of the spline: one tridiagonal solve."""


def solve_tridiagonal(const double[::1] lower, const double[::1] diagonal, const double[::1] upper, double[:, ::1] right):
    """Solve a tridiagonal system in place by elimination without pivoting.

    Row i reads ``lower[i] x[i-1] + diagonal[i] x[i] + upper[i] x[i+1] = right[i]``; `lower[0]` and the last
    `upper` are not read. All of length n, `right` (n, k); it holds the solution afterwards. The rows of a
    spline are diagonally dominant, so that no pivot is small.
    """
    cdef Py_ssize_t n = diagonal.shape[0], k = right.shape[1], i, j
    cdef double pivot, factor
    import numpy
    cdef double[::1] ratio = numpy.empty(n)
    if n == 0:
        return
    pivot = diagonal[0]
    for j in range(k):
        right[0, j] = right[0, j] / pivot
    for i in range(1, n):
        ratio[i - 1] = upper[i - 1] / pivot
        pivot = diagonal[i] - lower[i] * ratio[i - 1]
        for j in range(k):
            right[i, j] = (right[i, j] - lower[i] * right[i - 1, j]) / pivot
    for i in range(n - 2, -1, -1):
        for j in range(k):
            right[i, j] = right[i, j] - ratio[i] * right[i + 1, j]
