cdef extern from "elliptic/multigrid.h":
    ctypedef struct Differences:
        Read forward, backward, centred
    ctypedef struct Transfer:
        Read right, before, at, after
    ctypedef struct Control:
        ptrdiff_t terms
        Read along, across, reach
    ctypedef struct Level:
        ptrdiff_t mi, mj
        int periodic
        Written x, y, fx, fy, x0, y0
        Differences xi, eta
        Transfer xi_coarse, eta_coarse
        Control phi, psi
        int threads
        double *scratch
    size_t c_multigrid_scratch "multigrid_scratch"(ptrdiff_t mi, ptrdiff_t mj, int threads) nogil
    void multigrid_smooth(const Level *level, int forced) nogil
    double multigrid_residual(const Level *level, int forced) nogil
    void multigrid_restrict(const Level *fine, const Level *coarse, int forced) nogil
    double multigrid_correct(const Level *fine, const Level *coarse) nogil


def multigrid_scratch(ptrdiff_t mi, ptrdiff_t mj, int threads=1):
    """Return the number of doubles of scratch that `threads` threads need on a level of mi x mj cells."""
    return c_multigrid_scratch(mi, mj, threads)


cdef class MultigridLevel:
    """One level of the multigrid method, whose arrays it keeps alive: nodes `x`, `y` (mi + 1, mj + 1), changed in place;
    weights (forward, backward, centred) of the differences along `xi` and `eta`; `scratch`, which levels share. A
    `coarse` level has a right-hand side and a copy of the restricted nodes. Results are the same for any number of
    `threads`."""

    cdef Level level
    cdef list kept
    cdef tuple controls
    cdef readonly object x, y, x0, y0, fx, fy

    def __init__(self, x, y, tuple xi, tuple eta, bint periodic, scratch, bint coarse, int threads=1):
        self.x, self.y, self.kept, self.level.threads = x, y, [scratch], min(max(threads, 1), 64)
        self.level.mi, self.level.mj, self.level.periodic = x.shape[0] - 1, x.shape[1] - 1, periodic
        self.level.x, self.level.y = fills(x, y.shape), fills(y, x.shape)
        self.level.scratch = fills_room(scratch, c_multigrid_scratch(self.level.mi, self.level.mj, self.level.threads))
        self.level.xi, self.level.eta = self.differences(xi, len(x)), self.differences(eta, x.shape[1])
        if coarse:
            self.x0, self.y0, self.fx, self.fy = (np.zeros_like(x) for _ in range(4))
            self.level.x0, self.level.y0 = fills(self.x0, x.shape), fills(self.y0, x.shape)
            self.level.fx, self.level.fy = fills(self.fx, x.shape), fills(self.fy, x.shape)

    cdef const double *row(self, weights, ptrdiff_t n) except NULL:
        self.kept.append(weights)
        return reads(weights, (n,))

    cdef Differences differences(self, tuple weights, ptrdiff_t n) except *:
        cdef Differences d
        d.forward, d.backward, d.centred = self.row(weights[0], n), self.row(weights[1], n), self.row(weights[2], n)
        return d

    cdef Transfer transfers(self, tuple weights, ptrdiff_t n) except *:
        cdef Transfer t
        cdef ptrdiff_t coarse = n // 2 + 1
        t.right, t.before = self.row(weights[0], n), self.row(weights[1], coarse)
        t.at, t.after = self.row(weights[2], coarse), self.row(weights[3], coarse)
        return t

    def transfer(self, tuple xi, tuple eta):
        """Set the weights (right, before, at, after) of the transfer between this level and the next coarser one."""
        self.level.xi_coarse = self.transfers(xi, self.level.mi + 1)
        self.level.eta_coarse = self.transfers(eta, self.level.mj + 1)

    def control(self, tuple phi, tuple psi, xi_reach, eta_reach):
        """Set the control functions along xi and along eta.

        Each is a pair (along (terms, ni), across (terms, nj)). The sum over the terms of along times across is the
        logarithm of the ratio of neighbouring steps; without terms there is no control. `xi_reach` (ni) and `eta_reach`
        (nj) are the longer of the two steps at each node.
        """
        self.controls = phi, psi, xi_reach, eta_reach
        self.level.phi = self.factors(phi, xi_reach, self.level.mi + 1)
        self.level.psi = self.factors(psi, eta_reach, self.level.mj + 1)

    cdef Control factors(self, tuple pair, reach, ptrdiff_t n) except *:
        cdef Control c
        c.terms, c.reach = len(pair[0]), reads(reach, (n,))
        c.along = reads(pair[0], (c.terms, self.level.mi + 1))
        c.across = reads(pair[1], (c.terms, self.level.mj + 1))
        return c

    def smooth(self, bint forced, int sweeps=1):
        """Relax in place by lines along eta, then along xi, each in two colours; `forced` adds the right-hand side."""
        cdef int k
        with nogil:
            for k in range(sweeps):
                multigrid_smooth(&self.level, forced)

    def residual(self, bint forced):
        """Compute the residual at the unknown nodes; return the sum of its squares."""
        cdef double total
        with nogil:
            total = multigrid_residual(&self.level, forced)
        return total

    def restrict(self, MultigridLevel coarse, bint forced):
        """Restrict nodes and residual to the `coarse` level."""
        self.check(coarse)
        with nogil:
            multigrid_restrict(&self.level, &coarse.level, forced)

    def correct(self, MultigridLevel coarse):
        """Add the interpolated coarse correction x - x0; return the sum of its squares on the coarse nodes."""
        cdef double total
        self.check(coarse)
        with nogil:
            total = multigrid_correct(&self.level, &coarse.level)
        return total

    cdef int check(self, MultigridLevel coarse) except -1:
        if coarse.level.x0 is NULL or self.level.xi_coarse.right is NULL:
            raise ValueError("levels are not linked")
        if coarse.level.mi != (self.level.mi + 1) // 2 or coarse.level.mj != (self.level.mj + 1) // 2:
            raise ValueError("levels do not follow each other")
        return 0
