cdef extern from "quads/topology.h":
    int NEXT_EDGES
    ptrdiff_t c_line_neighbours "line_neighbours"(
        const ptrdiff_t *quads, const ptrdiff_t *edge_of, ptrdiff_t m, ptrdiff_t n, ptrdiff_t e, const ptrdiff_t *node,
        const ptrdiff_t *edge, ptrdiff_t *line, ptrdiff_t *room) nogil
    int c_quad_images "quad_images"(const ptrdiff_t *twin, ptrdiff_t m, ptrdiff_t quad, ptrdiff_t image, ptrdiff_t corner,
                                    ptrdiff_t *images, ptrdiff_t *first, ptrdiff_t *room) nogil

cdef extern from "quads/corners.h":
    void c_smallest_corners "smallest_corners"(
        const double *nodes, const ptrdiff_t *quads, ptrdiff_t m, double *smallest) nogil

cdef extern from "quads/walls.h":
    ctypedef struct WallLoop:
        ArcLengths lengths
        const double *cubic
        const double *end
        const double *turned
        ptrdiff_t first_node, last_node, first_edge, last_edge
    ctypedef struct Walls:
        ptrdiff_t nodes, loops
        const WallLoop *loop
        const ptrdiff_t *node
        const ptrdiff_t *unknown
        const ptrdiff_t *edge
        const double *round
        double *arc
        ptrdiff_t *interval

cdef extern from "quads/energy.h":
    ctypedef struct QuadMesh:
        ptrdiff_t nodes, cells, edges, pairs, eased_count, crossed_count
        const ptrdiff_t *quads
        const ptrdiff_t *edge
        const ptrdiff_t *line
        const ptrdiff_t *eased
        const ptrdiff_t *crossed
        const double *aspect
        const double *area
        const double *target
        const double *ease
        double shape, smoothness, epsilon, size, steep, limit

cdef extern from "quads/descent.h":
    ctypedef struct CQuadDescent "QuadDescent":
        QuadMesh mesh
        Walls walls
        ptrdiff_t free_count, tied_count
        const ptrdiff_t *free
        const ptrdiff_t *tied
        const ptrdiff_t *unknown
        const ptrdiff_t *wall
        const double *shift
        double bent, allowed
        double *x
        Steps steps
    size_t steps_floats(ptrdiff_t n) nogil
    size_t quad_descent_doubles(const CQuadDescent *d, ptrdiff_t unknowns) nogil
    void quad_descent_place(CQuadDescent *d, ptrdiff_t unknowns, double *doubles, float *floats) nogil
    void quad_descent_free(CQuadDescent *d) nogil
    int quad_descent_start(CQuadDescent *d, int renew) nogil
    void quad_descent_end(CQuadDescent *d) nogil


def line_neighbours(quads, edge_of, node, edge):
    """Return the neighbours (e, 4) of edges along grid lines, and the number of pairs of neighbours; see ``topology.h``."""
    cdef ptrdiff_t m = len(quads), n = len(node), e = len(edge), pairs
    line, room = np.empty((e, NEXT_EDGES), np.intp), np.empty(2 * n + 1 + 4 * m + 2 * e, np.intp)
    cdef const ptrdiff_t *q = reads_places(quads, (m, 4), n)
    cdef const ptrdiff_t *s = reads_places(edge_of, (m, 4), e)
    cdef const ptrdiff_t *v = reads_places(node, (n,), n)
    cdef const ptrdiff_t *w = reads_places(edge, (e,), e)
    cdef ptrdiff_t *to = fills_indices(line, (e, NEXT_EDGES))
    cdef ptrdiff_t *scratch = fills_indices(room, room.shape)
    with nogil:
        pairs = c_line_neighbours(q, s, m, n, e, v, w, to, scratch)
    return line, pairs


def quad_images(twin, ptrdiff_t quad, ptrdiff_t image, ptrdiff_t corner):
    """Return images (m,) of quads in a mirror and their first corners (m,), or None; see ``topology.h``."""
    cdef ptrdiff_t m = len(twin)
    cdef bint fits
    if not (0 <= quad < m and 0 <= image < m and 0 <= corner < 4):
        raise ValueError("a quad or corner that there is not")
    images, first, room = np.empty(m, np.intp), np.empty(m, np.intp), np.empty(3 * m, np.intp)
    cdef const ptrdiff_t *t = reads_places(twin, (m, 4), 4 * m, -1)
    cdef ptrdiff_t *to = fills_indices(images, (m,))
    cdef ptrdiff_t *corners = fills_indices(first, (m,))
    cdef ptrdiff_t *scratch = fills_indices(room, (3 * m,))
    with nogil:
        fits = c_quad_images(t, m, quad, image, corner, to, corners, scratch)
    return (images, first) if fits else None


