from libc.math cimport isfinite

cdef extern from "lanes.h":
    int LANES

cdef extern from "conformal/lift.h":
    ctypedef struct LiftCorner:
        Cplx p, q, P, Q
        double k
    ctypedef struct BodyLift:
        Cplx centre, quarter, pole
        double phase
        int n_corners
        LiftCorner corners[2]
    ctypedef struct LineOff:
        Cplx corner, ahead, behind, w
    int lift_wall(const Cplx *wall, ptrdiff_t n, int swap, BodyLift *found, Cplx *w, ptrdiff_t *corners,
                  double *winding, double *scratch) nogil
    void c_lift_to_strip "lift_to_strip"(const BodyLift *lift, const Cplx *z, ptrdiff_t n, Cplx *w) nogil
    void c_lift_follow "lift_follow"(const Cplx *wall, ptrdiff_t n, Cplx centre, Cplx quarter, Cplx *zeta) nogil
    void lift_expand(LiftCorner *corner) nogil
    double c_lift_bisect "lift_bisect"(const BodyLift *lift, const LineOff *line, double start, double limit) nogil

cdef extern from "conformal/picard.h":
    void c_fourier_columns "fourier_columns"(const double *modes, ptrdiff_t m, ptrdiff_t highest, const double *gain,
                                             const double *unit, double *columns, ptrdiff_t count,
                                             ptrdiff_t width) nogil
    int PICARD_COUNT, PICARD_LEVELS
    ctypedef double *PicardRow "PicardRow *"
    ctypedef struct PicardMatrices:
        PicardRow d1, d2, inverse, vectors
        Read eigenvalues, smooth
    ctypedef struct PicardScratch:
        pass
    double c_picard_step "picard_step"(PicardRow c, double height, const PicardMatrices *m, PicardScratch *s) nogil

cdef extern from "conformal/strip_rows.h":
    int PANEL_NODES
    ctypedef struct WindowSum:
        const double *columns
        ptrdiff_t count, start "from", m, width
    ctypedef struct StripRows:
        ptrdiff_t n, m
        double sharpness
        const WindowSum *sums
        ptrdiff_t n_sums
        Read along, across
        ptrdiff_t n_nudges
        BodyLift lift
        const double *matrix
        const ptrdiff_t *cuts
        ptrdiff_t panels, begin
        int symmetric
        Cplx on_axis, turned
    double c_strip_rows "strip_rows"(const StripRows *s, const ptrdiff_t *order, ptrdiff_t count, double *x, double *y,
                                     ptrdiff_t nj, int threads, double *scratch) nogil


cdef Cplx *fills_complex(array) except NULL:
    return <Cplx *>numbers(array, b"Z", 16, array.shape, True)


cdef int lift_of(maps, BodyLift *lift) except -1:
    """Copy the maps of a `geometry.conformal.lift.Lift` to `lift`."""
    cdef int k = 0
    if len(maps.corners) > 2:
        raise ValueError("more than two corners")
    lift.centre, lift.quarter, lift.pole = pair(maps.centre), pair(maps.quarter), pair(maps.pole)
    lift.phase, lift.n_corners = maps.phase, len(maps.corners)
    for corner in maps.corners:
        lift.corners[k].p, lift.corners[k].q = pair(corner.p), pair(corner.q)
        lift.corners[k].P, lift.corners[k].Q, lift.corners[k].k = pair(corner.P), pair(corner.Q), corner.k
        lift_expand(&lift.corners[k])
        k += 1
    return 0


