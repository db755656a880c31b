"""Compiled energy and minimiser of a patch; the formulas stand in ``repair_kernel.c``."""

import numpy as np

cdef extern from "repair_kernel.h":
    ctypedef struct Patch:
        Py_ssize_t ni
        Py_ssize_t nj
        int periodic
        double *x
        double *y
        const double *width
        const double *height
        double shape
    size_t repair_workspace(Py_ssize_t ni, Py_ssize_t nj, int periodic) nogil
    double repair_energy(const Patch *patch, double epsilon, double *gx, double *gy, double *smallest,
                         double *work) nogil
    int repair_minimise(const Patch *patch, double epsilon, int most, double still, double until_valid,
                        double *energy, double *smallest, double *work) nogil


cdef Patch patch_of(double[:, ::1] x, double[:, ::1] y, const double[::1] width, const double[::1] height,
                    bint periodic, double shape) except *:
    cdef Patch p
    p.ni, p.nj, p.periodic, p.shape = x.shape[0], x.shape[1], periodic, shape
    if y.shape[0] != p.ni or y.shape[1] != p.nj or width.shape[0] != p.ni - 1 or height.shape[0] != p.nj - 1:
        raise ValueError("the arrays of a patch do not fit each other")
    p.x, p.y, p.width, p.height = &x[0, 0], &y[0, 0], &width[0], &height[0]
    return p


def energy(double[:, ::1] x, double[:, ::1] y, const double[::1] width, const double[::1] height,
           bint periodic, double shape, double epsilon):
    """Return (energy, d/dx, d/dy, smallest corner Jacobian over reference area) of a patch (ni, nj)."""
    cdef Patch p = patch_of(x, y, width, height, periodic, shape)
    cdef double smallest = 0.0, total
    cdef double[:, ::1] gx = np.empty((p.ni, p.nj)), gy = np.empty((p.ni, p.nj))
    cdef double[::1] work = np.empty(repair_workspace(p.ni, p.nj, p.periodic))
    total = repair_energy(&p, epsilon, &gx[0, 0], &gy[0, 0], &smallest, &work[0])
    return total, gx.base, gy.base, smallest


def minimise(double[:, ::1] x, double[:, ::1] y, const double[::1] width, const double[::1] height,
             bint periodic, double shape, double epsilon, int most, double still, double until_valid=0.0):
    """Minimise the energy in place; return (iterations, energy, smallest corner Jacobian over reference area)."""
    cdef Patch p = patch_of(x, y, width, height, periodic, shape)
    cdef double total = 0.0, smallest = 0.0
    cdef int done
    cdef double[::1] work = np.empty(repair_workspace(p.ni, p.nj, p.periodic))
    with nogil:
        done = repair_minimise(&p, epsilon, most, still, until_valid, &total, &smallest, &work[0])
    return done, total, smallest
