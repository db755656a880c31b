cdef extern from "energy/steps.h":
    ctypedef struct Steps:
        ptrdiff_t n
        double *gradient
        double value, smallest, reach, farthest, still, gain
    int GOES_ON
    int steps_take(Steps *s) nogil

cdef extern from "energy/variational.h":
    ctypedef struct Weights:
        double aspect, shape, smoothness, epsilon
        int periodic
        const double *relief
    ctypedef struct Half:
        ptrdiff_t nodes, modes
        const float *q
        const float *q_t
    ctypedef struct Transform:
        Half even, odd
    ctypedef struct Spectrum:
        ptrdiff_t mi, mj
        Transform xi, eta
        const float *scale
        float rest
    ctypedef struct Band:
        ptrdiff_t mi, mj, width
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
        ptrdiff_t ni, nj, first
        int threads
        Weights weights
        Spectrum spectrum
        Space space
        Written z
        Steps steps
    size_t variational_workspace(ptrdiff_t ni, ptrdiff_t nj, int threads) nogil
    double c_variational_energy "variational_energy"(
        const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const Weights *weights, int threads, double *gx,
        double *gy, double *smallest, double *work) nogil
    size_t band_floats(Band *b, ptrdiff_t mi, ptrdiff_t mj) nogil
    int band_factor(const Band *b, const double *z, const Weights *weights, double *unit) nogil
    int newton_steps(const Band *b, double *z, const Weights *weights, int most, double won, double *room,
                     float *moves) nogil
    void descent_sizes(const Descent *d, size_t *doubles, size_t *floats) nogil
    void descent_place(Descent *d, double *doubles, float *floats) nogil
    void descent_start(Descent *d) nogil
    double descent_slope(const Descent *d) nogil

cdef extern from "Python.h":
    int PyErr_CheckSignals() except -1


cdef Weights weights_of(double aspect, double shape, double smoothness, double epsilon=0.0, bint periodic=False):
    cdef Weights w
    w.aspect, w.shape, w.smoothness, w.epsilon, w.periodic, w.relief = aspect, shape, smoothness, epsilon, periodic, NULL
    return w


def variational_energy(z, double aspect, double shape, double smoothness, double epsilon, bint periodic, relief,
                       gradient, int threads=1):
    """Return (functional, smallest corner Jacobian) at the planes z (2, ni, nj); fill `gradient` (2, ni, nj).

    The gradient is zero at fixed nodes: all boundary nodes, or if `periodic` those of the first and the last column.
    For the weights see ``energy/variational.h``.
    """
    cdef ptrdiff_t ni = z.shape[1], nj = z.shape[2]
    cdef Weights weights = weights_of(aspect, shape, smoothness, epsilon, periodic)
    cdef double total, smallest = 0.0
    cdef Read x = reads(z, (2, ni, nj))
    cdef Written g = fills(gradient, (2, ni, nj))
    threads = min(max(threads, 1), 64)
    work = np.empty(variational_workspace(ni, nj, threads))
    cdef Written room = fills(work, work.shape)
    if relief is not None:
        weights.relief = reads(relief, (ni,))
    with nogil:
        total = c_variational_energy(x, x + ni * nj, ni, nj, &weights, threads, g, g + ni * nj, &smallest, room)
    return total, smallest


def newton(z, double aspect, double shape, double smoothness, int most, double won=0.0):
    """Take at most `most` Newton steps from the planes z (2, ni, nj) of a valid grid, in place; return their number."""
    cdef ptrdiff_t ni = z.shape[1], nj = z.shape[2]
    cdef Weights weights = weights_of(aspect, shape, smoothness)
    cdef Band band
    cdef Written x = fills(z, (2, ni, nj))
    cdef int done
    if ni < 3 or nj < 3:
        raise ValueError("planes without inner nodes")
    columns = np.empty(band_floats(&band, ni - 2, nj - 2), np.float32)
    moves = np.empty(2 * band.mi * band.mj + band.width, np.float32)
    room = np.empty(6 * ni * nj + variational_workspace(ni, nj, 1))
    band.column = fills_single(columns)
    cdef float *to = fills_single(moves)
    cdef Written work = fills(room, room.shape)
    with nogil:
        done = newton_steps(&band, x, &weights, most, won, work, to)
    return done


cdef float *fills_single(array) except NULL:
    return <float *>numbers(array, b"f", 4, array.shape, True)


cdef class Stiffness:
    """The Hessian of the functional at the planes z (2, ni, nj) of a coarse grid with fixed boundary nodes.

    It is modified to be positive definite. `usable` says whether it can precondition descents on finer grids; the
    planes must have no folded cells.
    """

    cdef Space space
    cdef object held
    cdef readonly bint usable

    def __init__(self, z, double aspect, double shape, double smoothness):
        cdef ptrdiff_t mi = z.shape[1] - 2, mj = z.shape[2] - 2
        cdef const double *x = reads(z, (2, mi + 2, mj + 2))
        cdef Weights weights = weights_of(aspect, shape, smoothness)
        self.usable = False
        if mi < 1 or mj < 1 or max(mi, mj) > SPACE:
            return
        columns = np.empty(band_floats(&self.space.band, mi, mj), np.float32)
        unknowns = np.empty(2 * mi * mj + self.space.band.width, np.float32)
        self.space.band.column, self.space.unknowns = fills_single(columns), fills_single(unknowns)
        self.held = (columns, unknowns)
        with nogil:
            self.usable = band_factor(&self.space.band, x, &weights, &self.space.unit)


