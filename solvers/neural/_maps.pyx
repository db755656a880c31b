"""Binding of maps_kernel.c: strip points to plane points, in place."""

from libc.stdlib cimport free, malloc


cdef extern from "maps_kernel.h":
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

    void lift_to_plane(double *psi_x, double *phi_y, long n, const LiftMaps *maps) noexcept nogil


cdef Cplx _pair(z):
    cdef Cplx c
    c.re = z.real
    c.im = z.imag
    return c


def to_plane(double[:, ::1] psi_x, double[:, ::1] phi_y, lift):
    """Turn psi into x and phi into y (mirrored back: y = -Im z), both (rows, m), in place."""
    if psi_x.shape[0] != phi_y.shape[0] or psi_x.shape[1] != phi_y.shape[1]:
        raise ValueError("psi and phi differ in shape")
    cdef LiftMaps maps
    cdef int n = len(lift.corners), i
    cdef long rows = psi_x.shape[0], m = psi_x.shape[1]
    cdef CornerMap *corners = <CornerMap *>malloc(max(n, 1) * sizeof(CornerMap))
    if corners == NULL:
        raise MemoryError
    if rows and m:
        for i, corner in enumerate(reversed(lift.corners)):
            corners[i].p, corners[i].q = _pair(corner.p), _pair(corner.q)
            corners[i].P, corners[i].Q, corners[i].k = _pair(corner.P), _pair(corner.Q), corner.k
        maps.centre, maps.quarter, maps.pole = _pair(lift.centre), _pair(lift.quarter), _pair(lift.pole)
        maps.phase = lift.phase
        maps.n_corners, maps.corners = n, corners
        with nogil:
            lift_to_plane(&psi_x[0, 0], &phi_y[0, 0], rows * m, &maps)
    free(corners)
