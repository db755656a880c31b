"""Binding of lift_kernel.c: the conformal lift of a body's wall."""

from libc.stdlib cimport free, malloc

import numpy


cdef extern from "lift_kernel.h":
    ctypedef struct Cplx:
        double re
        double im

    ctypedef struct LiftCorner:
        Cplx p, q, P, Q
        double k

    ctypedef struct BodyLift:
        Cplx centre, quarter, pole
        double phase
        int n_corners
        LiftCorner corners[2]

    int lift_wall(const Cplx *wall, Py_ssize_t n, int swap, BodyLift *found, Cplx *w, Py_ssize_t *corners,
                  double *winding, double *scratch) noexcept nogil
    void lift_to_strip(const BodyLift *lift, const Cplx *z, Py_ssize_t n, Cplx *w) noexcept nogil
    void lift_follow(const Cplx *wall, Py_ssize_t n, Cplx centre, Cplx quarter, Cplx *zeta) noexcept nogil
    void lift_beside(const Cplx *wall, Py_ssize_t n, Py_ssize_t tip, Cplx other, Py_ssize_t *ahead,
                     Py_ssize_t *behind) noexcept nogil


cdef Cplx _pair(z):
    cdef Cplx c
    c.re = z.real
    c.im = z.imag
    return c


cdef _number(Cplx c):
    return complex(c.re, c.im)


def lift(const double complex[::1] wall, bint swap):
    """Return centre, quarter, corners (p, q, P, Q, k), pole, phase, strip points, trailing nodes, winding.

    `wall` (n,), n at least 8; the rest as in `meshonet.geometry.conformal.lift.lift_body`.
    """
    cdef Py_ssize_t n = wall.shape[0], corners[2]
    cdef BodyLift found
    cdef double winding
    cdef double complex[::1] w = numpy.empty(n, complex)
    cdef double *scratch
    cdef int count, k
    if n < 8:
        raise ValueError("fewer than 8 nodes")
    scratch = <double *>malloc(3 * n * sizeof(double))
    if scratch == NULL:
        raise MemoryError
    try:
        with nogil:
            count = lift_wall(<const Cplx *>&wall[0], n, swap, &found, <Cplx *>&w[0], corners, &winding, scratch)
    finally:
        free(scratch)
    removed = [
        (_number(found.corners[k].p), _number(found.corners[k].q), _number(found.corners[k].P),
         _number(found.corners[k].Q), found.corners[k].k)
        for k in range(found.n_corners)
    ]
    return (_number(found.centre), _number(found.quarter), removed, _number(found.pole), found.phase,
            numpy.asarray(w), tuple([corners[k] for k in range(count)]), winding)


def to_strip(maps, const double complex[::1] z):
    """Return the strip points of `z` (n,) by a `meshonet.geometry.conformal.lift.Lift` of at most two corners."""
    cdef BodyLift lift
    cdef Py_ssize_t k
    cdef double complex[::1] w = numpy.empty(z.shape[0], complex)
    if len(maps.corners) > 2:
        raise ValueError("more than two corners")
    lift.centre, lift.quarter, lift.pole = _pair(maps.centre), _pair(maps.quarter), _pair(maps.pole)
    lift.phase, lift.n_corners = maps.phase, len(maps.corners)
    for k, corner in enumerate(maps.corners):
        lift.corners[k].p, lift.corners[k].q = _pair(corner.p), _pair(corner.q)
        lift.corners[k].P, lift.corners[k].Q, lift.corners[k].k = _pair(corner.P), _pair(corner.Q), corner.k
    if z.shape[0]:
        lift_to_strip(&lift, <const Cplx *>&z[0], z.shape[0], <Cplx *>&w[0])
    return numpy.asarray(w)


def follow(const double complex[::1] wall, centre, quarter):
    """Return zeta (n,) along a wall (n,)."""
    cdef double complex[::1] zeta = numpy.empty(wall.shape[0], complex)
    if wall.shape[0] < 2:
        raise ValueError("fewer than 2 nodes")
    lift_follow(<const Cplx *>&wall[0], wall.shape[0], _pair(centre), _pair(quarter), <Cplx *>&zeta[0])
    return numpy.asarray(zeta)


def beside(const double complex[::1] wall, Py_ssize_t tip, other):
    """Return the nodes ahead of `tip` and behind it, .004 of the distance to `other` away from it."""
    cdef Py_ssize_t ahead, behind
    if not 0 <= tip < wall.shape[0]:
        raise ValueError("no such node")
    lift_beside(<const Cplx *>&wall[0], wall.shape[0], tip, _pair(other), &ahead, &behind)
    return ahead, behind