def lift_body(wall, bint swap):
    """Return centre, quarter, corners (p, q, P, Q, k), pole, phase, strip points, trailing nodes and winding number.

    `wall` (n,) has n >= 8 points; the results are those of `geometry.conformal.lift.lift_body`.
    """
    cdef ptrdiff_t n = len(wall)
    cdef ptrdiff_t corners[2]
    cdef BodyLift found
    cdef LiftCorner c
    cdef double winding
    cdef int count, k
    if n < 8:
        raise ValueError("fewer than 8 nodes")
    w, scratch = np.empty(n, complex), np.empty(3 * n)
    cdef const Cplx *nodes = reads_complex(wall, (n,))
    cdef Cplx *to = fills_complex(w)
    cdef Written room = fills(scratch, (3 * n,))
    with nogil:
        count = lift_wall(nodes, n, swap, &found, to, corners, &winding, room)
    removed = []
    for k in range(found.n_corners):
        c = found.corners[k]
        removed.append((number(c.p), number(c.q), number(c.P), number(c.Q), c.k))
    return (number(found.centre), number(found.quarter), removed, number(found.pole), found.phase, w,
            tuple([corners[k] for k in range(count)]), winding)


def lift_to_strip(maps, z):
    """Return the strip points of `z` (n,) by a `geometry.conformal.lift.Lift` with at most two corners."""
    cdef BodyLift lift
    cdef ptrdiff_t n = len(z)
    w = np.empty(n, complex)
    lift_of(maps, &lift)
    if n:
        c_lift_to_strip(&lift, reads_complex(z, (n,)), n, fills_complex(w))
    return w


def lift_follow(wall, centre, quarter):
    """Return zeta (n,) along a wall (n,); see `geometry.conformal.lift.follow`."""
    cdef ptrdiff_t n = len(wall)
    zeta = np.empty(n, complex)
    if n < 2:
        raise ValueError("fewer than 2 nodes")
    c_lift_follow(reads_complex(wall, (n,)), n, pair(centre), pair(quarter), fills_complex(zeta))
    return zeta


def lift_bisect(maps, corner, ahead, behind, w, double start, double limit):
    """Return the shift of phi with which the grid line from `w` leaves a corner of the wall along its bisector.

    `maps` are a `geometry.conformal.lift.Lift`; for the other arguments see ``conformal/lift.h``.
    """
    cdef BodyLift lift
    cdef LineOff line
    lift_of(maps, &lift)
    line.corner, line.ahead, line.behind, line.w = pair(corner), pair(ahead), pair(behind), pair(w)
    return c_lift_bisect(&lift, &line, start, limit)


