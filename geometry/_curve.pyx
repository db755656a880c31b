"""Compiled parts of a curve: where arc lengths lie on it, and the cubics there.

A curve has n intervals, each a cubic a + t (b + t (c + t d)) of 0 <= t <= 1, and a table of arc length with k
pieces an interval. On a piece, t is the cubic Hermite inverse of arc length with the slopes at its two ends.
"""

from libc.math cimport floor, sqrt


def locate(const double[::1] s, const double[::1] table, const double[::1] start, const double[::1] stop,
           Py_ssize_t pieces, bint closed, Py_ssize_t[::1] interval, double[::1] place):
    """Fill `interval` and `place` (m,), 0 to 1 in it, of arc lengths `s` (m,).

    `table` (n pieces + 1,) begins with 0 and does not fall; `start` and `stop` (n pieces,) are the slopes of t at
    the ends of every piece, in units of the piece. A closed curve takes any s, an open one clips it; only its very
    end has the place 1. Neighbours in `s` are found quickly when they lie near each other on the curve.
    """
    cdef Py_ssize_t m = s.shape[0], last = table.shape[0] - 2, i, k = 0, low, high
    cdef double length = table[last + 1], at, f, a, b
    with nogil:
        for i in range(m):
            at = s[i]
            if closed:
                if not (0.0 <= at < length):
                    at = at - length * floor(at / length)
            at = min(max(at, 0.0), length)
            if not (table[k] <= at < table[k + 1]):
                if k < last and table[k + 1] <= at < table[k + 2]:
                    k += 1
                else:
                    low, high = 0, last + 1
                    while high - low > 1:
                        k = (low + high) // 2
                        if table[k] <= at:
                            low = k
                        else:
                            high = k
                    k = low
            interval[i] = k // pieces
            if at >= length:
                place[i] = 1.0
                continue
            f = (at - table[k]) / (table[k + 1] - table[k])
            a, b = start[k], stop[k]
            place[i] = (k % pieces + f * (a + f * ((3 - 2 * a - b) + f * (a + b - 2)))) / pieces


def values(const double[:, :, ::1] cubic, const Py_ssize_t[::1] interval, const double[::1] place,
           const double[::1] end, double[:, ::1] points):
    """Fill `points` (m, 2) with the cubics (4, n, 2) at the places; at place 1 it is `end` (2,), bit for bit."""
    cdef Py_ssize_t m = interval.shape[0], i, j, k
    cdef double t
    with nogil:
        for i in range(m):
            k, t = interval[i], place[i]
            for j in range(2):
                points[i, j] = end[j] if t == 1.0 else cubic[0, k, j] + t * (
                    cubic[1, k, j] + t * (cubic[2, k, j] + t * cubic[3, k, j]))


def slopes(const double[:, :, ::1] cubic, const Py_ssize_t[::1] interval, const double[::1] place,
           double[:, ::1] derivatives):
    """Fill `derivatives` (m, 2) by t at the places."""
    cdef Py_ssize_t m = interval.shape[0], i, j, k
    cdef double t
    with nogil:
        for i in range(m):
            k, t = interval[i], place[i]
            for j in range(2):
                derivatives[i, j] = cubic[1, k, j] + t * (2.0 * cubic[2, k, j] + 3.0 * t * cubic[3, k, j])


def speeds(const double[:, :, ::1] cubic, const double[::1] places, double[:, ::1] found):
    """Fill `found` (n, m) with the lengths of the derivatives at the same `places` (m,) of every interval."""
    cdef Py_ssize_t n = cubic.shape[1], m = places.shape[0], k, i
    cdef double t, x, y
    with nogil:
        for k in range(n):
            for i in range(m):
                t = places[i]
                x = cubic[1, k, 0] + t * (2.0 * cubic[2, k, 0] + 3.0 * t * cubic[3, k, 0])
                y = cubic[1, k, 1] + t * (2.0 * cubic[2, k, 1] + 3.0 * t * cubic[3, k, 1])
                found[k, i] = sqrt(x * x + y * y)
