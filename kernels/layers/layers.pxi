cdef extern from "layers/layers.h":
    ctypedef struct Layers:
        double first, last
        ptrdiff_t constant
    double c_layer_steps "layer_steps"(double *steps, ptrdiff_t cells, double length, const Layers *layers,
                                       double *log_ratio) nogil
    double c_layer_lines "layer_lines"(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, double *X,
                                       double *Y, ptrdiff_t NJ, const Layers *layers, int threads,
                                       double *scratch) nogil
    void redistribute_lines(double *x, double *y, ptrdiff_t ni, ptrdiff_t nj, const double *first, const double *fade,
                            int threads, double *scratch) nogil

cdef extern from "layers/sampled.h":
    ctypedef struct NodeLines:
        ptrdiff_t lines, nodes, size
        const double *node
        const double *arc
    void c_sampled_lines "sampled_lines"(const NodeLines *all, const double *at, ptrdiff_t count, double *points,
                                         double *slopes) nogil

cdef extern from "layers/law.h":
    void c_layer_law "layer_law"(const double *wanted, const double *slopes, ptrdiff_t n, ptrdiff_t rows, double most,
                                 double steeper, double *cells) nogil

cdef extern from "layers/even_line.h":
    ctypedef struct Measures:
        ptrdiff_t points, measures
        int closed
        Read arc, value, slope
    ctypedef struct EvenTerms:
        Read limit, stiffness, factor, rest
        const ptrdiff_t *pair
        ptrdiff_t links
        double change, linear, nearly
    ctypedef struct EvenSteps:
        Read reached
        double weight, rise, most
        int steps, halvings
    ptrdiff_t even_line_entries(const Measures *measures, const EvenTerms *terms, const ptrdiff_t *unknown,
                                ptrdiff_t places) nogil
    ptrdiff_t c_even_line "even_line"(const Measures *measures, const EvenTerms *terms, const EvenSteps *steps,
                                      const SparsePattern *pattern, const ptrdiff_t *slot, const ptrdiff_t *unknown,
                                      ptrdiff_t places, double *place) nogil


cdef Layers layers_of(ptrdiff_t cells, double first, double last, ptrdiff_t constant) except *:
    cdef Layers layers = Layers(first, last, constant)
    if not (first >= 0 and last >= 0 and first + last > 0 and constant >= 1):
        raise ValueError("no heights to make layers of")
    if cells < constant * ((first > 0) + (last > 0)) + 1:
        raise ValueError("fewer cells than constant layers")
    return layers


def layer_steps(steps, double length, double first, double last, ptrdiff_t constant):
    """Fill `steps` (cells,) so that their sum is `length`; return their largest ratio, infinite if this is impossible."""
    cdef ptrdiff_t cells = len(steps)
    cdef Layers layers = layers_of(cells, first, last, constant)
    cdef double log_ratio = 0.0
    return c_layer_steps(fills(steps, (cells,)), cells, length, &layers, &log_ratio)


def layer_lines(x, y, X, Y, double first, double last, ptrdiff_t constant, int threads=1):
    """Resample the grid lines of `x`, `y` (ni, nj) to `X`, `Y` (ni, NJ); return the largest ratio of neighbouring cells."""
    cdef double largest
    cdef ptrdiff_t ni, nj, NJ = X.shape[1]
    ni, nj = x.shape
    if nj < 3 or NJ < 3:
        raise ValueError("lines of fewer than 3 nodes")
    cdef Layers layers = layers_of(NJ - 1, first, last, constant)
    cdef Read px = reads(x, (ni, nj)), py = reads(y, (ni, nj))
    cdef Written to_x = fills(X, (ni, NJ)), to_y = fills(Y, (ni, NJ))
    threads = min(max(threads, 1), 64)
    scratch = np.empty(threads * (10 * nj + NJ))
    cdef Written room = fills(scratch, scratch.shape)
    with nogil:
        largest = c_layer_lines(px, py, ni, nj, to_x, to_y, NJ, &layers, threads, room)
    return largest