def fourier_columns(modes, gain, unit, columns):
    """Write values of Fourier sums to `columns`, which must be zero; for the arguments see ``conformal/picard.h``."""
    cdef ptrdiff_t count = columns.shape[0], width = columns.shape[2], m = modes.shape[0]
    cdef ptrdiff_t highest = modes.shape[1] // 2
    if width % LANES or m > width or count & (count - 1) or count < 2:
        raise ValueError("columns do not fit")
    if 2 * highest >= count or len(gain) <= highest:
        raise ValueError("modes do not fit")
    cdef const Cplx *c = reads_complex(modes, (m, 2 * highest + 1))
    cdef Read factors = reads(gain, gain.shape)
    cdef const Cplx *roots = reads_complex(unit, (count // 2,))
    cdef Written to = fills(columns, (count, 2, width))
    if m:
        with nogil:
            c_fourier_columns(<const double *>c, m, highest, factors, <const double *>roots, to, count, width)


def picard_step(c, double height, matrices, eigenvalues, smooth):
    """Take a Picard step of modes `c` (2, 2 MODES + 1, LEVELS), real and imaginary parts; return the largest change.

    For `matrices` (4, LEVELS, LEVELS) and `eigenvalues` see ``conformal/picard.h``; the modes of the change
    are multiplied by `smooth`.
    """
    cdef PicardMatrices m
    cdef double change
    cdef ptrdiff_t size = PICARD_LEVELS * PICARD_LEVELS
    cdef Read four = reads(matrices, (4, PICARD_LEVELS, PICARD_LEVELS))
    cdef Written modes = fills(c, (2, PICARD_COUNT, PICARD_LEVELS))
    m.d1, m.d2, m.inverse = <PicardRow>four, <PicardRow>(four + size), <PicardRow>(four + 2 * size)
    m.vectors = <PicardRow>(four + 3 * size)
    m.eigenvalues, m.smooth = reads(eigenvalues, (PICARD_LEVELS,)), reads(smooth, (PICARD_COUNT,))
    scratch = np.empty(sizeof(PicardScratch) // 8)
    cdef Written room = fills(scratch, scratch.shape)
    with nogil:
        change = c_picard_step(<PicardRow>modes, height, &m, <PicardScratch *>room)
    return change


def strip_rows(x, y, order, lift, sums, double sharpness, along, across, matrix, cuts, ptrdiff_t begin, axis,
               int threads=1):
    """Fill levels 1 .. nj - 2 of the rows in `order` of `x` and `y` (n + 1, nj); return whether they are all finite.

    `lift` is a `geometry.conformal.lift.Lift`. `sums` are a point, the number of points after it, and their columns
    (Q, 2, width). `axis` is a point and the squared direction of the axis of symmetry, or None. For the others see
    ``conformal/strip_rows.h``.
    """
    cdef StripRows s
    cdef WindowSum *windows
    cdef ptrdiff_t nj = x.shape[1], rows = len(order), width = matrix.shape[1], i, start, count
    cdef Written px = fills(x, y.shape), py = fills(y, x.shape)
    cdef const ptrdiff_t *places = reads_indices(order, (rows,))
    cdef double total
    s.n, s.m, s.n_nudges, s.panels, s.begin = len(x) - 1, across.shape[1], len(along), len(cuts) - 1, begin
    s.sharpness, s.symmetric = sharpness, axis is not None
    s.on_axis, s.turned = pair(axis[0] if axis else 0j), pair(axis[1] if axis else 0j)
    s.along, s.across = reads(along, (s.n_nudges, s.n)), reads(across, (s.n_nudges, s.m))
    s.matrix, s.cuts = reads(matrix, (PANEL_NODES, width)), reads_indices(cuts, (s.panels + 1,))
    if s.cuts[0] != 0 or s.cuts[s.panels] != width:
        raise ValueError("panels do not fit their matrix")
    if begin < 1 or s.m != nj - 2 - width + PANEL_NODES * s.panels or begin - 1 + PANEL_NODES * s.panels > s.m:
        raise ValueError("points do not fit the levels")
    for i in range(s.panels):
        if s.cuts[i] > s.cuts[i + 1]:
            raise ValueError("cuts do not rise")
    for i in range(rows):
        if not 0 <= places[i] < s.n:
            raise ValueError("a row beyond the last")
    if s.m == 0 or rows == 0:
        return True
    lift_of(lift, &s.lift)
    held = np.empty((len(sums) + 1) * sizeof(WindowSum), np.uint8)
    windows = <WindowSum *>numbers(held, b"B", 1, held.shape, True)
    s.sums, s.n_sums = windows, 0
    for start, count, values in sums:
        windows[s.n_sums].start, windows[s.n_sums].m = start, count
        windows[s.n_sums].count, windows[s.n_sums].width = len(values), values.shape[2]
        if start < 0 or count < 0 or start + count > s.m or len(values) & (len(values) - 1):
            raise ValueError("columns do not fit")
        if count > values.shape[2] or values.shape[2] % LANES:
            raise ValueError("columns are not as wide as the points they are for")
        windows[s.n_sums].columns = reads(values, (len(values), 2, values.shape[2]))
        s.n_sums += 1 if len(values) and count else 0
    threads = min(max(threads, 1), 64)
    scratch = np.empty(threads * 8 * (s.m + LANES))
    cdef Written room = fills(scratch, scratch.shape)
    with nogil:
        total = c_strip_rows(&s, places, rows, px, py, nj, threads, room)
    return bool(isfinite(total))
