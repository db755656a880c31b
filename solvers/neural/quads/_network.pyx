"""Compiled layers of a convolutional network and its features; see ``convolve.h``, ``pointwise.h``, ``look.h``."""

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
    void network_activate_float(const float *x, Py_ssize_t batch, Py_ssize_t m, Py_ssize_t n, Py_ssize_t channels, int around, float *out) nogil
    void network_activate_double(const double *x, Py_ssize_t batch, Py_ssize_t m, Py_ssize_t n, Py_ssize_t channels, int around, double *out) nogil
    void network_refine_float(const float *x, Py_ssize_t batch, Py_ssize_t m, Py_ssize_t n, Py_ssize_t channels, int around, const float *add, float *out) nogil
    void network_refine_double(const double *x, Py_ssize_t batch, Py_ssize_t m, Py_ssize_t n, Py_ssize_t channels, int around, const double *add, double *out) nogil
    void network_look_float(const double *planes, Py_ssize_t batch, Py_ssize_t n, const double *middle, const double *factor, double *scratch, float *out) nogil
    void network_look_double(const double *planes, Py_ssize_t batch, Py_ssize_t n, const double *middle, const double *factor, double *scratch, double *out) nogil
    int LOOK_FEATURES
    int LOOK_MOST

ctypedef fused real:
    float
    double


def convolve(const real[:, :, :, ::1] x, const real[:, ::1] w, const real[::1] bias, int size, int stride,
             const real[:, :, :, ::1] add, real[:, :, :, ::1] out):
    """Fill `out` (batch, p, q, outputs) with the convolution of `x` (batch, m, n, inputs), which holds its own padding.

    `w` is (size² inputs, outputs rounded up to 64 bytes), taps along xi slowest; `bias` has as many. `add`, of
    the shape of `out`, is added when it is not None.
    """
    cdef Convolution c
    cdef Py_ssize_t per = 64 // sizeof(real), p, q
    c.batch, c.m, c.n, c.inputs, c.outputs = x.shape[0], x.shape[1], x.shape[2], x.shape[3], out.shape[3]
    c.size, c.stride = size, stride
    if size < 1 or stride < 1 or c.m < size or c.n < size or c.outputs < 1 or c.inputs < 1:
        raise ValueError("images that are smaller than the kernel")
    p, q = (c.m - size) // stride + 1, (c.n - size) // stride + 1
    if out.shape[0] != c.batch or out.shape[1] != p or out.shape[2] != q:
        raise ValueError("an output of another size")
    if w.shape[0] != size * size * c.inputs or w.shape[1] != (c.outputs + per - 1) // per * per or bias.shape[0] != w.shape[1]:
        raise ValueError("weights of other channels")
    if add is not None and not (add.shape[0] == c.batch and add.shape[1] == p and add.shape[2] == q and add.shape[3] == c.outputs):
        raise ValueError("a summand of another shape")
    if c.batch == 0:
        return
    cdef const real *more = NULL if add is None else &add[0, 0, 0, 0]
    with nogil:
        if real is float:
            network_convolve_float(&x[0, 0, 0, 0], &c, &w[0, 0], &bias[0], more, &out[0, 0, 0, 0])
        else:
            network_convolve_double(&x[0, 0, 0, 0], &c, &w[0, 0], &bias[0], more, &out[0, 0, 0, 0])


def winograd_scratch(Py_ssize_t inputs, Py_ssize_t wide, Py_ssize_t line):
    """Return how many numbers `winograd` needs as scratch, with `line` of them in 64 bytes."""
    return WINOGRAD_SCRATCH(inputs, wide, line)


def winograd(const real[:, :, :, ::1] x, const real[:, ::1] w, const real[::1] bias, const real[:, :, :, ::1] add,
             real[::1] scratch, real[:, :, :, ::1] out):
    """Do what `convolve` does with size 3 and stride 1, in fewer products.

    `w` is (25 inputs, outputs rounded up to 64 bytes), the kernels at pairs of the points; there are at least 16
    inputs and outputs, 5 x 5 pixels in `x` and `winograd_scratch` numbers in `scratch`.
    """
    cdef Convolution c
    cdef Py_ssize_t per = 64 // sizeof(real)
    c.batch, c.m, c.n, c.inputs, c.outputs = x.shape[0], x.shape[1], x.shape[2], x.shape[3], out.shape[3]
    c.size, c.stride = 3, 1
    if c.m < 5 or c.n < 5 or c.outputs < 16 or c.inputs < 16:
        raise ValueError("images or channels that are too few")
    if out.shape[0] != c.batch or out.shape[1] != c.m - 2 or out.shape[2] != c.n - 2:
        raise ValueError("an output of another size")
    if w.shape[0] != WINOGRAD_VALUES * c.inputs or w.shape[1] != (c.outputs + per - 1) // per * per or bias.shape[0] != w.shape[1]:
        raise ValueError("weights of other channels")
    if add is not None and not (add.shape[0] == c.batch and add.shape[1] == c.m - 2 and add.shape[2] == c.n - 2 and add.shape[3] == c.outputs):
        raise ValueError("a summand of another shape")
    if scratch.shape[0] < WINOGRAD_SCRATCH(c.inputs, w.shape[1], per):
        raise ValueError("scratch that is too small")
    if c.batch == 0:
        return
    cdef const real *more = NULL if add is None else &add[0, 0, 0, 0]
    with nogil:
        if real is float:
            network_winograd_float(&x[0, 0, 0, 0], &c, &w[0, 0], &bias[0], more, &scratch[0], &out[0, 0, 0, 0])
        else:
            network_winograd_double(&x[0, 0, 0, 0], &c, &w[0, 0], &bias[0], more, &scratch[0], &out[0, 0, 0, 0])


