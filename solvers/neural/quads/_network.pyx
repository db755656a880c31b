"""Compiled layers of a convolutional network and its features.

See ``convolve.h``, ``winograd.h``, ``pointwise.h`` and ``look.h``.
"""

cdef extern from "network_kernel.h":
    ctypedef struct Convolution:
        Py_ssize_t batch
        Py_ssize_t m
        Py_ssize_t n
        Py_ssize_t inputs
        Py_ssize_t outputs
        int size
        int stride
    void network_convolve_float(const float *x, const Convolution *c, const float *w, const float *bias, const float *add, float *out) nogil
    void network_convolve_double(const double *x, const Convolution *c, const double *w, const double *bias, const double *add, double *out) nogil
    void network_winograd_float(const float *x, const Convolution *c, const float *w, const float *bias, const float *add, float *scratch, float *out) nogil
    void network_winograd_double(const double *x, const Convolution *c, const double *w, const double *bias, const double *add, double *scratch, double *out) nogil
    Py_ssize_t WINOGRAD_SCRATCH(Py_ssize_t inputs, Py_ssize_t wide, Py_ssize_t line) nogil
    int WINOGRAD_VALUES
    void network_activate_float(const float *x, Py_ssize_t batch, Py_ssize_t m, Py_ssize_t n, Py_ssize_t channels, int around, int pad, float *out) nogil
    void network_activate_double(const double *x, Py_ssize_t batch, Py_ssize_t m, Py_ssize_t n, Py_ssize_t channels, int around, int pad, double *out) nogil
    void network_refine_float(const float *x, Py_ssize_t batch, Py_ssize_t m, Py_ssize_t n, Py_ssize_t channels, int around, const float *add, float *out) nogil
    void network_refine_double(const double *x, Py_ssize_t batch, Py_ssize_t m, Py_ssize_t n, Py_ssize_t channels, int around, const double *add, double *out) nogil
    void network_look_float(const double *planes, const double *steps, Py_ssize_t batch, Py_ssize_t n, float *out) nogil
    void network_look_double(const double *planes, const double *steps, Py_ssize_t batch, Py_ssize_t n, double *out) nogil
    int LOOK_FEATURES
    int LOOK_MOST

ctypedef fused real:
    float
    double

cdef enum:
    CONVOLVE, WINOGRAD, ACTIVATE, REFINE
    MOST_STEPS = 256

cdef struct Step:
    int kind
    bint single
    bint around
    Convolution c
    const void *x
    const void *w
    const void *bias
    const void *add
    void *scratch
    void *out


cdef void take(const Step *s) noexcept nogil:
    """Compute a layer."""
    if s.kind == CONVOLVE and s.single:
        network_convolve_float(<float *>s.x, &s.c, <float *>s.w, <float *>s.bias, <float *>s.add, <float *>s.out)
    elif s.kind == CONVOLVE:
        network_convolve_double(<double *>s.x, &s.c, <double *>s.w, <double *>s.bias, <double *>s.add, <double *>s.out)
    elif s.kind == WINOGRAD and s.single:
        network_winograd_float(<float *>s.x, &s.c, <float *>s.w, <float *>s.bias, <float *>s.add, <float *>s.scratch, <float *>s.out)
    elif s.kind == WINOGRAD:
        network_winograd_double(<double *>s.x, &s.c, <double *>s.w, <double *>s.bias, <double *>s.add, <double *>s.scratch, <double *>s.out)
    elif s.kind == ACTIVATE and s.single:
        network_activate_float(<float *>s.x, s.c.batch, s.c.m, s.c.n, s.c.inputs, s.around, s.c.size, <float *>s.out)
    elif s.kind == ACTIVATE:
        network_activate_double(<double *>s.x, s.c.batch, s.c.m, s.c.n, s.c.inputs, s.around, s.c.size, <double *>s.out)
    elif s.single:
        network_refine_float(<float *>s.x, s.c.batch, s.c.m, s.c.n, s.c.inputs, s.around, <float *>s.add, <float *>s.out)
    else:
        network_refine_double(<double *>s.x, s.c.batch, s.c.m, s.c.n, s.c.inputs, s.around, <double *>s.add, <double *>s.out)


