cdef extern from "layers/layers.h":
    ctypedef struct Layers:
        double first, last
        ptrdiff_t constant
    double c_layer_steps "layer_steps"(double *steps, ptrdiff_t cells, double length, const Layers *layers,
                                       double *log_ratio) nogil
    double c_layer_lines "layer_lines"(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, double *X,
                                       double *Y, ptrdiff_t NJ, const Layers *layers, double *scratch) nogil
    void redistribute_lines(double *x, double *y, ptrdiff_t ni, ptrdiff_t nj, const double *first, const double *fade,
                            double *scratch) nogil


cdef Layers layers_of(ptrdiff_t cells, double first, double last, ptrdiff_t constant) except *:
    cdef Layers layers = Layers(first, last, constant)
    if not (first >= 0 and last >= 0 and first + last > 0 and constant >= 1):
        raise ValueError("no heights to make layers of")
    if cells < constant * ((first > 0) + (last > 0)) + 1:
        raise ValueError("fewer cells than constant layers")
    return layers


def layer_steps(steps, double length, double first, double last, ptrdiff_t constant):
    """Fill `steps` (cells,) so that they add up to `length`; return the largest ratio of neighbours.

    The first `constant` ones are `first` long and the last `last`, where these are not 0; the others grow by one
    ratio from each end. Infinite: nothing fits.
    """
    cdef ptrdiff_t cells = len(steps)
    cdef Layers layers = layers_of(cells, first, last, constant)
    cdef double log_ratio = 0.0
    return c_layer_steps(fills(steps, (cells,)), cells, length, &layers, &log_ratio)


def layer_lines(x, y, X, Y, double first, double last, ptrdiff_t constant, scratch):
    """Sample the lines i of `x`, `y` (ni, nj >= 3) anew at the NJ nodes of `X`, `Y` (ni, NJ >= 3).

    The distance between the first two nodes is `first` and between the last two `last`, where these are not 0.
    `scratch` has 10 nj + NJ doubles. Returns the largest ratio of neighbouring cells.
    """
    cdef double largest
    cdef ptrdiff_t ni, nj, NJ = X.shape[1]
    ni, nj = x.shape
    if nj < 3 or NJ < 3:
        raise ValueError("lines of fewer than 3 nodes")
    cdef Layers layers = layers_of(NJ - 1, first, last, constant)
    cdef const double *px = reads(x, (ni, nj))
    cdef const double *py = reads(y, (ni, nj))
    cdef double *to_x = fills(X, (ni, NJ))
    cdef double *to_y = fills(Y, (ni, NJ))
    cdef double *room = fills_room(scratch, 10 * nj + NJ)
    with nogil:
        largest = c_layer_lines(px, py, ni, nj, to_x, to_y, NJ, &layers, room)
    return largest


def redistribute(x, y, first, fade, scratch):
    """Move the inner nodes of the lines i of `x` and `y` (ni, nj >= 3) so that first cells are `first` (ni) high.

    `fade` (nj) says how much of the relative change of node 1 each node takes part in; `scratch` has 5 nj.
    """
    cdef ptrdiff_t ni, nj
    ni, nj = x.shape
    if nj < 3:
        raise ValueError("lines of fewer than 3 nodes")
    cdef double *px = fills(x, (ni, nj))
    cdef double *py = fills(y, (ni, nj))
    cdef const double *heights = reads(first, (ni,))
    cdef const double *share = reads(fade, (nj,))
    cdef double *room = fills_room(scratch, 5 * nj)
    with nogil:
        redistribute_lines(px, py, ni, nj, heights, share, room)
