cdef extern from "quads/topology.h":
    int NEXT_EDGES
    ptrdiff_t c_line_neighbours "line_neighbours"(
        const ptrdiff_t *quads, const ptrdiff_t *edge_of, ptrdiff_t m, ptrdiff_t n, ptrdiff_t e, const ptrdiff_t *node,
        const ptrdiff_t *edge, ptrdiff_t *line, ptrdiff_t *room) nogil

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
        ptrdiff_t nodes, cells, edges, pairs, eased_count
        const ptrdiff_t *quads
        const ptrdiff_t *edge
        const ptrdiff_t *line
        const ptrdiff_t *eased
        const double *aspect
        const double *area
        const double *target
        const double *ease
        double shape, smoothness, epsilon, size

cdef extern from "quads/descent.h":
    ctypedef struct CQuadDescent "QuadDescent":
        QuadMesh mesh
        Walls walls
        ptrdiff_t free_count, tied_count
        const ptrdiff_t *free
        const ptrdiff_t *tied
        const ptrdiff_t *unknown
        const ptrdiff_t *wall
        double shift[2]
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
    """Return the neighbours (e, 4) of edges along grid lines and the number of pairs, as ``topology.h`` has them."""
    cdef ptrdiff_t m = len(quads), n = len(node), e = len(edge), pairs
    line, room = np.empty((e, NEXT_EDGES), np.intp), np.empty(2 * n + 1 + 4 * m + 2 * e, np.intp)
    if m and not (quads.max() < n and edge_of.max() < e):
        raise ValueError("quads of other nodes or edges")
    cdef const ptrdiff_t *q = reads_indices(quads, (m, 4))
    cdef const ptrdiff_t *s = reads_indices(edge_of, (m, 4))
    cdef const ptrdiff_t *v = reads_indices(node, (n,))
    cdef const ptrdiff_t *w = reads_indices(edge, (e,))
    cdef ptrdiff_t *to = fills_indices(line, (e, NEXT_EDGES))
    cdef ptrdiff_t *scratch = fills_indices(room, room.shape)
    with nogil:
        pairs = c_line_neighbours(q, s, m, n, e, v, w, to, scratch)
    return line, pairs


cdef class QuadDescent:
    """Descents of the functional over quads that share nodes, as ``descent.h`` has it; moves `nodes` (n, 2) and `arc` (w,).

    `cells` are (quads, aspects (m, 2), areas), `lines` (edges, neighbours, pairs, targets), `eased` (corners (k, 3),
    parts), the `inner` nodes that move freely, `tied` (pairs, shift), `unknown` and `wall` (n,), `wall_nodes` (nodes, unknowns, arc) sorted
    by loop, `wall_edges` (edges, round) likewise. Each of `loops` is (cubic, table, start, stop, pieces, end, turned)
    and the numbers of its first and last nodes and edges. Edges of walls may turn by `allowed`, beyond that with `bent`.
    """

    cdef CQuadDescent state
    cdef WallLoop *loop
    cdef object held

    def __init__(self, nodes, tuple cells, tuple lines, tuple eased, inner, tuple tied, unknown, wall,
                 tuple wall_nodes, tuple wall_edges, tuple loops, double bent, double allowed):
        cdef ptrdiff_t n = len(nodes), m = len(cells[0]), e = len(lines[0]), k = len(wall_nodes[0]), j
        cdef ptrdiff_t unknowns = 2 * len(inner) + np.count_nonzero(wall_nodes[1] >= 0)
        cdef QuadMesh *mesh = &self.state.mesh
        cdef Walls *walls = &self.state.walls
        self.state.x = fills(nodes, (n, 2))
        mesh.nodes, mesh.cells, mesh.edges, mesh.pairs, mesh.eased_count = n, m, e, lines[2], len(eased[0])
        mesh.quads, mesh.aspect = reads_indices(cells[0], (m, 4)), reads(cells[1], (m, 2))
        mesh.area, mesh.edge = reads(cells[2], (m,)), reads_indices(lines[0], (e, 2))
        mesh.line, mesh.target = reads_indices(lines[1], (e, NEXT_EDGES)), reads(lines[3], (e,))
        mesh.eased, mesh.ease = reads_indices(eased[0], (len(eased[0]), 3)), reads(eased[1], (len(eased[0]),))
        self.state.free_count, self.state.tied_count = len(inner), len(tied[0])
        self.state.free, self.state.tied = reads_indices(inner, inner.shape), reads_indices(tied[0], (len(tied[0]), 2))
        self.state.shift[0], self.state.shift[1] = tied[1]
        self.state.unknown, self.state.wall = reads_indices(unknown, (n,)), reads_indices(wall, (n,))
        walls.nodes, walls.loops = k, len(loops)
        walls.node, walls.unknown = reads_indices(wall_nodes[0], (k,)), reads_indices(wall_nodes[1], (k,))
        walls.arc = fills(wall_nodes[2], (k,))
        walls.edge = reads_indices(wall_edges[0], (len(wall_edges[0]), 2))
        walls.round = reads(wall_edges[1], (len(wall_edges[0]),))
        self.loop = <WallLoop *>calloc(max(1, len(loops)), sizeof(WallLoop))
        if self.loop == NULL:
            raise MemoryError
        walls.loop = self.loop
        for j, (cubic, table, start, stop, pieces, end, turned, first_node, last_node, first_edge, last_edge) in (
            enumerate(loops)
        ):
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
                     interval)

    def __dealloc__(self):
        quad_descent_free(&self.state)
        free(self.loop)

    def run(self, double shape, double smoothness, double epsilon, double size, double gain, int most, bint renew):
        """Descend; return (value, smallest Jacobian over the area of its cell, iterations).

        It ends when the value falls by less than its part `gain` in each of three iterations, or after `most`. The
        preconditioner is made anew where the nodes are with `renew`.
        """
        cdef int done = 0, state = GOES_ON, failed
        cdef QuadMesh *mesh = &self.state.mesh
        cdef Steps *steps = &self.state.steps
        mesh.shape, mesh.smoothness, mesh.epsilon, mesh.size = shape, smoothness, epsilon, size
        steps.reach, steps.farthest, steps.still, steps.gain = 0.125, 1.0, float("inf"), gain
        with nogil:
            failed = quad_descent_start(&self.state, renew)
        if failed:
            raise MemoryError
        while done < most and state == GOES_ON and steps.n > 0:
            PyErr_CheckSignals()
            with nogil:
                state = steps_take(steps)
            done += 1
        with nogil:
            quad_descent_end(&self.state)
        return steps.value, steps.smallest, done

    def evaluate(self, double shape, double smoothness, double epsilon, double size, gradient):
        """Return the value where the nodes are, and fill `gradient` (unknowns,)."""
        cdef QuadMesh *mesh = &self.state.mesh
        cdef ptrdiff_t k
        cdef Written to = fills(gradient, (self.state.steps.n,))
        mesh.shape, mesh.smoothness, mesh.epsilon, mesh.size = shape, smoothness, epsilon, size
        with nogil:
            quad_descent_start(&self.state, True)
        for k in range(self.state.steps.n):
            to[k] = self.state.steps.gradient[k]
        return self.state.steps.value