def activate(const real[:, :, :, ::1] x, real[:, :, :, ::1] out, bint around=False):
    """Fill `out` (batch, m + 2, n + 2, channels) with x / (1 + exp(-x)) of `x` (batch, m, n, channels), zeros around.

    With `around` the first and the last of its m + 2 rows are the last and the first of the m.
    """
    cdef Py_ssize_t batch = x.shape[0], m = x.shape[1], n = x.shape[2], channels = x.shape[3]
    if out.shape[0] != batch or out.shape[1] != m + 2 or out.shape[2] != n + 2 or out.shape[3] != channels:
        raise ValueError("arrays of other shapes")
    if batch * m * n * channels == 0:
        return
    with nogil:
        if real is float:
            network_activate_float(&x[0, 0, 0, 0], batch, m, n, channels, around, &out[0, 0, 0, 0])
        else:
            network_activate_double(&x[0, 0, 0, 0], batch, m, n, channels, around, &out[0, 0, 0, 0])


def refine(const real[:, :, :, ::1] x, const real[:, :, :, ::1] add, real[:, :, :, ::1] out, bint around=False):
    """Fill `out` (batch, 2 m - 1, 2 n - 1, channels) with `add` + `x` (batch, m, n, channels) linear between its nodes.

    With `around` it has 2 m rows, the last of them between the last and the first of `x`.
    """
    cdef Py_ssize_t batch = x.shape[0], m = x.shape[1], n = x.shape[2], channels = x.shape[3]
    cdef Py_ssize_t rows = 2 * m if around else 2 * m - 1, columns = 2 * n - 1
    if out.shape[0] != batch or out.shape[1] != rows or out.shape[2] != columns or out.shape[3] != channels:
        raise ValueError("arrays of other shapes")
    if add.shape[0] != batch or add.shape[1] != rows or add.shape[2] != columns or add.shape[3] != channels:
        raise ValueError("a summand of another shape")
    if batch * m * n * channels == 0:
        return
    with nogil:
        if real is float:
            network_refine_float(&x[0, 0, 0, 0], batch, m, n, channels, around, &add[0, 0, 0, 0], &out[0, 0, 0, 0])
        else:
            network_refine_double(&x[0, 0, 0, 0], batch, m, n, channels, around, &add[0, 0, 0, 0], &out[0, 0, 0, 0])


def look(const double[:, :, :, ::1] planes, const double[:, ::1] middle, const double[:, ::1] factor,
         double[:, :, ::1] scratch, real[:, :, :, ::1] out):
    """Fill `out` (batch, n, n, features) for grids `planes` (batch, 2, n, n) after z <- (z - middle) factor.

    `middle` and `factor` are (batch, 2), real and imaginary parts; `scratch` is (2, n, n).
    """
    cdef Py_ssize_t batch = planes.shape[0], n = planes.shape[2]
    if planes.shape[1] != 2 or planes.shape[3] != n or n < 3 or n > LOOK_MOST:
        raise ValueError("grids that are not square, or too large")
    if middle.shape[0] != batch or factor.shape[0] != batch or middle.shape[1] != 2 or factor.shape[1] != 2:
        raise ValueError("frames of other grids")
    if scratch.shape[0] != 2 or scratch.shape[1] != n or scratch.shape[2] != n:
        raise ValueError("scratch of another size")
    if out.shape[0] != batch or out.shape[1] != n or out.shape[2] != n or out.shape[3] != LOOK_FEATURES:
        raise ValueError("an output of another shape")
    if batch == 0:
        return
    with nogil:
        if real is float:
            network_look_float(&planes[0, 0, 0, 0], batch, n, &middle[0, 0], &factor[0, 0], &scratch[0, 0, 0], &out[0, 0, 0, 0])
        else:
            network_look_double(&planes[0, 0, 0, 0], batch, n, &middle[0, 0], &factor[0, 0], &scratch[0, 0, 0], &out[0, 0, 0, 0])
