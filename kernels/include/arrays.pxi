# Pointers to the numbers of arrays, once it is certain that there are as many as a kernel reads or writes.

from cpython.buffer cimport PyBUF_C_CONTIGUOUS, PyBUF_FORMAT, PyBUF_WRITABLE, PyBuffer_Release, PyObject_GetBuffer

ctypedef const double *Read
ctypedef double *Written


cdef void *numbers(array, char kind, ptrdiff_t size, shape, bint written) except NULL:
    """Return the address of a contiguous array of this shape. Its numbers must have this kind (a letter of the struct
    module, i for all integers) and `size` bytes. The caller must keep the array alive."""
    cdef Py_buffer view
    cdef char given
    PyObject_GetBuffer(array, &view, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT | (PyBUF_WRITABLE if written else 0))
    given = view.format[0]
    if given in b"lqn":
        given = b"i"
    cdef bint fits = given == kind and view.itemsize == size
    PyBuffer_Release(&view)  # the array stays where it is
    if not fits:
        raise ValueError(f"numbers of type {array.dtype}")
    if array.shape != shape:
        raise ValueError(f"an array of shape {array.shape} where {shape} is needed")
    return view.buf


cdef Read reads(array, tuple shape) except NULL:
    """Return the address of the doubles of an array that is read."""
    return <const double *>numbers(array, b"d", 8, shape, False)


cdef Written fills(array, tuple shape) except NULL:
    """Return the address of the doubles of an array that is written."""
    return <double *>numbers(array, b"d", 8, shape, True)


cdef const float *reads_single(array, tuple shape) except NULL:
    return <const float *>numbers(array, b"f", 4, shape, False)


cdef const ptrdiff_t *reads_indices(array, tuple shape) except NULL:
    return <const ptrdiff_t *>numbers(array, b"i", sizeof(ptrdiff_t), shape, False)


cdef const ptrdiff_t *reads_places(array, tuple shape, ptrdiff_t limit, ptrdiff_t least=0) except NULL:
    """Return the address of indices, after a check that all are from `least` to `limit` - 1."""
    cdef const ptrdiff_t *index = reads_indices(array, shape)
    cdef ptrdiff_t k, n = array.size
    for k in range(n):
        if index[k] < least or index[k] >= limit:
            raise ValueError(f"index {index[k]} out of range")
    return index


cdef const ptrdiff_t *reads_starts(array, ptrdiff_t count, ptrdiff_t end) except NULL:
    """Return the address of the starts of `count` pieces of a list and the end of the last, which is at most `end`."""
    cdef const ptrdiff_t *start = reads_places(array, (count + 1,), end + 1)
    cdef ptrdiff_t k
    for k in range(count):
        if start[k] > start[k + 1]:
            raise ValueError("pieces that end before they begin")
    return start


cdef Written fills_room(array, ptrdiff_t least) except NULL:
    """Return the address of a one-dimensional array of at least `least` doubles, used as scratch."""
    if len(array) < least:
        raise ValueError("too little scratch")
    return fills(array, array.shape)
