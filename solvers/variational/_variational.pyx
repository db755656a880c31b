"""Compiled variational functional and its descent; formulas stand in the headers beside."""

import numpy as np

from libc.math cimport sqrt

cdef extern from "variational_kernel.h":
    ctypedef struct Weights:
        double aspect
        double shape
        double smoothness
        double epsilon
        int periodic
        const double *relief
    ctypedef struct Half:
        Py_ssize_t nodes
        Py_ssize_t modes
        const float *q
        const float *q_t
    ctypedef struct Transform:
        Half even
        Half odd
    ctypedef struct Spectrum:
        Py_ssize_t mi
        Py_ssize_t mj
        Transform xi
        Transform eta
        const float *scale
        float rest
    ctypedef struct Band:
        Py_ssize_t mi
        Py_ssize_t mj
        Py_ssize_t width
        float *column
    int SPACE
    ctypedef struct Space:
        Band band
        float *unknowns
        double unit
        const float *along
        const float *across
        const float *across_t
    ctypedef struct Descent:
        Py_ssize_t ni
        Py_ssize_t nj
        Py_ssize_t first
        Weights weights
        Spectrum spectrum
        Space space
        double *z
        double *gradient
        double value
        double smallest
        double reach
        double still
    int GOES_ON
    size_t variational_workspace(Py_ssize_t ni, Py_ssize_t nj) nogil
    double variational_energy(const double *x, const double *y, Py_ssize_t ni, Py_ssize_t nj, const Weights *weights,
                              double *gx, double *gy, double *smallest, double *work) nogil
    size_t band_floats(Band *b, Py_ssize_t mi, Py_ssize_t mj) nogil
    int band_factor(const Band *b, const double *z, const Weights *weights, double *unit) nogil
    int newton_step(const Band *b, double *z, const Weights *weights, double *value, double *g, double *room,
                    float *moves) nogil
    void descent_sizes(const Descent *d, size_t *doubles, size_t *floats) nogil
    void descent_place(Descent *d, double *doubles, float *floats) nogil
    void descent_start(Descent *d) nogil
    int descent_step(Descent *d) nogil

cdef extern from "Python.h":
    int PyErr_CheckSignals() except -1


def workspace(Py_ssize_t ni, Py_ssize_t nj):
    """Return the doubles of workspace that `energy` needs."""
    return variational_workspace(ni, nj)


def energy(const double[:, :, ::1] z, double aspect, double shape, double smoothness, double epsilon, bint periodic,
           const double[::1] relief, double[:, :, ::1] gradient, double[::1] work):
    """Return (value, smallest corner Jacobian) for the planes z (2, ni, nj); fill `gradient` likewise.

    The gradient is zero at fixed nodes: those of the rim, or with `periodic` rows (the last is the first) of the
    first and the last column; the last row's is in the first then. `relief` (ni,) is the share of the angle term
    that corners at nodes (i, 0) keep, or None. `epsilon` regularises; without it a folded
    grid has an infinite value and no gradient.
    """
    cdef Py_ssize_t ni = z.shape[1], nj = z.shape[2]
    cdef Weights weights
    cdef double total, smallest = 0.0
    if z.shape[0] != 2 or gradient.shape[0] != 2 or gradient.shape[1] != ni or gradient.shape[2] != nj:
        raise ValueError("planes of different shapes")
    if <size_t>work.shape[0] < variational_workspace(ni, nj):
        raise ValueError("too little workspace")
    weights.aspect, weights.shape, weights.smoothness = aspect, shape, smoothness
    weights.epsilon, weights.periodic, weights.relief = epsilon, periodic, _relief(relief, ni)
    with nogil:
        total = variational_energy(&z[0, 0, 0], &z[1, 0, 0], ni, nj, &weights, &gradient[0, 0, 0],
                                   &gradient[1, 0, 0], &smallest, &work[0])
    return total, smallest


