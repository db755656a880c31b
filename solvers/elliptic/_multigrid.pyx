"""One multigrid level and its compiled kernels; the equations stand in ``multigrid_kernel.c``."""

import numpy as np

cdef extern from "multigrid_kernel.h":
    ctypedef struct Differences:
        const double *forward
        const double *backward
        const double *centred
    ctypedef struct Transfer:
        const double *right
        const double *before
        const double *at
        const double *after
    ctypedef struct Control:
        Py_ssize_t terms
        const double *along
        const double *across
        const double *reach
    ctypedef struct CLevel "Level":
        Py_ssize_t mi
        Py_ssize_t mj
        int periodic
        double *x
        double *y
        double *fx
        double *fy
        double *x0
        double *y0
        Differences xi
        Differences eta
        Transfer xi_coarse
        Transfer eta_coarse
        Control phi
        Control psi
        double *scratch
    size_t multigrid_scratch(Py_ssize_t mi, Py_ssize_t mj) nogil
    void multigrid_smooth(const CLevel *level, int forced) nogil
    double multigrid_residual(const CLevel *level, int forced) nogil
    double multigrid_restrict(const CLevel *fine, const CLevel *coarse, int forced) nogil
    double multigrid_correct(const CLevel *fine, const CLevel *coarse) nogil


def scratch_size(Py_ssize_t mi, Py_ssize_t mj):
    """Return the doubles of scratch that the kernels need on a level of mi x mj cells."""
    return multigrid_scratch(mi, mj)


cdef class Level:
    """Pointers into the arrays of one level; the arrays are kept alive here.

    Parameters
    ----------
    x, y : (mi + 1, mj + 1) nodes, changed in place.
    xi, eta : weights (forward, backward, centred) of the differences, (mi + 1) and (mj + 1) each.
    periodic : in xi.
    scratch : `scratch_size` doubles, shared between levels.
    coarse : this level is below the finest: it needs a right side and a copy of what came down.
    """

    cdef CLevel level
    cdef list kept, controls
    cdef readonly object x, y, x0, y0, fx, fy

    def __init__(self, double[:, ::1] x, double[:, ::1] y, tuple xi, tuple eta, bint periodic,
                 double[::1] scratch, bint coarse):
        cdef double[:, ::1] plane
        self.x, self.y = x.base, y.base
        self.kept = [x, y, scratch]
        self.controls = []
        self.level.mi, self.level.mj = x.shape[0] - 1, x.shape[1] - 1
        if <size_t>scratch.shape[0] < multigrid_scratch(self.level.mi, self.level.mj):
            raise ValueError("too little scratch")
        self.level.periodic = periodic
        self.level.x, self.level.y, self.level.scratch = &x[0, 0], &y[0, 0], &scratch[0]
        self.level.xi = self.differences(xi, x.shape[0])
        self.level.eta = self.differences(eta, x.shape[1])
        if coarse:
            self.x0, self.y0, self.fx, self.fy = (np.zeros_like(self.x) for _ in range(4))
            plane = self.x0
            self.level.x0 = &plane[0, 0]
            plane = self.y0
            self.level.y0 = &plane[0, 0]
            plane = self.fx
            self.level.fx = &plane[0, 0]
            plane = self.fy
            self.level.fy = &plane[0, 0]

    cdef const double *row(self, object weights, Py_ssize_t n) except NULL:
        cdef const double[::1] view = weights
        if view.shape[0] != n:
            raise ValueError(f"{view.shape[0]} weights for {n} nodes")
        self.kept.append(weights)
        return &view[0]

    cdef Differences differences(self, tuple weights, Py_ssize_t n) except *:
        cdef Differences d
        d.forward, d.backward, d.centred = self.row(weights[0], n), self.row(weights[1], n), self.row(weights[2], n)
        return d

    def transfer(self, tuple xi, tuple eta):
        """Set the weights (right, before, at, after) between this level and the next coarser one."""
        cdef Py_ssize_t ni = self.level.mi + 1, nj = self.level.mj + 1
        cdef Py_ssize_t NI = ni // 2 + 1, NJ = nj // 2 + 1
        self.level.xi_coarse.right = self.row(xi[0], ni)
        self.level.xi_coarse.before = self.row(xi[1], NI)
        self.level.xi_coarse.at = self.row(xi[2], NI)
        self.level.xi_coarse.after = self.row(xi[3], NI)
        self.level.eta_coarse.right = self.row(eta[0], nj)
        self.level.eta_coarse.before = self.row(eta[1], NJ)
        self.level.eta_coarse.at = self.row(eta[2], NJ)
        self.level.eta_coarse.after = self.row(eta[3], NJ)

    def control(self, tuple phi, tuple psi, object xi_reach, object eta_reach):
        """Set control functions along xi and along eta.

        Each is (along (terms, ni), across (terms, nj)), the factors of a sum of products that is the logarithm
        of the ratio of neighbouring steps; no terms mean no control. `xi_reach` (ni), `eta_reach` (nj): the longer
        step at each node.
        """
        self.controls = []
        self.level.phi = self.factors(phi, xi_reach, self.level.mi + 1)
        self.level.psi = self.factors(psi, eta_reach, self.level.mj + 1)

    cdef Control factors(self, tuple pair, object reach, Py_ssize_t n) except *:
        cdef Control c
        cdef const double[:, ::1] along = pair[0], across = pair[1]
        cdef const double[::1] steps = reach
        if along.shape[1] != self.level.mi + 1 or across.shape[1] != self.level.mj + 1 or steps.shape[0] != n \
                or along.shape[0] != across.shape[0]:
            raise ValueError("control functions do not fit the level")
        self.controls.append((along, across, steps))
        c.terms, c.reach = along.shape[0], &steps[0]
        c.along = &along[0, 0] if c.terms else NULL
        c.across = &across[0, 0] if c.terms else NULL
        return c

    def smooth(self, bint forced, int sweeps=1):
        """Relax in place: eta lines, then xi lines, two colours each."""
        cdef int k
        with nogil:
            for k in range(sweeps):
                multigrid_smooth(&self.level, forced)

    def residual(self, bint forced):
        """Return the sum of squares of the residual at the nodes solved for."""
        cdef double total
        with nogil:
            total = multigrid_residual(&self.level, forced)
        return total

    def restrict(self, Level coarse, bint forced):
        """Send nodes and residual down; return the sum of squares of the coarse right side."""
        cdef double total
        self.check(coarse)
        with nogil:
            total = multigrid_restrict(&self.level, &coarse.level, forced)
        return total

    def correct(self, Level coarse):
        """Add the interpolated coarse x - x0; return its sum of squares on the coarse nodes."""
        cdef double total
        self.check(coarse)
        with nogil:
            total = multigrid_correct(&self.level, &coarse.level)
        return total

    cdef int check(self, Level coarse) except -1:
        if coarse.level.x0 is NULL or self.level.xi_coarse.right is NULL:
            raise ValueError("levels are not linked")
        if coarse.level.mi != (self.level.mi + 1) // 2 or coarse.level.mj != (self.level.mj + 1) // 2:
            raise ValueError("levels do not follow each other")
        return 0
