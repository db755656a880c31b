cdef extern from "hexes/energy.h":
    int BRICK_I, BRICK_J, BRICK_K
    ctypedef struct Brick:
        int64_t count[3]
        int64_t nodes, cells, targets, forces
    ctypedef struct HexWeights:
        double shape, smoothness, epsilon, size, cells
    ctypedef struct HexMesh:
        ptrdiff_t bricks
        const Brick *brick
        const int32_t *node
        const uint8_t *moves
        const double *inverse
        const float *target
        double *force
        double *energy
        double *least

cdef extern from "hexes/descent.h":
    ctypedef struct CHexDescent "HexDescent":
        HexMesh mesh
        HexWeights weights
        int threads
        ptrdiff_t count, sliding_count
        const ptrdiff_t *free
        const ptrdiff_t *start
        const ptrdiff_t *sliding
        const int32_t *place
        const double *projection
        const double *inverse_size
        double *x
        Steps steps
    size_t hex_descent_doubles(const CHexDescent *d) nogil
    void hex_descent_place(CHexDescent *d, double *doubles, float *floats) nogil
    void hex_descent_start(CHexDescent *d) nogil
    void hex_descent_renew(CHexDescent *d) nogil
    void hex_descent_end(CHexDescent *d) nogil

BRICK = BRICK_I, BRICK_J, BRICK_K


cdef int check_brick(const Brick *brick, const HexMesh *mesh, ptrdiff_t nodes, ptrdiff_t *room) except -1:
    """Raise ValueError unless a brick is small enough, lies in the tables, of so many numbers each, and has such nodes."""
    cdef ptrdiff_t a = brick.count[0], b = brick.count[1], c = brick.count[2], i, j, k, least
    if not (1 <= a <= BRICK_I and 1 <= b <= BRICK_J and 1 <= c <= BRICK_K):
        raise ValueError("a brick of no cells, or too many")
    cdef ptrdiff_t edges = (a + 2) * (b + 1) * (c + 1) + (a + 1) * (b + 2) * (c + 1) + (a + 1) * (b + 1) * (c + 2)
    if (not 0 <= brick.nodes <= room[0] - (a + 3) * (b + 3) * (c + 3) or not 0 <= brick.cells <= room[1] - 3 * a * b * c
            or not 0 <= brick.targets <= room[2] - edges
            or not 0 <= brick.forces <= room[3] - 3 * (a + 1) * (b + 1) * (c + 1)):
        raise ValueError("a brick beyond its tables")
    cdef const int32_t *node = mesh.node + brick.nodes
    for i in range(a + 3):
        for j in range(b + 3):
            for k in range(c + 3):
                least = 0 if 0 < i < a + 2 and 0 < j < b + 2 and 0 < k < c + 2 else -1  # none beyond a side
                if not least <= node[0] < nodes:
                    raise ValueError("bricks of other nodes")
                node += 1
    return 0


cdef class HexDescent:
    """Descents of the functional over hexahedra that share nodes, as ``descent.h`` has it; moves `nodes` (n, 3).

    `bricks` (b, 8) are as ``energy.h`` has them, over the tables of `lattices` (node numbers, int32), of reciprocal
    lengths and of `targets` (float32). `places` are (free nodes, start, place, reciprocal sizes of moves) and `slides` (unknowns, projections).
    """

    cdef CHexDescent state
    cdef object held

    def __init__(self, nodes, bricks, lattices, moves, inverse, targets, tuple places, tuple slides, double cells,
                 int threads):
        cdef CHexDescent *d = &self.state
        cdef HexMesh *mesh = &d.mesh
        cdef ptrdiff_t b = len(bricks), count = len(places[0]), n = len(nodes), slid = len(slides[0]), k
        cdef ptrdiff_t[4] rooms = [len(lattices), len(inverse), len(targets), 3 * len(lattices) + 3]
        mesh.bricks = b
        mesh.brick = <const Brick *>numbers(bricks, b"i", 8, (b, 8), False)
        mesh.node = <const int32_t *>numbers(lattices, b"i", 4, (rooms[0],), False)
        mesh.moves = <const uint8_t *>numbers(moves, b"?", 1, (n,), False)
        mesh.inverse, mesh.target = reads(inverse, (rooms[1],)), reads_single(targets, (rooms[2],))
        for k in range(b):
            check_brick(mesh.brick + k, mesh, n, rooms)
        d.threads, d.count, d.sliding_count, d.weights.cells = threads, count, slid, cells
        d.x = fills(nodes, (n, 3))
        d.free, d.start = reads_places(places[0], (count,), n), reads_starts(places[1], count, len(places[2]))
        d.place = <const int32_t *>numbers(places[2], b"i", 4, places[2].shape, False)
        for k in range(len(places[2])):
            if not 0 <= d.place[k] <= rooms[0]:
                raise ValueError("places of other forces")
        d.inverse_size = reads(places[3], (count,))
        d.sliding, d.projection = reads_places(slides[0], (slid,), count), reads(slides[1], (slid, 9))
        force = np.empty(rooms[3])
        each = np.empty((2, max(b, 1)))
        mesh.force = fills(force, force.shape)
        mesh.energy = fills(each, each.shape)
        mesh.least = mesh.energy + max(b, 1)
        room, small = np.empty(hex_descent_doubles(d)), np.empty(steps_floats(3 * count), np.float32)
        hex_descent_place(d, fills(room, room.shape), fills_single(small))
        self.held = (nodes, bricks, lattices, moves, inverse, targets, places, slides, force, each, room, small)

    def weigh(self, double shape, double smoothness, double epsilon=0.0, double size=0.0):
        """Set the weights of the functional, of which Jacobians are regularised with `epsilon`."""
        cdef HexWeights *w = &self.state.weights
        w.shape, w.smoothness, w.epsilon, w.size = shape, smoothness, epsilon, size

    def run(self, double gain, int most, int renewal):
        """Descend; return (value, smallest Jacobian over the volume of its cell, iterations).

        It ends when the value falls by less than its part `gain` in each of two iterations, or after `most`. The
        preconditioner is made anew every `renewal` iterations.
        """
        cdef int done = 0, state = GOES_ON
        cdef Steps *steps = &self.state.steps
        steps.reach, steps.farthest, steps.still, steps.gain = 0.25, 1.0, float("inf"), gain
        with nogil:
            hex_descent_start(&self.state)
        while done < most and state == GOES_ON and steps.n > 0:
            PyErr_CheckSignals()
            with nogil:
                if done > 0 and done % renewal == 0:
                    hex_descent_renew(&self.state)
                state = steps_take(steps)
            done += 1
        with nogil:
            hex_descent_end(&self.state)
        return steps.value, steps.smallest, done

    def evaluate(self, gradient):
        """Return the value where the nodes are, and the smallest Jacobian; fill `gradient` (unknowns,)."""
        cdef ptrdiff_t k
        cdef Written to = fills(gradient, (self.state.steps.n,))
        with nogil:
            hex_descent_start(&self.state)
        for k in range(self.state.steps.n):
            to[k] = self.state.steps.gradient[k]
        return self.state.steps.value, self.state.steps.smallest