def newton(double[:, :, ::1] z, double aspect, double shape, double smoothness, int most, double won=0.0):
    """Take steps of Newton's method from the planes z (2, ni, nj) of a valid grid, in place; return how many.

    Of the Hessian as much is taken as makes it positive. There are `most` at the most, fewer where none helps
    or after one that lowers the functional by less than `won` of it.
    """
    cdef Py_ssize_t ni = z.shape[1], nj = z.shape[2], nodes = ni * nj
    cdef Weights weights
    cdef Band band
    cdef double value, before, low = 0.0
    cdef int done = 0
    cdef float[::1] columns, moves
    cdef double[::1] room
    if z.shape[0] != 2 or ni < 3 or nj < 3:
        raise ValueError("planes without inner nodes")
    columns = np.empty(band_floats(&band, ni - 2, nj - 2), np.float32)
    moves = np.empty(2 * band.mi * band.mj + band.width, np.float32)
    room = np.empty(6 * nodes + variational_workspace(ni, nj))
    band.column = &columns[0]
    weights.aspect, weights.shape, weights.smoothness = aspect, shape, smoothness
    weights.epsilon, weights.periodic, weights.relief = 0.0, 0, NULL
    with nogil:
        value = variational_energy(&z[0, 0, 0], &z[1, 0, 0], ni, nj, &weights, &room[0], &room[nodes], &low,
                                   &room[6 * nodes])
        before = value
        while done < most and newton_step(&band, &z[0, 0, 0], &weights, &value, &room[0], &room[2 * nodes], &moves[0]):
            done += 1
            if before - value < won * before:
                break
            before = value
    return done


cdef class Stiffness:
    """The functional's Hessian at the planes z (2, ni, nj) of a grid of few nodes, fixed at its rim.

    Of it as much is taken as makes it positive. `usable` tells whether that can steer a descent on finer grids; the
    planes must not be folded.
    """

    cdef Space space
    cdef object held
    cdef readonly bint usable

    def __init__(self, const double[:, :, ::1] z, double aspect, double shape, double smoothness):
        cdef Py_ssize_t mi = z.shape[1] - 2, mj = z.shape[2] - 2
        cdef float[::1] columns, unknowns
        cdef Weights weights
        self.usable = False
        if mi < 1 or mj < 1 or max(mi, mj) > SPACE:
            return
        columns = np.empty(band_floats(&self.space.band, mi, mj), np.float32)
        unknowns = np.empty(2 * mi * mj + self.space.band.width, np.float32)
        self.space.band.column, self.space.unknowns = &columns[0], &unknowns[0]
        weights.aspect, weights.shape, weights.smoothness = aspect, shape, smoothness
        weights.epsilon, weights.periodic, weights.relief = 0.0, 0, NULL
        self.held = (columns, unknowns)
        with nogil:
            self.usable = band_factor(&self.space.band, &z[0, 0, 0], &weights, &self.space.unit)


cdef class Waves:
    """Even or odd modes of a direction over half of its nodes, (nodes, modes), as products of matrices read them."""

    cdef Half half
    cdef object held

    def __init__(self, matrix):
        cdef float[:, ::1] q = _padded(matrix), q_t = _padded(matrix.T)
        self.half.nodes, self.half.modes = matrix.shape
        self.half.q = &q[0, 0] if q.shape[0] and q.shape[1] else NULL
        self.half.q_t = &q_t[0, 0] if q_t.shape[0] and q_t.shape[1] else NULL
        self.held = (q, q_t)