cdef class Program:
    """Layers on arrays of its own, one after another in one call that holds no lock."""

    cdef Step steps[MOST_STEPS]
    cdef int count
    cdef list held
    cdef tuple first, last

    def __cinit__(self):
        self.count, self.held = 0, []

    def run(self, x, out):
        """Fill `out` with the last layer's output for the first layer's input `x`, or the first few of a batch.

        Both are of the dtype and, but for the batch, of the shape that the layers were recorded with.
        """
        cdef const unsigned char[::1] raw_x
        cdef unsigned char[::1] raw_out
        if self.count == 0 or (x.dtype, *x.shape[1:]) != self.first or (out.dtype, *out.shape[1:]) != self.last:
            raise ValueError("arrays of other shapes than the layers'")
        cdef Py_ssize_t batch = len(x)
        if len(out) != batch or batch > self.steps[0].c.batch:
            raise ValueError("a batch of another size")
        if batch == 0:
            return
        raw_x, raw_out = x.reshape(-1).view("u1"), out.reshape(-1).view("u1")
        cdef Step step
        cdef int k
        with nogil:
            for k in range(self.count):
                step = self.steps[k]
                step.c.batch = batch
                if k == 0:
                    step.x = &raw_x[0]
                if k == self.count - 1:
                    step.out = &raw_out[0]
                take(&step)


cdef int done(Step *step, Program later, tuple arrays) except -1:
    """Take the step, or record it."""
    if later is None:
        if step.c.batch * step.c.m * step.c.n * step.c.inputs > 0:
            with nogil:
                take(step)
        return 0
    if later.count == MOST_STEPS:
        raise ValueError("too many layers")
    later.steps[later.count] = step[0]
    later.count += 1
    later.held.append(arrays)
    x, out = arrays[0].base, arrays[len(arrays) - 1].base
    if later.count == 1:
        later.first = (x.dtype, *x.shape[1:])
    later.last = (out.dtype, *out.shape[1:])
    return 0


cdef const void *begin(const real[:, :, :, ::1] x) noexcept:
    return NULL if x is None or x.shape[0] * x.shape[1] * x.shape[2] * x.shape[3] == 0 else &x[0, 0, 0, 0]


def convolve(const real[:, :, :, ::1] x, const real[:, ::1] w, const real[::1] bias, int size, int stride,
             const real[:, :, :, ::1] add, real[:, :, :, ::1] out, Program later=None):
    """Fill `out` (batch, p, q, outputs) with the convolution of `x` (batch, m, n, inputs), which holds its own padding.

    `w` is (size² inputs, outputs rounded up to 64 bytes), taps along xi slowest; `bias` has as many. `add`, of
    the shape of `out`, is added when it is not None. Like every layer it is recorded in the program `later` when
    there is one, instead.
    """
    cdef Step step
    cdef Py_ssize_t per = 64 // sizeof(real), p, q
    step.kind, step.single, step.around = CONVOLVE, real is float, False
    step.c.batch, step.c.m, step.c.n, step.c.inputs, step.c.outputs = x.shape[0], x.shape[1], x.shape[2], x.shape[3], out.shape[3]
    step.c.size, step.c.stride = size, stride
    if size < 1 or stride < 1 or x.shape[1] < size or x.shape[2] < size or out.shape[3] < 1 or x.shape[3] < 1:
        raise ValueError("images that are smaller than the kernel")
    p, q = (x.shape[1] - size) // stride + 1, (x.shape[2] - size) // stride + 1
    if out.shape[0] != x.shape[0] or out.shape[1] != p or out.shape[2] != q:
        raise ValueError("an output of another size")
    if w.shape[0] != size * size * x.shape[3] or w.shape[1] != (out.shape[3] + per - 1) // per * per or bias.shape[0] != w.shape[1]:
        raise ValueError("weights of other channels")
    if add is not None and not (add.shape[0] == x.shape[0] and add.shape[1] == p and add.shape[2] == q and add.shape[3] == out.shape[3]):
        raise ValueError("a summand of another shape")
    step.x, step.w, step.bias, step.add, step.out = begin(x), &w[0, 0], &bias[0], begin(add), <void *>begin(out)
    done(&step, later, (x, w, bias, add, out))


def winograd_scratch(Py_ssize_t inputs, Py_ssize_t wide, Py_ssize_t line):
    """Return how many numbers `winograd` needs as scratch, with `line` of them in 64 bytes."""
    return WINOGRAD_SCRATCH(inputs, wide, line)


