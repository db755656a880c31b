cdef extern from "sparse/factor.h":
    ctypedef struct SparsePattern:
        int n
        int *order
        int *parent
        ptrdiff_t *start
        int *row
        ptrdiff_t *fill
    int c_sparse_analyse "sparse_analyse"(int n, ptrdiff_t m, const ptrdiff_t *rows, const ptrdiff_t *columns,
                                          SparsePattern *pattern, ptrdiff_t *slot) nogil
    ptrdiff_t c_sparse_factor "sparse_factor"(const SparsePattern *pattern, const double *values, int *lower_row,
                                              double *lower, double *pivots) nogil
    void c_sparse_solve "sparse_solve"(const SparsePattern *pattern, const int *lower_row, const double *lower,
                                       const double *pivots, ptrdiff_t sides, double *x, double *scratch) nogil
    void c_sparse_multiply "sparse_multiply"(const SparsePattern *pattern, const double *values, ptrdiff_t sides,
                                             const double *x, double *product) nogil


cdef int *fills_whole(array, tuple shape) except NULL:
    return <int *>numbers(array, b"i", sizeof(int), shape, True)


cdef ptrdiff_t *fills_indices(array, tuple shape) except NULL:
    return <ptrdiff_t *>numbers(array, b"i", sizeof(ptrdiff_t), shape, True)


cdef int pattern_of(tuple arrays, SparsePattern *pattern) except -1:
    """Point to the arrays that `sparse_analyse` returned: order, parent, start, row, fill."""
    order, parent, start, row, fill = arrays
    cdef ptrdiff_t n = len(order)
    pattern.n = <int>n
    pattern.order, pattern.parent = fills_whole(order, (n,)), fills_whole(parent, (n,))
    pattern.start, pattern.fill = fills_indices(start, (n + 1,)), fills_indices(fill, (n + 1,))
    pattern.row = fills_whole(row, row.shape)
    if len(row) < pattern.start[n]:
        raise ValueError("fewer rows than entries")
    return 0


def sparse_analyse(int n, rows, columns):
    """Return the symbolic factorisation of a symmetric matrix of n rows, and the index (m,) of each distinct entry.

    Each off-diagonal entry is given in one triangle; entries with the same row and column are added.
    """
    cdef ptrdiff_t m = len(rows)
    cdef int failed
    if n < 0 or (m and not (0 <= min(rows.min(), columns.min()) and max(rows.max(), columns.max()) < n)):
        raise ValueError(f"entries outside of {n} rows")
    arrays = np.empty(n, np.intc), np.empty(n, np.intc), np.zeros(n + 1, np.intp), np.empty(m, np.intc), np.zeros(
        n + 1, np.intp)
    slot = np.empty(m, np.intp)
    cdef SparsePattern pattern
    pattern_of(arrays, &pattern)
    cdef const ptrdiff_t *i = reads_indices(rows, (m,))
    cdef const ptrdiff_t *j = reads_indices(columns, (m,))
    cdef ptrdiff_t *to = fills_indices(slot, (m,))
    with nogil:
        failed = c_sparse_analyse(n, m, i, j, &pattern, to)
    if failed:
        raise MemoryError
    return arrays, slot


def sparse_factor(tuple pattern, values):
    """Return the rows and values of L, the pivots (n,), from `values` of the distinct entries; and the row that failed, or -1."""
    cdef SparsePattern a
    cdef ptrdiff_t bad
    pattern_of(pattern, &a)
    factor = np.empty(a.fill[a.n], np.intc), np.empty(a.fill[a.n]), np.empty(a.n)
    cdef Read v = reads(values, (a.start[a.n],))
    cdef int *rows = fills_whole(factor[0], factor[0].shape)
    cdef Written lower = fills(factor[1], factor[1].shape), pivots = fills(factor[2], factor[2].shape)
    with nogil:
        bad = c_sparse_factor(&a, v, rows, lower, pivots)
    if bad < 0:
        raise MemoryError
    return factor, a.order[bad - 1] if bad else -1


def sparse_solve(tuple pattern, tuple factor, x):
    """Solve for the right-hand sides `x` (n, k), in place."""
    cdef SparsePattern a
    pattern_of(pattern, &a)
    cdef ptrdiff_t k = x.shape[1], entries = a.fill[a.n]
    scratch = np.empty((a.n, k))
    cdef int *rows = fills_whole(factor[0], (entries,))
    cdef Read lower = reads(factor[1], (entries,)), pivots = reads(factor[2], (a.n,))
    cdef Written to = fills(x, (a.n, k)), room = fills(scratch, (a.n, k))
    with nogil:
        c_sparse_solve(&a, rows, lower, pivots, k, to, room)


def sparse_multiply(tuple pattern, values, x, product):
    """Fill `product` (n, k) with the matrix, given by `values` of its distinct entries, times `x` (n, k)."""
    cdef SparsePattern a
    pattern_of(pattern, &a)
    cdef ptrdiff_t k = x.shape[1]
    c_sparse_multiply(&a, reads(values, (a.start[a.n],)), k, reads(x, (a.n, k)), fills(product, (a.n, k)))