cdef class Minimiser:
    """Descents of the functional over nodes of one shape, (ni, nj).

    `rows` are the modes along xi, even and odd; `columns` those along eta; `scale` (2, modes of xi, modes of eta) what divides by the symbol of the Hessian for moves along
    xi and along eta, and `rest` what divides the modes that are left out.
    """

    cdef Descent state
    cdef object held

    def __init__(self, Py_ssize_t ni, Py_ssize_t nj, bint periodic, tuple rows, tuple columns, scale, float rest):
        cdef float[:, :, ::1] factors
        cdef size_t doubles = 0, floats = 0
        cdef double[::1] room
        cdef float[::1] small
        cdef Spectrum *s = &self.state.spectrum
        s.xi.even, s.xi.odd = (<Waves?>rows[0]).half, (<Waves?>rows[1]).half
        s.eta.even, s.eta.odd = (<Waves?>columns[0]).half, (<Waves?>columns[1]).half
        s.mi, s.mj = s.xi.even.nodes + s.xi.odd.nodes, s.eta.even.nodes + s.eta.odd.nodes
        if s.mi != (ni - 1 if periodic else ni - 2) or s.mj != nj - 2:
            raise ValueError("transforms of another size")
        if scale.shape != (2, s.xi.even.modes + s.xi.odd.modes, s.eta.even.modes + s.eta.odd.modes):
            raise ValueError("a scale of another size")
        split = s.eta.even.modes
        factors = np.concatenate([_padded(scale[..., :split]), _padded(scale[..., split:])], axis=-1)
        s.scale, s.rest = &factors[0, 0, 0], rest
        self.state.ni, self.state.nj, self.state.first = ni, nj, 0 if periodic else 1
        self.state.weights.periodic = periodic
        descent_sizes(&self.state, &doubles, &floats)
        room, small = np.empty(doubles), np.empty(floats, np.float32)
        descent_place(&self.state, &room[0], &small[0])
        self.held = (rows, columns, factors, room, small)

    def steer(self, Stiffness stiffness, along, across):
        """Let descents follow `stiffness` in smooth moves: `along` (mi, mi coarse) and `across` (mj, mj coarse) take
        those of its inner nodes to all."""
        cdef Space *s = &self.state.space
        cdef float[:, ::1] first, second, turned
        if not stiffness.usable:
            raise ValueError("a Hessian that is not positive")
        if along.shape != (self.state.spectrum.mi, stiffness.space.band.mi):
            raise ValueError("splines of another size")
        if across.shape != (self.state.spectrum.mj, stiffness.space.band.mj):
            raise ValueError("splines of another size")
        first, second = _padded(along, SPACE), _padded(across, SPACE)
        turned = np.ascontiguousarray(np.asarray(second).T)
        s[0] = stiffness.space
        s.along, s.across, s.across_t = &first[0, 0], &second[0, 0], &turned[0, 0]
        self.held = (*self.held, stiffness, first, second, turned)

    def run(self, double[:, :, ::1] z, double aspect, double shape, double smoothness, double epsilon, const double[::1] relief,
            double still, double reach, int most, told=None):
        """Descend from the planes z (2, ni, nj), in place; return (value, smallest Jacobian, iterations).

        It stops when no node moves by more than `still` of its cells in three iterations on end, or after `most`
        of them. No node moves by more than `reach` cells in the first. `told` is called with the iterations done, the
        value and the norm of its gradient, at the start and after each.
        """
        cdef int done = 0, state = GOES_ON
        if z.shape[0] != 2 or z.shape[1] != self.state.ni or z.shape[2] != self.state.nj:
            raise ValueError("planes of another shape")
        self.state.z = &z[0, 0, 0]
        self.state.weights.aspect, self.state.weights.shape = aspect, shape
        self.state.weights.smoothness, self.state.weights.epsilon = smoothness, epsilon
        self.state.weights.relief = _relief(relief, self.state.ni)
        self.state.still, self.state.reach = still, reach
        with nogil:
            descent_start(&self.state)
        if told is not None:
            told(0, self.state.value, self.slope())
        while done < most and state == GOES_ON:
            PyErr_CheckSignals()
            with nogil:
                state = descent_step(&self.state)
            done += 1
            if told is not None:
                told(done, self.state.value, self.slope())
        return self.state.value, self.state.smallest, done


    cdef double slope(self):
        """Return the norm of the gradient."""
        cdef Py_ssize_t k, n = 2 * self.state.spectrum.mi * self.state.spectrum.mj
        cdef double total = 0.0
        for k in range(n):
            total += self.state.gradient[k] * self.state.gradient[k]
        return sqrt(total)


cdef const double *_relief(const double[::1] relief, Py_ssize_t ni) except? NULL:
    if relief is None:
        return NULL
    if relief.shape[0] != ni:
        raise ValueError("a relief of another length")
    return &relief[0]


def _padded(matrix, panel=32):
    """Return `matrix` (..., n) in single precision with zeros up to whole panels of columns."""
    *rows, n = matrix.shape
    result = np.zeros((*rows, (n + panel - 1) // panel * panel), np.float32)
    result[..., :n] = matrix
    return result
