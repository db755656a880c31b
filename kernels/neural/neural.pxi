cdef extern from "neural/approach.h":
    enum: APPROACH_LINE
    ctypedef struct Waves:
        ptrdiff_t count, line
        Read table, values
    ctypedef struct Approach:
        ptrdiff_t m, n
        int around, harmonic, steps
        double share, growth
        Waves xi, eta
    ptrdiff_t approach_scratch(const Approach *a) nogil
    void approach_grid(const Approach *a, double *p, const double *turn, double *scratch, double *step) nogil

cdef extern from "neural/network.h":
    enum: CONVOLVE, ACTIVATE, REFINE
    ctypedef struct Convolution:
        ptrdiff_t batch, m, n, inputs, outputs
        int size, stride
    ctypedef struct Layer:
        int kind, single, around
        Convolution c
        const void *x
        const void *w
        const void *bias
        const void *add
        void *out
    void network_layer(const Layer *layer) nogil
    void network_look_float(const double *planes, const double *steps, ptrdiff_t batch, ptrdiff_t n, float *out) nogil
    void network_look_double(const double *planes, const double *steps, ptrdiff_t batch, ptrdiff_t n,
                             double *out) nogil
    int LOOK_FEATURES
    int LOOK_MOST

cdef enum:
    MOST_LAYERS = 256

LINE = APPROACH_LINE
"""Numbers that lines of tables of waves are rounded up to a multiple of."""


cdef Waves waves(tuple tables, ptrdiff_t count) except *:
    """Return pointers into tables of `approach`."""
    cdef Waves w
    w.count, w.line = count, tables[0].shape[1]
    if w.line < count or w.line % APPROACH_LINE:
        raise ValueError("tables of a wrong shape")
    w.table, w.values = reads(tables[0], (count, w.line)), reads(tables[1], (w.line,))
    return w


