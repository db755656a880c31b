"""The place, turn and size of domains, taken out and put back: the arithmetic of ``frame.py`` on planes."""

cdef extern from "frame_kernel.h":
    void frame_take_out(const double *planes, Py_ssize_t m, Py_ssize_t n, double *factor, double *out) nogil
    void frame_put_back(double *planes, const double *moved, const double *unit, Py_ssize_t m, Py_ssize_t n, const double *factor) nogil
    void frame_add_float(double *planes, const float *answers, Py_ssize_t numbers, const double *rim, Py_ssize_t m, Py_ssize_t n) nogil
    void frame_add_double(double *planes, const double *answers, Py_ssize_t numbers, const double *rim, Py_ssize_t m, Py_ssize_t n) nogil

ctypedef fused real:
    float
    double


cdef int same(const double[:, :, :, ::1] one, const double[:, :, :, ::1] other) except -1:
    """Refuse planes of another shape, or that are none."""
    cdef int k
    for k in range(4):
        if one.shape[k] != other.shape[k]:
            raise ValueError("planes of other shapes")
    if one.shape[1] != 2 or one.shape[2] < 2 or one.shape[3] < 2:
        raise ValueError("arrays that are no planes")
    return 0


def take_out(const double[:, :, :, ::1] planes, double[:, :, :, ::1] unit, double[:, ::1] factors):
    """Fill `unit` with the grids `planes` (batch, 2, m, n) at unit size, and `factors` (batch, 2) with what that takes."""
    cdef Py_ssize_t b
    same(planes, unit)
    if factors.shape[0] != planes.shape[0] or factors.shape[1] != 2:
        raise ValueError("factors of another number of grids")
    with nogil:
        for b in range(planes.shape[0]):
            frame_take_out(&planes[b, 0, 0, 0], planes.shape[2], planes.shape[3], &factors[b, 0], &unit[b, 0, 0, 0])


def put_back(double[:, :, :, ::1] planes, const double[:, :, :, ::1] moved, const double[:, :, :, ::1] unit,
             const double[:, ::1] factors):
    """Add to `planes` by what grids have `moved` from where `take_out` left them, at their own sizes."""
    cdef Py_ssize_t b
    same(planes, moved)
    same(planes, unit)
    if factors.shape[0] != planes.shape[0] or factors.shape[1] != 2:
        raise ValueError("factors of another number of grids")
    with nogil:
        for b in range(planes.shape[0]):
            frame_put_back(&planes[b, 0, 0, 0], &moved[b, 0, 0, 0], &unit[b, 0, 0, 0], planes.shape[2], planes.shape[3], &factors[b, 0])


def add(double[:, :, :, ::1] planes, const real[:, :, :, :, ::1] answers, Py_ssize_t head, const double[:, ::1] rim):
    """Add to `planes` (batch, 2, m, n) the answers (batch, m, n, heads, 2) of one head times `rim` (m, n)."""
    cdef Py_ssize_t b, m = planes.shape[2], n = planes.shape[3], numbers = 2 * answers.shape[3]
    same(planes, planes)
    if answers.shape[0] != planes.shape[0] or answers.shape[1] != m or answers.shape[2] != n or answers.shape[4] != 2:
        raise ValueError("answers to other grids")
    if not 0 <= head < answers.shape[3] or rim.shape[0] != m or rim.shape[1] != n:
        raise ValueError("no such head, or a rim of another shape")
    with nogil:
        for b in range(planes.shape[0]):
            if real is float:
                frame_add_float(&planes[b, 0, 0, 0], &answers[b, 0, 0, head, 0], numbers, &rim[0, 0], m, n)
            else:
                frame_add_double(&planes[b, 0, 0, 0], &answers[b, 0, 0, head, 0], numbers, &rim[0, 0], m, n)
