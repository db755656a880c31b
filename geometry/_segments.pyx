"""Compiled part of the check that a polygon does not cross itself: sort, sweep, compare boxes, then orient."""

cdef inline int _side(double ax, double ay, double bx, double by, double px, double py) noexcept nogil:
    """Return the side of the line from a to b on which p lies: 1 left, -1 right, 0 on it."""
    cdef double left = (bx - ax) * (py - ay), right = (by - ay) * (px - ax)
    return (left > right) - (left < right)


cdef inline bint _within(double ax, double ay, double bx, double by, double px, double py) noexcept nogil:
    """Say whether p lies in the box of a and b."""
    return min(ax, bx) <= px <= max(ax, bx) and min(ay, by) <= py <= max(ay, by)


cdef bint _meet(const double[:, ::1] p, Py_ssize_t i, Py_ssize_t ii, Py_ssize_t j, Py_ssize_t jj) noexcept nogil:
    """Say whether the segments i to ii and j to jj have a point in common."""
    cdef int s1 = _side(p[i, 0], p[i, 1], p[ii, 0], p[ii, 1], p[j, 0], p[j, 1])
    cdef int s2 = _side(p[i, 0], p[i, 1], p[ii, 0], p[ii, 1], p[jj, 0], p[jj, 1])
    cdef int s3 = _side(p[j, 0], p[j, 1], p[jj, 0], p[jj, 1], p[i, 0], p[i, 1])
    cdef int s4 = _side(p[j, 0], p[j, 1], p[jj, 0], p[jj, 1], p[ii, 0], p[ii, 1])
    if s1 * s2 < 0 and s3 * s4 < 0:
        return True
    return (
        (s1 == 0 and _within(p[i, 0], p[i, 1], p[ii, 0], p[ii, 1], p[j, 0], p[j, 1]))
        or (s2 == 0 and _within(p[i, 0], p[i, 1], p[ii, 0], p[ii, 1], p[jj, 0], p[jj, 1]))
        or (s3 == 0 and _within(p[j, 0], p[j, 1], p[jj, 0], p[jj, 1], p[i, 0], p[i, 1]))
        or (s4 == 0 and _within(p[j, 0], p[j, 1], p[jj, 0], p[jj, 1], p[ii, 0], p[ii, 1]))
    )


cdef bint _turns_back(const double[:, ::1] p, Py_ssize_t i, Py_ssize_t ii, Py_ssize_t iii) noexcept nogil:
    """Say whether segment ii to iii lies on segment i to ii, reversed."""
    cdef double ax = p[ii, 0] - p[i, 0], ay = p[ii, 1] - p[i, 1]
    cdef double bx = p[iii, 0] - p[ii, 0], by = p[iii, 1] - p[ii, 1]
    return ax * by == ay * bx and ax * bx + ay * by < 0


def crossing_pairs(
    const double[:, ::1] points, bint closed, const Py_ssize_t[::1] order, const double[::1] low, const double[::1] top,
    Py_ssize_t limit, long long budget
):
    """Return pairs of segments of a polygon that meet though they are not neighbours, and whether all were compared.

    Segment k runs from point k to the next, and from low[k] to top[k] along the direction of the sweep; `order`
    sorts the segments by `low`. At most `limit` pairs are returned, after at most `budget` comparisons.
    """
    cdef Py_ssize_t n = points.shape[0], m = order.shape[0], a, b, i, j, ii, jj
    cdef double left, right, bottom, high
    found = []
    for a in range(m):
        i = order[a]
        ii = (i + 1) % n
        left, right = min(points[i, 0], points[ii, 0]), max(points[i, 0], points[ii, 0])
        bottom, high = min(points[i, 1], points[ii, 1]), max(points[i, 1], points[ii, 1])
        for b in range(a + 1, m):
            j = order[b]
            if low[j] > top[i]:
                break
            jj = (j + 1) % n
            budget -= 1
            if points[j, 1] > high and points[jj, 1] > high:
                continue
            if points[j, 1] < bottom and points[jj, 1] < bottom:
                continue
            if points[j, 0] > right and points[jj, 0] > right:
                continue
            if points[j, 0] < left and points[jj, 0] < left:
                continue
            if ii == j or jj == i:
                if not (_turns_back(points, i, ii, jj) if ii == j else _turns_back(points, j, jj, ii)):
                    continue
            elif not _meet(points, i, ii, j, jj):
                continue
            found.append((min(i, j), max(i, j)))
            if len(found) >= limit:
                return found, True
        if budget < 0:
            return found, False
    return found, True
