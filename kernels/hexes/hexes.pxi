cdef extern from "energy/steps.h":
    void steps_forget(Steps *s) nogil

cdef extern from "hexes/energy.h":
    ctypedef struct HexBlock:
        int64_t n[3]
        int64_t places, cells, rows
    ctypedef struct HexWeights:
        double shape, smoothness, size, epsilon, cells
        int power
    ctypedef struct HexMesh:
        ptrdiff_t blocks, places, cells, widest
        const HexBlock *block
        const int32_t *node
        const double *inverse
        const uint8_t *skip
        const uint8_t *busy
        const float *target
        double *x
        double *g
        double *lengths
        double *pulls
        double *energies
        double *least

cdef extern from "hexes/spectrum.h":
    ctypedef struct Spectrum3:
        ptrdiff_t m[3]
        double over[3]
        int threads

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
        Spectrum3 spectrum
        Steps steps
    void hex_descent_sizes(const CHexDescent *d, size_t *doubles, size_t *floats) nogil
    void hex_descent_place(CHexDescent *d, double *doubles, float *floats) nogil
    void hex_descent_start(CHexDescent *d) nogil
    void hex_descent_renew(CHexDescent *d) nogil
    void hex_descent_end(CHexDescent *d) nogil
    double hex_descent_smallest(CHexDescent *d) nogil