def winslow_steps(planes, turns, bint harmonic, int steps, double share, double growth, tuple xi, tuple eta,
                  bint around, last):
    """Take Picard steps towards the Winslow grid: move the `planes` (batch, 2, m, n), fill `last` with the last steps.

    `turns` (batch, 2, n) are added from one round to the next; for the other arguments see ``neural/approach.h``.
    """
    cdef ptrdiff_t batch = len(planes), b
    cdef Approach a
    a.m, a.n, a.around, a.harmonic, a.steps = planes.shape[2], planes.shape[3], around, harmonic, steps
    a.share, a.growth = share, growth
    if a.m < 6 or a.n < 6:
        raise ValueError("planes that are too small")
    cdef Written p = fills(planes, (batch, 2, a.m, a.n)), step = fills(last, (batch, 2, a.m, a.n))
    cdef Read turn = reads(turns, (batch, 2, a.n))
    a.xi, a.eta = waves(xi, a.m - (1 if around else 2)), waves(eta, a.n - 2)
    scratch = np.zeros(approach_scratch(&a) + 8)
    cdef Written room = fills(scratch, scratch.shape)
    room += -(<uintptr_t>room // sizeof(double)) & 7  # aligned to a cache line
    with nogil:
        for b in range(batch):
            approach_grid(&a, p + 2 * b * a.m * a.n, turn + 2 * b * a.n, room, step + 2 * b * a.m * a.n)


cdef bint is_single(array):
    return array.dtype.itemsize == 4


cdef void *reads_real(array, bint single, shape) except NULL:
    """Return the numbers of an array of single or double precision."""
    return numbers(array, b"f" if single else b"d", 4 if single else 8, shape, False)


cdef void *fills_real(array, bint single, shape) except NULL:
    return numbers(array, b"f" if single else b"d", 4 if single else 8, shape, True)


cdef class LayerProgram:
    """A recorded sequence of layers with their own arrays, which is executed in one call without the GIL."""

    cdef Layer layers[MOST_LAYERS]
    cdef int count
    cdef list held
    cdef tuple first, last

    def __cinit__(self):
        self.count, self.held = 0, []

    def run(self, x, out):
        """Fill `out` with the last layer's output for the first layer's input `x`, or only the first samples of a batch.

        Both have the dtype and, except for the batch, the shape that the layers were recorded with.
        """
        if self.count == 0 or (x.dtype, *x.shape[1:]) != self.first or (out.dtype, *out.shape[1:]) != self.last:
            raise ValueError("arrays of other shapes than the layers'")
        cdef ptrdiff_t batch = len(x)
        if len(out) != batch or batch > self.layers[0].c.batch:
            raise ValueError("a batch of another size")
        if batch == 0:
            return
        cdef const void *begin = reads_real(x, is_single(x), x.shape)
        cdef void *end = fills_real(out, is_single(out), out.shape)
        cdef Layer layer
        cdef int k
        with nogil:
            for k in range(self.count):
                layer = self.layers[k]
                layer.c.batch = batch
                if k == 0:
                    layer.x = begin
                if k == self.count - 1:
                    layer.out = end
                network_layer(&layer)


cdef int take(Layer *layer, LayerProgram later, tuple arrays) except -1:
    """Compute a layer, or record it in `later`; the first of its arrays is the input, the last the output."""
    if later is None:
        if layer.c.batch * layer.c.m * layer.c.n * layer.c.inputs > 0:
            with nogil:
                network_layer(layer)
        return 0
    if later.count == MOST_LAYERS:
        raise ValueError("too many layers")
    later.layers[later.count] = layer[0]
    later.count += 1
    later.held.append(arrays)
    x, *_, out = arrays
    if later.count == 1:
        later.first = (x.dtype, *x.shape[1:])
    later.last = (out.dtype, *out.shape[1:])
    return 0


cdef int begin(Layer *layer, int kind, x, out, shape) except -1:
    """Set the input `x` (batch, m, n, inputs) and the output `out` (`shape`) of a layer without weights and summand."""
    layer.kind, layer.single, layer.around = kind, is_single(x), False
    layer.c.batch, layer.c.m, layer.c.n, layer.c.inputs = x.shape
    layer.c.outputs, layer.c.size, layer.c.stride = shape[3], 0, 1
    layer.x, layer.out = reads_real(x, layer.single, x.shape), fills_real(out, layer.single, shape)
    layer.w = layer.bias = layer.add = NULL
    return 0


def convolve(x, w, bias, int size, int stride, add, out, LayerProgram later=None):
    """Fill `out` (batch, p, q, outputs) with the convolution of `x` (batch, m, n, inputs), which includes its padding.

    If the program `later` is given, the layer is recorded in it and not executed; so is every layer of ``network.h``.
    """
    cdef Layer layer
    if size < 1 or stride < 1 or x.shape[1] < size or x.shape[2] < size or out.shape[3] < 1 or x.shape[3] < 1:
        raise ValueError("images that are smaller than the kernel")
    shape = (x.shape[0], (x.shape[1] - size) // stride + 1, (x.shape[2] - size) // stride + 1, out.shape[3])
    begin(&layer, CONVOLVE, x, out, shape)
    layer.c.size, layer.c.stride = size, stride
    per = 16 if layer.single else 8
    wide = (out.shape[3] + per - 1) // per * per
    layer.w = reads_real(w, layer.single, (size * size * layer.c.inputs, wide))
    layer.bias = reads_real(bias, layer.single, (wide,))
    if add is not None:
        layer.add = reads_real(add, layer.single, shape)
    take(&layer, later, (x, w, bias, add, out))


def activate(x, out, bint around=False, LayerProgram later=None):
    """Fill `out` (batch, m + 2, n + 2, channels) with x / (1 + exp(-x)) of `x` (batch, m, n, channels), padded by zeros.

    With `around` the rows are periodic: the first of the m + 2 rows repeats the last of the m, the last the first. An
    `out` with the shape of `x` is not padded.
    """
    cdef Layer layer
    cdef int pad = out.shape[1] > x.shape[1]
    begin(&layer, ACTIVATE, x, out, (x.shape[0], x.shape[1] + 2 * pad, x.shape[2] + 2 * pad, x.shape[3]))
    layer.c.size, layer.around = pad, around
    take(&layer, later, (x, out))


def upsample(x, add, out, bint around=False, LayerProgram later=None):
    """Fill `out` (batch, 2 m - 1, 2 n - 1, channels) with `add` + `x` (batch, m, n, channels), interpolated linearly.

    With `around` the rows are periodic: there are 2 m, the last of which is between the last and the first of `x`.
    """
    cdef Layer layer
    shape = (x.shape[0], 2 * x.shape[1] - (0 if around else 1), 2 * x.shape[2] - 1, x.shape[3])
    begin(&layer, REFINE, x, out, shape)
    layer.around, layer.add = around, reads_real(add, layer.single, shape)
    take(&layer, later, (x, add, out))


def grid_features(planes, steps, out):
    """Fill the network inputs `out` (batch, n, n, features) from grids `planes` and last `steps`, both (batch, 2, n, n)."""
    cdef ptrdiff_t batch = len(planes), n = planes.shape[2]
    cdef bint single = is_single(out)
    cdef Read p = reads(planes, (batch, 2, n, n)), s = reads(steps, (batch, 2, n, n))
    cdef void *to = fills_real(out, single, (batch, n, n, LOOK_FEATURES))
    if n < 3 or n > LOOK_MOST:
        raise ValueError("grids that are too small or too large")
    with nogil:
        if single:
            network_look_float(p, s, batch, n, <float *>to)
        else:
            network_look_double(p, s, batch, n, <double *>to)
