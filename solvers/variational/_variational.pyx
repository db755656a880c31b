"""Compiled value and gradient of the variational functional; the formula stands in ``variational_kernel.c``."""

import numpy as np

cdef extern from "variational_kernel.h":
    ctypedef struct Weights:
        double aspect
        double shape
        double smoothness
    size_t variational_workspace(Py_ssize_t ni, Py_ssize_t nj) nogil
    double variational_energy(const double *x, const double *y, Py_ssize_t ni, Py_ssize_t nj, const Weights *weights,
                              double epsilon, double *gx, double *gy, double *smallest, double *work) nogil


def workspace(Py_ssize_t ni, Py_ssize_t nj):
    """Return the doubles of workspace that `energy` needs."""
    return variational_workspace(ni, nj)


def energy(const double[:, :, ::1] z, double aspect, double shape, double smoothness, double epsilon,
           double[:, :, ::1] gradient, double[::1] work):
    """Return (value, smallest corner Jacobian) for the planes z (2, ni, nj); fill `gradient` likewise.

    The gradient is zero at the fixed nodes of the rim. `epsilon` regularises; without it a folded grid has an
    infinite value and no gradient.
    """
    cdef Py_ssize_t ni = z.shape[1], nj = z.shape[2]
    cdef Weights weights
    cdef double total, smallest = 0.0
    if z.shape[0] != 2 or gradient.shape[0] != 2 or gradient.shape[1] != ni or gradient.shape[2] != nj:
        raise ValueError("planes of different shapes")
    if <size_t>work.shape[0] < variational_workspace(ni, nj):
        raise ValueError("too little workspace")
    weights.aspect, weights.shape, weights.smoothness = aspect, shape, smoothness
    with nogil:
        total = variational_energy(&z[0, 0, 0], &z[1, 0, 0], ni, nj, &weights, epsilon, &gradient[0, 0, 0],
                                   &gradient[1, 0, 0], &smallest, &work[0])
    return total, smallest