def redistribute(x, y, first, fade, int threads=1):
    """Move the inner nodes of `x` and `y` (ni, nj >= 3) along eta lines so that first-cell heights are `first` (ni).

    `fade` (nj) is the fraction of the relative change of node 1 that is applied to each node.
    """
    cdef ptrdiff_t ni, nj
    ni, nj = x.shape
    if nj < 3:
        raise ValueError("lines of fewer than 3 nodes")
    cdef Written px = fills(x, (ni, nj)), py = fills(y, (ni, nj))
    cdef Read heights = reads(first, (ni,)), share = reads(fade, (nj,))
    threads = min(max(threads, 1), 64)
    scratch = np.empty(threads * 5 * nj)
    cdef Written room = fills(scratch, scratch.shape)
    with nogil:
        redistribute_lines(px, py, ni, nj, heights, share, threads, room)


def layer_law(wanted, slopes, double most, double steeper, cells):
    """Fill `cells` (n, rows) with sizes, relative to the first, of sum `wanted` (n,); for the others see ``law.h``."""
    cdef ptrdiff_t n, rows
    n, rows = cells.shape
    cdef Read sums = reads(wanted, (n,)), ends = reads(slopes, (n,))
    cdef Written to = fills(cells, (n, rows))
    with nogil:
        c_layer_law(sums, ends, n, rows, most, steeper, to)


def sampled_lines(lines, arcs, at, points):
    """Fill `points` (k, n, c) at arc lengths `at` (k, n) of lines (k, m >= 3, c) with nodes at `arcs` (k, m); see ``sampled.h``."""
    cdef ptrdiff_t k, m, c = lines.shape[2], n = at.shape[1]
    k, m = arcs.shape
    if m < 3 or n < 1:
        raise ValueError("lines of fewer than 3 nodes, or no points")
    cdef NodeLines all = NodeLines(k, m, c, reads(lines, (k, m, c)), reads(arcs, (k, m)))
    cdef Read places = reads(at, (k, n))
    cdef Written to = fills(points, (k, n, c))
    slopes = np.empty((m, c))
    cdef Written room = fills(slopes, (m, c))
    with nogil:
        c_sampled_lines(&all, places, n, to, room)


def even_line(tuple measures, bint closed, tuple terms, tuple steps, tuple pattern, slot, unknown, place):
    """Move `place` (n,); return the row where the equations are singular, or -1. For the others see ``even_line.h``.

    `measures` are (arcs (m,), values (k, m), slopes (k, m - 1)); `terms` (limits (k,), stiffness (unknowns,), pairs (p,
    2), factors (p, 2), rest (p,), change, linear, nearly); `steps` (limits (k,), weight, rise, most, steps, halvings).
    """
    cdef ptrdiff_t k, m, n = len(place), links = len(terms[2]), bad
    k, m = measures[1].shape
    if m < 2 or n < 3:
        raise ValueError(f"{m} points and {n} places")
    cdef SparsePattern equations
    pattern_of(pattern, &equations)
    if equations.block != 1:
        raise ValueError("a matrix of blocks")
    cdef const ptrdiff_t *number = reads_places(unknown, (n,), equations.n, -1)
    cdef const ptrdiff_t *slots = reads_places(slot, slot.shape, equations.start[equations.n])
    cdef Measures own = Measures(m, k, closed, reads(measures[0], (m,)), reads(measures[1], (k, m)),
                                 reads(measures[2], (k, m - 1)))
    cdef EvenTerms of = EvenTerms(
        reads(terms[0], (k,)), reads(terms[1], (equations.n,)), reads(terms[3], (links, 2)), reads(terms[4], (links,)),
        reads_places(terms[2], (links, 2), n), links, terms[5], terms[6], terms[7])
    cdef EvenSteps by = EvenSteps(reads(steps[0], (k,)), steps[1], steps[2], steps[3], steps[4], steps[5])
    cdef Written to = fills(place, (n,))
    if len(slot) != even_line_entries(&own, &of, number, n):
        raise ValueError("a matrix of other entries")
    with nogil:
        bad = c_even_line(&own, &of, &by, &equations, slots, number, n, to)
    if bad < 0:
        raise MemoryError
    return equations.order[bad - 1] if bad else -1