def winograd(const real[:, :, :, ::1] x, const real[:, ::1] w, const real[::1] bias, const real[:, :, :, ::1] add,
             real[::1] scratch, real[:, :, :, ::1] out, Program later=None):
    """Do what `convolve` does with size 3 and stride 1, in fewer products.

    `w` is (25 inputs, outputs rounded up to 64 bytes), the kernels at pairs of the points; there are at least 16
    inputs and outputs, 5 x 5 pixels in `x` and `winograd_scratch` numbers in `scratch`.
    """
    cdef Step step
    cdef Py_ssize_t per = 64 // sizeof(real)
    step.kind, step.single, step.around = WINOGRAD, real is float, False
    step.c.batch, step.c.m, step.c.n, step.c.inputs, step.c.outputs = x.shape[0], x.shape[1], x.shape[2], x.shape[3], out.shape[3]
    step.c.size, step.c.stride = 3, 1
    if x.shape[1] < 5 or x.shape[2] < 5 or out.shape[3] < 16 or x.shape[3] < 16:
        raise ValueError("images or channels that are too few")
    if out.shape[0] != x.shape[0] or out.shape[1] != x.shape[1] - 2 or out.shape[2] != x.shape[2] - 2:
        raise ValueError("an output of another size")
    if w.shape[0] != WINOGRAD_VALUES * x.shape[3] or w.shape[1] != (out.shape[3] + per - 1) // per * per or bias.shape[0] != w.shape[1]:
        raise ValueError("weights of other channels")
    if add is not None and not (add.shape[0] == out.shape[0] and add.shape[1] == out.shape[1] and add.shape[2] == out.shape[2] and add.shape[3] == out.shape[3]):
        raise ValueError("a summand of another shape")
    if scratch.shape[0] < WINOGRAD_SCRATCH(x.shape[3], w.shape[1], per):
        raise ValueError("scratch that is too small")
    step.x, step.w, step.bias, step.add, step.out = begin(x), &w[0, 0], &bias[0], begin(add), <void *>begin(out)
    step.scratch = &scratch[0]
    done(&step, later, (x, w, bias, add, scratch, out))


def activate(const real[:, :, :, ::1] x, real[:, :, :, ::1] out, bint around=False, Program later=None):
    """Fill `out` (batch, m + 2, n + 2, channels) with x / (1 + exp(-x)) of `x` (batch, m, n, channels), zeros around.

    With `around` the first and the last of its m + 2 rows are the last and the first of the m. An `out` of the shape
    of `x` has nothing around.
    """
    cdef Step step
    cdef int pad = out.shape[1] > x.shape[1]
    step.kind, step.single, step.around = ACTIVATE, real is float, around
    step.c.batch, step.c.m, step.c.n, step.c.inputs = x.shape[0], x.shape[1], x.shape[2], x.shape[3]
    step.c.size = pad
    if out.shape[0] != x.shape[0] or out.shape[1] != x.shape[1] + 2 * pad or out.shape[2] != x.shape[2] + 2 * pad or out.shape[3] != x.shape[3]:
        raise ValueError("arrays of other shapes")
    step.x, step.out = begin(x), <void *>begin(out)
    done(&step, later, (x, out))


def refine(const real[:, :, :, ::1] x, const real[:, :, :, ::1] add, real[:, :, :, ::1] out, bint around=False,
           Program later=None):
    """Fill `out` (batch, 2 m - 1, 2 n - 1, channels) with `add` + `x` (batch, m, n, channels) linear between its nodes.

    With `around` it has 2 m rows, the last of them between the last and the first of `x`.
    """
    cdef Step step
    cdef Py_ssize_t rows = 2 * x.shape[1] if around else 2 * x.shape[1] - 1, columns = 2 * x.shape[2] - 1
    step.kind, step.single, step.around = REFINE, real is float, around
    step.c.batch, step.c.m, step.c.n, step.c.inputs = x.shape[0], x.shape[1], x.shape[2], x.shape[3]
    if out.shape[0] != x.shape[0] or out.shape[1] != rows or out.shape[2] != columns or out.shape[3] != x.shape[3]:
        raise ValueError("arrays of other shapes")
    if add.shape[0] != out.shape[0] or add.shape[1] != rows or add.shape[2] != columns or add.shape[3] != out.shape[3]:
        raise ValueError("a summand of another shape")
    step.x, step.add, step.out = begin(x), begin(add), <void *>begin(out)
    done(&step, later, (x, add, out))


def look(const double[:, :, :, ::1] planes, const double[:, :, :, ::1] steps, real[:, :, :, ::1] out):
    """Fill `out` (batch, n, n, features) for grids `planes` and their last `steps`, both (batch, 2, n, n)."""
    cdef Py_ssize_t batch = planes.shape[0], n = planes.shape[2]
    if planes.shape[1] != 2 or planes.shape[3] != n or n < 3 or n > LOOK_MOST:
        raise ValueError("grids that are not square, or too large")
    if steps.shape[0] != batch or steps.shape[1] != 2 or steps.shape[2] != n or steps.shape[3] != n:
        raise ValueError("steps of other grids")
    if out.shape[0] != batch or out.shape[1] != n or out.shape[2] != n or out.shape[3] != LOOK_FEATURES:
        raise ValueError("an output of another shape")
    if batch == 0:
        return
    with nogil:
        if real is float:
            network_look_float(&planes[0, 0, 0, 0], &steps[0, 0, 0, 0], batch, n, &out[0, 0, 0, 0])
        else:
            network_look_double(&planes[0, 0, 0, 0], &steps[0, 0, 0, 0], batch, n, &out[0, 0, 0, 0])
