# Surfaces of many patches, and volumes marched from them.

cdef extern from "surfaces/graph.h":
    int MOST_NEIGHBOURS
    ctypedef struct Graph:
        ptrdiff_t nodes, red, ghosts, odd, fixed
        const ptrdiff_t *near
        const ptrdiff_t *odd_nodes
        const ptrdiff_t *odd_start
        const ptrdiff_t *odd_near
        const ptrdiff_t *owner
        const ptrdiff_t *base
        const double *own
        const double *sign
        const double *shift
        const ptrdiff_t *fixed_nodes
        const double *boost
        const double *hollow
        const double *moves

cdef extern from "surfaces/march.h":
    ctypedef struct SurfaceMarch:
        double explicit_smoothing, implicit_smoothing, theta, outer, sharp, size, longest, weight, blend
        ptrdiff_t sweeps, ramp
        double tolerance
        ptrdiff_t most
        double relaxing, settled, near
        ptrdiff_t relaxations
    ctypedef struct SurfaceMarched:
        ptrdiff_t levels, steps, iterations
    int c_surface_march "surface_march"(double *levels, const double *heights, ptrdiff_t count, const Graph *graph,
                                        const SurfaceMarch *settings, int threads, SurfaceMarched *made) nogil

cdef extern from "surfaces/lines.h":
    ctypedef struct Lines:
        ptrdiff_t nodes, levels
        const double *marched
        const double *steps
        const double *fade
        const ptrdiff_t *order
        ptrdiff_t sweeps
        double *lines
    int c_respace_lines "respace_lines"(const Lines *lines, int threads) nogil

cdef extern from "surfaces/growth.h":
    ctypedef struct Growth:
        ptrdiff_t nodes, levels
        double most, used, longest, first
        double *lines
    int c_limit_line_growth "limit_line_growth"(const Growth *growth, int threads) nogil


def surface_march(levels, heights, graph, settings, int threads):
    """March `levels` (count + 1, 3, n) from level 0; return the numbers of levels made, of steps and of iterations.

    `heights` (count) are the distances of the levels from the wall. `graph` holds the arrays of ``graph.h``, `settings`
    the numbers of ``march.h``, in their order.
    """
    cdef ptrdiff_t n = levels.shape[2], count = len(heights), ghosts = len(graph.owner), odd = len(graph.odd_nodes)
    cdef ptrdiff_t fixed = len(graph.fixed_nodes), around = len(graph.odd_near), rows = n + ghosts
    cdef Graph g = Graph(
        n, graph.red, ghosts, odd, fixed, reads_places(graph.near, (4, n), rows),
        reads_places(graph.odd_nodes, (odd,), n), reads_starts(graph.odd_start, odd, around),
        reads_places(graph.odd_near, (around,), rows), reads_places(graph.owner, (ghosts,), n),
        reads_places(graph.base, (ghosts,), n), reads(graph.own, (ghosts,)), reads(graph.sign, (3, ghosts)),
        reads(graph.shift, (3, ghosts)), reads_places(graph.fixed_nodes, (fixed,), n), reads(graph.boost, (n,)), reads(graph.hollow, (n,)),
        reads(graph.moves, (3, fixed)))
    if not 0 <= g.red <= n or (odd and np.diff(graph.odd_start).max() > MOST_NEIGHBOURS):
        raise ValueError("red nodes beyond the last, or a node of too many neighbours")
    cdef SurfaceMarch s
    cdef SurfaceMarched made
    cdef int failed
    (s.explicit_smoothing, s.implicit_smoothing, s.theta, s.outer, s.sharp, s.size, s.longest, s.weight, s.blend, s.sweeps,
     s.ramp, s.tolerance, s.most, s.relaxing, s.settled, s.near, s.relaxations) = settings
    cdef Written px = fills(levels, (count + 1, 3, n))
    cdef Read apart = reads(heights, (count,))
    with nogil:
        failed = c_surface_march(px, apart, count, &g, &s, threads, &made)
    if failed:
        raise MemoryError
    return made.levels, made.steps, made.iterations


def respace_lines(marched, steps, fade, order, ptrdiff_t sweeps, lines, int threads):
    """Fill `lines` (3, n, levels) with the nodes of `marched` (levels, 3, n) moved along their lines; see ``lines.h``."""
    cdef ptrdiff_t levels = len(marched), n = marched.shape[2]
    cdef Lines l = Lines(n, levels, reads(marched, (levels, 3, n)), reads(steps, (levels - 1,)),
                         reads(fade, (levels - 1,)), reads_places(order, (n,), n), sweeps, fills(lines, (3, n, levels)))
    cdef int failed
    with nogil:
        failed = c_respace_lines(&l, threads)
    if failed:
        raise MemoryError


def limit_line_growth(lines, double most, double used, double longest, double first, int threads):
    """Move nodes along `lines` (3, n, levels), in place, to reduce the growth ratios of cells; see ``growth.h``."""
    cdef ptrdiff_t n = lines.shape[1], levels = lines.shape[2]
    cdef Growth g = Growth(n, levels, most, used, longest, first, fills(lines, (3, n, levels)))
    cdef int failed
    with nogil:
        failed = c_limit_line_growth(&g, threads)
    if failed:
        raise MemoryError