cdef class HexDescent:
    """Minimisations of the functional over hexahedra that share nodes (``descent.h``); `nodes` (n, 3) are moved in place.

    `blocks` (b, 6) are those of ``energy.h``, over `tables`: node numbers of the blocks' nodes (P,) int32, desired edge
    lengths (3, P) float32, reciprocal cell lengths (3, C), bits of the corners left out (C,) and busy rows (R,).
    `places` are (free nodes, start, place, reciprocal step sizes) and `slides` (unknowns, projections). `over`, for one
    block of which all inner nodes move, are reciprocal lengths along its directions: it has a preconditioner of its
    own.
    """

    cdef CHexDescent state
    cdef object held

    def __init__(self, nodes, blocks, tuple tables, tuple places, tuple slides, double cells, int threads, over=None):
        cdef CHexDescent *d = &self.state
        cdef HexMesh *mesh = &d.mesh
        cdef ptrdiff_t b = len(blocks), count = len(places[0]), n = len(nodes), slid = len(slides[0]), k, at = 0, c = 0, r = 0
        cdef size_t doubles = 0, floats = 0
        node, target, inverse, skip, busy = tables
        mesh.blocks, mesh.places, mesh.cells, mesh.widest = b, len(node), len(skip), 0
        mesh.block = <const HexBlock *>numbers(blocks, b"i", 8, (b, 6), False)
        mesh.node = <const int32_t *>numbers(node, b"i", 4, (mesh.places,), False)
        mesh.target = reads_single(target, (3, mesh.places))
        mesh.inverse = reads(inverse, (3, mesh.cells))
        mesh.skip = <const uint8_t *>numbers(skip, b"B", 1, (mesh.cells,), False)
        mesh.busy = <const uint8_t *>numbers(busy, b"?", 1, busy.shape, False)
        for k in range(b):
            p = mesh.block[k].n
            if min(p[0], p[1], p[2]) < 4 or (mesh.block[k].places, mesh.block[k].cells, mesh.block[k].rows) != (at, c, r):
                raise ValueError("starts of blocks beyond their tables")
            at, c = at + p[0] * p[1] * p[2], c + (p[0] - 3) * (p[1] - 3) * (p[2] - 3)
            r, mesh.widest = r + (p[0] - 2) * (p[1] - 2), max(mesh.widest, p[2])
        if (at, c, r) != (mesh.places, mesh.cells, len(busy)):
            raise ValueError("starts of blocks of other tables")
        for k in range(at):
            if not -1 <= mesh.node[k] < n:
                raise ValueError("places of other nodes")
        d.threads, d.count, d.sliding_count, d.weights.cells = min(max(threads, 1), 64), count, slid, cells
        d.x = fills(nodes, (n, 3))
        d.free, d.start = reads_places(places[0], (count,), n), reads_starts(places[1], count, len(places[2]))
        for k in range(count):
            if d.start[k] == d.start[k + 1]:
                raise ValueError("nodes without places")
        d.place = <const int32_t *>numbers(places[2], b"i", 4, places[2].shape, False)
        for k in range(len(places[2])):
            if not 0 <= d.place[k] < at:
                raise ValueError("places of other forces")
        d.inverse_size = reads(places[3], (count,))
        d.sliding, d.projection = reads_places(slides[0], (slid,), count), reads(slides[1], (slid, 9))
        for k in range(3 if over is not None else 0):
            d.spectrum.m[k], d.spectrum.over[k] = mesh.block[0].n[k] - 4, over[k]
        if over is not None and (b != 1 or slid or d.spectrum.m[0] * d.spectrum.m[1] * d.spectrum.m[2] != count):
            raise ValueError("a preconditioner of another block")
        d.spectrum.threads = d.threads
        room = np.zeros((4, 3, at)), np.zeros((5, r))
        room[0][2] = np.nan  # lengths of edges that do not exist
        mesh.x = fills(room[0], room[0].shape)
        mesh.g, mesh.lengths, mesh.pulls = mesh.x + 3 * at, mesh.x + 6 * at, mesh.x + 9 * at
        mesh.least = fills(room[1], room[1].shape)
        mesh.energies = mesh.least + r
        room[1][0] = np.inf
        hex_descent_sizes(d, &doubles, &floats)
        work, small = np.empty(doubles), np.empty(floats, np.float32)
        hex_descent_place(d, fills(work, work.shape), fills_single(small))
        self.held = (nodes, blocks, tables, places, slides, room, work, small)

    def weigh(self, double shape, double smoothness, int power=2, double epsilon=0.0, double size=0.0):
        """Set the weights of the functional; its Jacobians are regularised with `epsilon`, for which `power` must be 1."""
        cdef HexWeights *w = &self.state.weights
        w.shape, w.smoothness, w.power, w.epsilon, w.size = shape, smoothness, power, epsilon, size
        if power < (1 if epsilon > 0.0 else 0) or power > (1 if epsilon > 0.0 else 2):
            raise ValueError("a functional of another power")

    def run(self, double gain, int most, int renewal, double still=float("inf"), double reach=0.25, double farthest=1.0):
        """Minimise; return (functional, smallest ratio of a Jacobian to the volume of its cell, iterations).

        It stops if two consecutive iterations each lower the functional by less than the fraction `gain` and move no
        node by more than `still` cells, or after `most` iterations. No node moves by more than `reach` cells in a first
        step, and by more than `farthest` in any. The preconditioner is updated every `renewal` iterations.
        """
        cdef int done = 0, state = GOES_ON
        cdef Steps *steps = &self.state.steps
        steps.reach, steps.farthest, steps.still, steps.gain = reach, farthest, still, gain
        with nogil:
            hex_descent_start(&self.state)
        while done < most and state == GOES_ON and steps.n > 0:
            PyErr_CheckSignals()
            with nogil:
                if done > 0 and done % renewal == 0:
                    hex_descent_renew(&self.state)
                    steps_forget(steps)
                state = steps_take(steps)
            done += 1
        with nogil:
            hex_descent_end(&self.state)
        return steps.value, steps.smallest, done

    def smallest(self):
        """Return the smallest Jacobian for the current nodes."""
        cdef double smallest
        with nogil:
            smallest = hex_descent_smallest(&self.state)
        return smallest

    def evaluate(self, gradient):
        """Return the functional and the smallest Jacobian at the current nodes; fill `gradient` (3, free nodes)."""
        cdef ptrdiff_t k
        cdef Written to = fills(gradient, (3, self.state.count))
        with nogil:
            hex_descent_start(&self.state)
        for k in range(self.state.steps.n):
            to[k] = self.state.steps.gradient[k]
        return self.state.steps.value, self.state.steps.smallest