cdef class Modes:
    """Even or odd modes along a direction on half of its nodes, (nodes, modes), laid out for the matrix product."""

    cdef Half half
    cdef object held

    def __init__(self, matrix):
        self.held = q, q_t = _padded(matrix), _padded(matrix.T)
        self.half.nodes, self.half.modes = matrix.shape
        self.half.q, self.half.q_t = reads_single(q, q.shape), reads_single(q_t, q_t.shape)


cdef class VariationalDescent:
    """Minimisations of the functional over grids of (ni, nj) nodes.

    `rows` are the even and odd modes along xi, `columns` those along eta. The preconditioner divides by `scale` (2,
    modes of xi, modes of eta), the symbol of the Hessian for displacements along xi and along eta, and by `rest` for
    the modes that are left out.
    """

    cdef Descent state
    cdef object held

    def __init__(self, ptrdiff_t ni, ptrdiff_t nj, bint periodic, tuple rows, tuple columns, scale, float rest,
                 int threads=1):
        cdef size_t doubles = 0, floats = 0
        cdef Spectrum *s = &self.state.spectrum
        s.xi.even, s.xi.odd = (<Modes?>rows[0]).half, (<Modes?>rows[1]).half
        s.eta.even, s.eta.odd = (<Modes?>columns[0]).half, (<Modes?>columns[1]).half
        s.mi, s.mj = s.xi.even.nodes + s.xi.odd.nodes, s.eta.even.nodes + s.eta.odd.nodes
        if s.mi != (ni - 1 if periodic else ni - 2) or s.mj != nj - 2:
            raise ValueError("transforms of another size")
        if scale.shape != (2, s.xi.even.modes + s.xi.odd.modes, s.eta.even.modes + s.eta.odd.modes):
            raise ValueError("a scale of another size")
        split = s.eta.even.modes
        factors = np.concatenate([_padded(scale[..., :split]), _padded(scale[..., split:])], axis=-1)
        s.scale, s.rest = reads_single(factors, factors.shape), rest
        self.state.ni, self.state.nj, self.state.first = ni, nj, 0 if periodic else 1
        self.state.weights.periodic, self.state.threads = periodic, min(max(threads, 1), 64)
        descent_sizes(&self.state, &doubles, &floats)
        room, small = np.empty(doubles), np.empty(floats, np.float32)
        descent_place(&self.state, fills(room, room.shape), fills_single(small))
        self.held = (rows, columns, factors, room, small)

    def steer(self, Stiffness stiffness, along, across):
        """Let `stiffness` precondition smooth displacements: `along` (mi, mi coarse) and `across` (mj, mj coarse)
        interpolate from its inner nodes to all."""
        cdef Space *s = &self.state.space
        if not stiffness.usable:
            raise ValueError("a Hessian that is not positive")
        if along.shape != (self.state.spectrum.mi, stiffness.space.band.mi) or across.shape != (
            self.state.spectrum.mj, stiffness.space.band.mj
        ):
            raise ValueError("splines of another size")
        first, second = _padded(along, SPACE), _padded(across, SPACE)
        turned = np.ascontiguousarray(second.T)
        s[0] = stiffness.space
        s.along, s.across = reads_single(first, first.shape), reads_single(second, second.shape)
        s.across_t = reads_single(turned, turned.shape)
        self.held = (*self.held, stiffness, first, second, turned)

    def run(self, z, double aspect, double shape, double smoothness, double epsilon, relief, double still,
            double reach, int most, listener=None):
        """Minimise from the planes z (2, ni, nj), in place; return (functional, smallest Jacobian, iterations).

        It stops if no node moves by more than `still` cells in two consecutive iterations, or after `most`
        iterations. In the first no node moves by more than `reach` cells. `listener` is called with the iterations
        done, the functional and the norm of its gradient, at the start and after each iteration.
        """
        cdef int done = 0, state = GOES_ON
        self.state.z = fills(z, (2, self.state.ni, self.state.nj))
        self.state.weights = weights_of(aspect, shape, smoothness, epsilon, self.state.weights.periodic)
        if relief is not None:
            self.state.weights.relief = reads(relief, (self.state.ni,))
        self.state.steps.still, self.state.steps.reach = still, reach
        with nogil:
            descent_start(&self.state)
        if listener is not None:
            listener(0, self.state.steps.value, descent_slope(&self.state))
        while done < most and state == GOES_ON:
            PyErr_CheckSignals()
            with nogil:
                state = steps_take(&self.state.steps)
            done += 1
            if listener is not None:
                listener(done, self.state.steps.value, descent_slope(&self.state))
        return self.state.steps.value, self.state.steps.smallest, done


def _padded(matrix, panel=32):
    """Return `matrix` (..., n) in single precision, with columns of zeros up to a multiple of `panel`."""
    *rows, n = matrix.shape
    result = np.zeros((*rows, (n + panel - 1) // panel * panel), np.float32)
    result[..., :n] = matrix
    return result
