# Complex numbers as the kernels have them.

cdef extern from "conformal/lift.h":
    ctypedef struct Cplx:
        double re
        double im


cdef Cplx pair(z):
    cdef Cplx c
    c.re, c.im = z.real, z.imag
    return c


cdef number(Cplx c):
    return complex(c.re, c.im)


cdef const Cplx *reads_complex(array, tuple shape) except NULL:
    return <const Cplx *>numbers(array, b"Z", 16, shape, False)
