"""Binding of columns_kernel.c: samples of Fourier sums at a power of two of equal steps."""


cdef extern from "columns_kernel.h":
    void strip_columns(const double *modes, Py_ssize_t m, Py_ssize_t highest, const double *gain,
                       const double *unit, double *columns, Py_ssize_t count, Py_ssize_t width) noexcept nogil

cdef extern from "lanes.h":
    int LANES


def sample(const double complex[:, ::1] modes, const double[::1] gain, const double complex[::1] unit,
           double[:, :, ::1] columns):
    """Add the sums' values to `columns` (count, 2, width), zeroed: real parts before imaginary ones.

    Parameters
    ----------
    modes : (m, 2 K + 1), k = 0 .. K, -K .. -1; m <= width, a multiple of the kernel's lanes.
    gain : (K + 1,) or more: what a mode is multiplied by.
    unit : (count / 2,) exp(2 pi i j / count), count a power of two above 2 K.
    """
    cdef Py_ssize_t count = columns.shape[0], width = columns.shape[2], m = modes.shape[0]
    cdef Py_ssize_t highest = modes.shape[1] // 2
    if columns.shape[1] != 2 or width % LANES or m > width or count & (count - 1) or count < 2:
        raise ValueError("columns do not fit")
    if modes.shape[1] != 2 * highest + 1 or 2 * highest >= count or gain.shape[0] <= highest:
        raise ValueError("modes do not fit")
    if unit.shape[0] != count // 2:
        raise ValueError("units do not fit")
    if m == 0:
        return
    with nogil:
        strip_columns(<const double *>&modes[0, 0], m, highest, &gain[0], <const double *>&unit[0],
                      &columns[0, 0, 0], count, width)