def smallest_corners(nodes, quads):
    """Return the smallest corner Jacobian (m,) of each of the quads (m, 4) of nodes (n, 2); see ``corners.h``."""
    cdef ptrdiff_t m = len(quads), n = len(nodes)
    smallest = np.empty(m)
    cdef const double *x = reads(nodes, (n, 2))
    cdef const ptrdiff_t *q = reads_places(quads, (m, 4), n)
    cdef double *to = fills(smallest, (m,))
    with nogil:
        c_smallest_corners(x, q, m, to)
    return smallest


cdef ptrdiff_t CELLS_UNHEARD = 1 << 20  # visits of cells between two looks at signals, for which other threads may have to wait


cdef class QuadDescent:
    """Minimisations of the functional over quads that share nodes (``descent.h``); moves `nodes` (n, 2) and `arc` (w,).

    `cells` are (quads, aspects (m, 2), areas), `lines` (edges, neighbours, pairs, targets), `eased` (corners (k, 3),
    parts). `inner` are the nodes that move freely, `tied` is (pairs, shifts (pairs, 2)); `unknown` and `wall` are (n,).
    `wall_nodes` (nodes, unknowns, arc) and `wall_edges` (edges, round) are sorted by loop. Each of `loops` is (cubic,
    table, start, stop, pieces, end, turned) and the numbers of its first and last nodes and edges. Wall edges may turn
    by `allowed`; `bent` weighs what exceeds it. Growth counts for the pairs of edges `crossed` (k, 2) as well.
    """

    cdef CQuadDescent state
    cdef WallLoop *loop
    cdef object held

    def __init__(self, nodes, tuple cells, tuple lines, tuple eased, inner, tuple tied, unknown, wall,
                 tuple wall_nodes, tuple wall_edges, tuple loops, double bent, double allowed, crossed):
        cdef ptrdiff_t n = len(nodes), m = len(cells[0]), e = len(lines[0]), k = len(wall_nodes[0]), j
        cdef ptrdiff_t corners = len(eased[0]), ties = len(tied[0]), sides = len(wall_edges[0])
        cdef ptrdiff_t unknowns = 2 * len(inner) + np.count_nonzero(wall_nodes[1] >= 0)
        cdef QuadMesh *mesh = &self.state.mesh
        cdef Walls *walls = &self.state.walls
        self.state.x = fills(nodes, (n, 2))
        mesh.nodes, mesh.cells, mesh.edges, mesh.pairs, mesh.eased_count = n, m, e, lines[2], corners
        mesh.quads, mesh.aspect = reads_places(cells[0], (m, 4), n), reads(cells[1], (m, 2))
        mesh.crossed_count, mesh.crossed = len(crossed), reads_places(crossed, (len(crossed), 2), e)
        mesh.area, mesh.edge = reads(cells[2], (m,)), reads_places(lines[0], (e, 2), n)
        mesh.line, mesh.target = reads_places(lines[1], (e, NEXT_EDGES), e), reads(lines[3], (e,))
        mesh.eased, mesh.ease = reads_places(eased[0], (corners, 3), n), reads(eased[1], (corners,))
        self.state.free_count, self.state.tied_count = len(inner), ties
        self.state.free, self.state.tied = reads_places(inner, inner.shape, n), reads_places(tied[0], (ties, 2), n)
        self.state.shift = reads(tied[1], (ties, 2))
        self.state.unknown, self.state.wall = reads_places(unknown, (n,), unknowns, -1), reads_places(wall, (n,), k, -1)
        for j in range(n):
            if self.state.wall[j] < 0 and self.state.unknown[j] == unknowns - 1 >= 0:
                raise ValueError("a free node of one unknown")
        walls.nodes, walls.loops = k, len(loops)
        walls.node, walls.unknown = reads_places(wall_nodes[0], (k,), n), reads_places(wall_nodes[1], (k,), unknowns, -1)
        walls.arc = fills(wall_nodes[2], (k,))
        walls.edge, walls.round = reads_places(wall_edges[0], (sides, 2), k), reads(wall_edges[1], (sides,))
        self.loop = <WallLoop *>calloc(max(1, len(loops)), sizeof(WallLoop))
        if self.loop == NULL:
            raise MemoryError
        walls.loop = self.loop
        for j, (cubic, table, start, stop, pieces, end, turned, first_node, last_node, first_edge, last_edge) in (
            enumerate(loops)
        ):
            if not (0 <= first_node <= last_node <= k and 0 <= first_edge <= last_edge <= sides):
                raise ValueError("loops of other nodes or edges")
            c = cubic.shape[1]
            self.loop[j].lengths = ArcLengths(
                reads(table, (c * pieces + 1,)), reads(start, (c * pieces,)), reads(stop, (c * pieces,)), c, pieces, 1)
            self.loop[j].cubic, self.loop[j].end = reads(cubic, (4, c, 2)), reads(end, (2,))
            self.loop[j].turned = reads(turned, (c + 1,))
            self.loop[j].first_node, self.loop[j].last_node = first_node, last_node
            self.loop[j].first_edge, self.loop[j].last_edge = first_edge, last_edge
        self.state.bent, self.state.allowed = bent, allowed
        room, small = np.empty(quad_descent_doubles(&self.state, unknowns)), np.empty(steps_floats(unknowns), np.float32)
        interval = np.empty(k, np.intp)
        walls.interval = fills_indices(interval, (k,))
        quad_descent_place(&self.state, unknowns, fills(room, room.shape), fills_single(small))
        self.held = (nodes, cells, lines, eased, inner, tied, unknown, wall, wall_nodes, wall_edges, loops, room, small,
                     interval, crossed)

    def __dealloc__(self):
        quad_descent_free(&self.state)
        free(self.loop)

    cdef int _start(self, bint renew) except -1:
        cdef int status
        with nogil:
            status = quad_descent_start(&self.state, renew)
        if status < 0:
            raise MemoryError
        if status > 0:
            raise ValueError("nodes that are not finite")
        return 0

    def run(self, double shape, double smoothness, double epsilon, double size, double gain, int most, bint renew, double steep=0.0, double limit=0.0):
        """Minimise; return (functional, smallest ratio of a Jacobian to the area of its cell, iterations).

        It stops if the functional falls by less than the fraction `gain` in each of two iterations, or after `most`.
        With `renew` the preconditioner is first updated to the current nodes. `steep` is the weight of ratios of
        neighbouring lengths whose logarithms exceed `limit`.
        """
        cdef int done = 0, state = GOES_ON, stop
        cdef QuadMesh *mesh = &self.state.mesh
        cdef Steps *steps = &self.state.steps
        cdef ptrdiff_t unheard = max(1, CELLS_UNHEARD // max(mesh.cells, 1))
        mesh.shape, mesh.smoothness, mesh.epsilon, mesh.size = shape, smoothness, epsilon, size
        mesh.steep, mesh.limit = steep, limit
        steps.reach, steps.farthest, steps.still, steps.gain = 0.125, 1.0, float("inf"), gain
        self._start(renew)
        while done < most and state == GOES_ON and steps.n > 0:
            PyErr_CheckSignals()
            stop = <int>min(most, done + unheard)
            with nogil:
                while done < stop and state == GOES_ON:
                    state = steps_take(steps)
                    done += 1
        with nogil:
            quad_descent_end(&self.state)
        return steps.value, steps.smallest, done

    def evaluate(self, double shape, double smoothness, double epsilon, double size, gradient,
                 double steep=0.0, double limit=0.0):
        """Return the functional at the current nodes, and fill `gradient` (unknowns,)."""
        cdef QuadMesh *mesh = &self.state.mesh
        cdef ptrdiff_t k
        cdef Written to = fills(gradient, (self.state.steps.n,))
        mesh.shape, mesh.smoothness, mesh.epsilon, mesh.size = shape, smoothness, epsilon, size
        mesh.steep, mesh.limit = steep, limit
        self._start(True)
        for k in range(self.state.steps.n):
            to[k] = self.state.steps.gradient[k]
        return self.state.steps.value
