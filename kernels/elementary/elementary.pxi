cdef extern from "elementary/functions.h":
    ctypedef void (*Function)(const double *x, ptrdiff_t n, double *out) noexcept nogil
    Function function_named(const char *name) nogil
    void function_angle(const double *y, const double *x, ptrdiff_t n, double *out) nogil
    void function_power(const double *x, const double *y, ptrdiff_t n, double *out) nogil
    void c_matrix_product "matrix_product"(const double *a, const double *b, ptrdiff_t rows, ptrdiff_t inner,
                                           ptrdiff_t columns, double *out) nogil
    int c_solve_system "solve_system"(double *matrix, ptrdiff_t n, double *right, ptrdiff_t columns) nogil

cdef extern from "Python.h":
    void *PyEval_SaveThread() noexcept
    void PyEval_RestoreThread(void *thread) noexcept

cdef ptrdiff_t SHORT = 1 << 12  # operations that are over sooner than another thread would wake up


cdef inline void *let_go(ptrdiff_t operations) noexcept:
    """Release the GIL until `take_back`, unless there are few `operations`; do not use Python meanwhile."""
    return PyEval_SaveThread() if operations > SHORT else NULL


cdef inline void take_back(void *thread) noexcept:
    if thread != NULL:
        PyEval_RestoreThread(thread)


def elementary(bytes name, x, out):
    """Fill `out` (n,) with the function `name` of `x` (n,)."""
    cdef Function function = function_named(name)
    cdef ptrdiff_t n = len(x)
    cdef Read px = reads(x, (n,))
    cdef Written to = fills(out, (n,))
    if function is NULL:
        raise ValueError("no function of this name")
    cdef void *thread = let_go(n)
    function(px, n, to)
    take_back(thread)


def angles_of(y, x, out):
    """Fill `out` (n,) with the angles atan2(`y`, `x`) of points with coordinates (n,)."""
    cdef ptrdiff_t n = len(x)
    cdef Read px = reads(x, (n,)), py = reads(y, (n,))
    cdef Written to = fills(out, (n,))
    cdef void *thread = let_go(n)
    function_angle(py, px, n, to)
    take_back(thread)


def powers_of(x, y, out):
    """Fill `out` (n,) with `x` to the power `y` (n,)."""
    cdef ptrdiff_t n = len(x)
    cdef Read px = reads(x, (n,)), py = reads(y, (n,))
    cdef Written to = fills(out, (n,))
    cdef void *thread = let_go(n)
    function_power(px, py, n, to)
    take_back(thread)


def matrix_product(a, b, out):
    """Fill `out` (rows, columns) with the product of `a` (rows, inner) and `b` (inner, columns)."""
    cdef ptrdiff_t rows, inner, columns = b.shape[1]
    rows, inner = a.shape
    cdef Read pa = reads(a, (rows, inner)), pb = reads(b, (inner, columns))
    cdef Written to = fills(out, (rows, columns))
    cdef void *thread = let_go(rows * inner * columns)
    c_matrix_product(pa, pb, rows, inner, columns, to)
    take_back(thread)


def solve_systems(matrices, right):
    """Solve systems with `matrices` (k, n, n), in place: `right` (k, n, columns) becomes the solutions.

    Return whether that was possible: no pivot is zero.
    """
    cdef ptrdiff_t count, n, columns = right.shape[2], k
    cdef int solved = 1
    count, n = matrices.shape[:2]
    cdef Written left = fills(matrices, (count, n, n)), to = fills(right, (count, n, columns))
    with nogil:
        for k in range(count):
            solved = solved and c_solve_system(&left[k * n * n], n, &to[k * n * columns], columns)
    return bool(solved)
