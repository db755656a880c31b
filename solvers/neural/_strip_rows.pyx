"""Binding of strip_rows_kernel.c: rows of a grid from the columns of a strip solution."""

from libc.math cimport isfinite
from libc.stdlib cimport free, malloc


cdef extern from "lanes.h":
    int LANES

cdef extern from "strip_rows_kernel.h":
    int PANEL_NODES

    ctypedef struct Cplx:
        double re
        double im

    ctypedef struct CornerMap:
        Cplx p, q, P, Q
        double k

    ctypedef struct LiftMaps:
        Cplx centre, quarter, pole
        double phase
        int n_corners
        const CornerMap *corners

    ctypedef struct WindowSum:
        const double *columns
        Py_ssize_t count, from_ "from", m, width

    ctypedef struct StripRows:
        Py_ssize_t n, m
        double sharpness
        const WindowSum *sums
        Py_ssize_t n_sums
        const double *along
        const double *across
        Py_ssize_t n_nudges
        LiftMaps lift
        const double *matrix
        const Py_ssize_t *cuts
        Py_ssize_t panels, begin
        int symmetric
        Cplx on_axis, turned

    void expand_corner(CornerMap *corner) noexcept nogil
    double strip_rows(const StripRows *s, const Py_ssize_t *order, Py_ssize_t count, double *x, double *y,
                      Py_ssize_t nj, double *scratch) noexcept nogil


cdef extern from "bisector.h":
    ctypedef struct LineOff:
        Cplx corner, ahead, behind, w

    double halve_corner(const LiftMaps *maps, const LineOff *line, double start, double limit) noexcept nogil


cdef Cplx _pair(z):
    cdef Cplx c
    c.re = z.real
    c.im = z.imag
    return c


cdef CornerMap *_maps(lift, LiftMaps *maps) except NULL:
    """Fill in the maps of a `meshonet.geometry.conformal.lift.Lift`, and return the corners, to be freed."""
    cdef Py_ssize_t i
    cdef CornerMap *corners = <CornerMap *>malloc(max(len(lift.corners), 1) * sizeof(CornerMap))
    if corners == NULL:
        raise MemoryError
    for i, corner in enumerate(reversed(lift.corners)):
        corners[i].p, corners[i].q = _pair(corner.p), _pair(corner.q)
        corners[i].P, corners[i].Q, corners[i].k = _pair(corner.P), _pair(corner.Q), corner.k
        expand_corner(&corners[i])
    maps.centre, maps.quarter, maps.pole = _pair(lift.centre), _pair(lift.quarter), _pair(lift.pole)
    maps.phase, maps.n_corners, maps.corners = lift.phase, len(lift.corners), corners
    return corners


def halve(lift, lines, double limit):
    """Return shifts of phi with which lines leave corners of the wall at equal angles.

    Parameters
    ----------
    lift : `meshonet.geometry.conformal.lift.Lift`.
    lines : corner, the node ahead, the node behind, first point in the strip, shift to start from; the shift is
        the start where none is found.
    limit : of the shifts.
    """
    cdef LiftMaps maps
    cdef LineOff one
    cdef CornerMap *corners = _maps(lift, &maps)
    found = []
    try:
        for corner, ahead, behind, w, start in lines:
            one.corner, one.ahead, one.behind, one.w = _pair(corner), _pair(ahead), _pair(behind), _pair(w)
            found.append(halve_corner(&maps, &one, start, limit))
    finally:
        free(corners)
    return found


def fill(double[:, ::1] x, double[:, ::1] y, const Py_ssize_t[::1] order, lift, sums, double sharpness,
         const double[:, ::1] along, const double[:, ::1] across, const double[:, ::1] matrix,
         const Py_ssize_t[::1] cuts, Py_ssize_t begin, axis):
    """Write levels 1 .. nj - 2 of the rows in `order` to `x` and `y` (n + 1, nj); return whether they are finite.

    Parameters
    ----------
    lift : `meshonet.geometry.conformal.lift.Lift`.
    sums : a point, how many follow with it, and their columns (Q, 2, width) by `waves.columns`.
    sharpness : of the window of `waves`.
    along, across : (nudges, n) and (nudges, points), whose products are added to phi.
    matrix, cuts : of the panels, (PANEL_NODES, levels) and the levels where they meet, the first at `begin`.
    axis : a point and the squared direction of the axis about which rows 2k and 2k + 1 of `order` are
        mirror images, or None.
    """
    cdef StripRows s
    cdef Py_ssize_t n = x.shape[0] - 1, nj = x.shape[1], m = across.shape[1], i
    cdef Py_ssize_t panels = cuts.shape[0] - 1, width = matrix.shape[1]
    cdef Py_ssize_t start, count
    cdef const double[:, :, ::1] columns
    cdef WindowSum *windows = NULL
    cdef CornerMap *corners = NULL
    cdef double *scratch = NULL
    cdef double total
    if y.shape[0] != n + 1 or y.shape[1] != nj or along.shape[1] != n or along.shape[0] != across.shape[0]:
        raise ValueError("x, y and nudges do not fit")
    if matrix.shape[0] != PANEL_NODES or cuts[0] != 0 or cuts[panels] != width:
        raise ValueError("panels do not fit their matrix")
    if begin < 1 or m != nj - 2 - width + PANEL_NODES * panels or begin - 1 + PANEL_NODES * panels > m:
        raise ValueError("points do not fit the levels")
    for i in range(panels):
        if cuts[i] > cuts[i + 1]:
            raise ValueError("cuts do not rise")
    for i in range(order.shape[0]):
        if not 0 <= order[i] < n:
            raise ValueError("a row beyond the last")
    if m == 0 or order.shape[0] == 0:
        return True
    try:
        windows = <WindowSum *>malloc(max(len(sums), 1) * sizeof(WindowSum))
        corners = _maps(lift, &s.lift)
        scratch = <double *>malloc(8 * (m + LANES) * sizeof(double))
        if windows == NULL or scratch == NULL:
            raise MemoryError
        s.n_sums = 0
        for start, count, values in sums:
            columns = values
            if start < 0 or count < 0 or start + count > m or columns.shape[0] & (columns.shape[0] - 1):
                raise ValueError("columns do not fit")
            if columns.shape[1] != 2 or count > columns.shape[2] or columns.shape[2] % LANES:
                raise ValueError("columns are not as wide as the points they are for")
            if columns.shape[0] == 0 or count == 0:
                continue
            windows[s.n_sums].columns = &columns[0, 0, 0]
            windows[s.n_sums].count, windows[s.n_sums].width = columns.shape[0], columns.shape[2]
            windows[s.n_sums].m = count
            windows[s.n_sums].from_ = start
            s.n_sums += 1
        s.n, s.m, s.sharpness, s.sums, s.begin, s.panels = n, m, sharpness, windows, begin, panels
        s.along, s.across, s.n_nudges = NULL, NULL, along.shape[0]
        if along.shape[0]:
            s.along, s.across = &along[0, 0], &across[0, 0]
        s.matrix, s.cuts = &matrix[0, 0] if width else NULL, &cuts[0]
        s.symmetric = axis is not None
        s.on_axis, s.turned = _pair(axis[0] if axis else 0j), _pair(axis[1] if axis else 0j)
        with nogil:
            total = strip_rows(&s, &order[0], order.shape[0], &x[0, 0], &y[0, 0], nj, scratch)
        return bool(isfinite(total))
    finally:
        free(windows)
        free(corners)
        free(scratch)
