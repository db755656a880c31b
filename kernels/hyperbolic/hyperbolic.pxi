cdef extern from "hyperbolic/march.h":
    ctypedef struct MarchSettings:
        double dissipation, even, tolerated, bend, implicit, volume
        ptrdiff_t sweeps, rise
    ctypedef struct MarchEnds:
        double first_x, first_y, last_x, last_y
    size_t hyperbolic_scratch(ptrdiff_t n) nogil
    void c_hyperbolic_march "hyperbolic_march"(
        double *x, double *y, ptrdiff_t n, ptrdiff_t levels, const double *steps, const double *widening,
        const double *ratios, const MarchEnds *ends, const MarchSettings *settings, int threads, double *scratch) nogil


def hyperbolic_march(x, y, steps, double dissipation, double even, double tolerated, double bend, double implicit,
                     double volume, ptrdiff_t sweeps, ptrdiff_t rise, ends=None, widening=None, ratios=None,
                     int threads=1):
    """Fill levels 1 and up of `x` and `y` (levels + 1, n) from level 0, n >= 3 nodes with the grid on their left.

    `steps` (levels) are the distances between levels. Level 0 is closed, unless `ends` are two unit directions (2, 2)
    along which its end nodes move; then `widening` (n) multiplies the steps near it. `ratios` (n) multiply the growth
    ratios of the steps. The others are described in ``march.h``.
    """
    cdef ptrdiff_t n = x.shape[1], levels = len(x) - 1
    cdef MarchSettings settings = MarchSettings(dissipation, even, tolerated, bend, implicit, volume, sweeps, rise)
    cdef MarchEnds directions
    cdef MarchEnds *given = NULL
    if n < 3 or levels < 1:
        raise ValueError("too few nodes or levels")
    cdef Written px = fills(x, (levels + 1, n)), py = fills(y, (levels + 1, n))
    cdef Read apart = reads(steps, (levels,)), wide = apart, growing = apart
    cdef const double *widens = NULL
    cdef const double *grows = NULL
    scratch = np.empty(hyperbolic_scratch(n))
    cdef Written room = fills(scratch, scratch.shape)
    if widening is not None:
        wide = reads(widening, (n,))
        widens = wide
    if ratios is not None:
        growing = reads(ratios, (n,))
        grows = growing
    if ends is not None:
        directions = MarchEnds(ends[0][0], ends[0][1], ends[1][0], ends[1][1])
        given = &directions
    with nogil:
        c_hyperbolic_march(px, py, n, levels, apart, widens, grows, given, &settings, threads, room)
