cdef extern from "sparse/factor.h":
    ctypedef struct SparsePattern:
        int n
        int block
        int *order
        int *parent
        ptrdiff_t *start
        int *row
        ptrdiff_t *fill
    int c_sparse_analyse "sparse_analyse"(int n, ptrdiff_t m, const ptrdiff_t *rows, const ptrdiff_t *columns,
                                          int block, SparsePattern *pattern, ptrdiff_t *slot) nogil
    ptrdiff_t c_sparse_factor "sparse_factor"(const SparsePattern *pattern, const double *values, int *lower_row,
                                              double *lower, double *pivots) nogil
    void c_sparse_solve "sparse_solve"(const SparsePattern *pattern, const int *lower_row, const double *lower,
                                       const double *pivots, ptrdiff_t sides, double *x, double *scratch) nogil
    void c_sparse_multiply "sparse_multiply"(const SparsePattern *pattern, const double *values, ptrdiff_t sides,
                                             const double *x, double *product) nogil

cdef extern from "sparse/normal.h":
    ctypedef struct Dependence:
        ptrdiff_t n
        ptrdiff_t k
        int m
        int block
        const ptrdiff_t *unknowns
        const ptrdiff_t *places
    void c_normal_terms "normal_terms"(const Dependence *of, const double *derivatives, const double *weight,
                                       const double *slope, double *values, double *right, double *sums) nogil


cdef int *fills_whole(array, tuple shape) except NULL:
    return <int *>numbers(array, b"i", sizeof(int), shape, True)


cdef ptrdiff_t *fills_indices(array, tuple shape) except NULL:
    return <ptrdiff_t *>numbers(array, b"i", sizeof(ptrdiff_t), shape, True)


cdef int pattern_of(tuple arrays, SparsePattern *pattern) except -1:
    """Set `pattern` from what `sparse_analyse` returned: order, parent, start, row, fill, block."""
    order, parent, start, row, fill, block = arrays
    cdef ptrdiff_t n = len(order)
    pattern.n, pattern.block = <int>n, block
    if not 1 <= pattern.block <= 2:
        raise ValueError(f"blocks of {block} unknowns")
    pattern.order, pattern.parent = fills_whole(order, (n,)), fills_whole(parent, (n,))
    pattern.start, pattern.fill = fills_indices(start, (n + 1,)), fills_indices(fill, (n + 1,))
    pattern.row = fills_whole(row, row.shape)
    if len(row) < pattern.start[n]:
        raise ValueError("fewer rows than entries")
    return 0


def sparse_analyse(int n, rows, columns, int block):
    """Return the symbolic factorisation of a symmetric matrix of n rows, and the index (m,) of each distinct entry.

    A row has `block` unknowns, 1 or 2. Each off-diagonal entry is given in one triangle; entries with the same row and
    column are added.
    """
    cdef ptrdiff_t m = len(rows)
    cdef int failed
    if n < 0 or (m and not (0 <= min(rows.min(), columns.min()) and max(rows.max(), columns.max()) < n)):
        raise ValueError(f"entries outside of {n} rows")
    arrays = np.empty(n, np.intc), np.empty(n, np.intc), np.zeros(n + 1, np.intp), np.empty(m, np.intc), np.zeros(
        n + 1, np.intp), block
    slot = np.empty(m, np.intp)
    cdef SparsePattern pattern
    pattern_of(arrays, &pattern)
    cdef const ptrdiff_t *i = reads_indices(rows, (m,))
    cdef const ptrdiff_t *j = reads_indices(columns, (m,))
    cdef ptrdiff_t *to = fills_indices(slot, (m,))
    with nogil:
        failed = c_sparse_analyse(n, m, i, j, block, &pattern, to)
    if failed:
        raise MemoryError
    return arrays, slot


def sparse_factor(tuple pattern, values):
    """Return rows and values of L and the pivots, from `values` of distinct entries; and the row that failed, or -1."""
    cdef SparsePattern a
    cdef ptrdiff_t bad
    pattern_of(pattern, &a)
    cdef ptrdiff_t size = a.block * a.block
    factor = np.empty(a.fill[a.n], np.intc), np.empty(a.fill[a.n] * size), np.empty(a.n * size)
    cdef Read v = reads(values, (a.start[a.n] * size,))
    cdef int *rows = fills_whole(factor[0], factor[0].shape)
    cdef Written lower = fills(factor[1], factor[1].shape), pivots = fills(factor[2], factor[2].shape)
    with nogil:
        bad = c_sparse_factor(&a, v, rows, lower, pivots)
    if bad < 0:
        raise MemoryError
    return factor, a.order[bad - 1] if bad else -1


def sparse_solve(tuple pattern, tuple factor, x):
    """Solve for the right-hand sides `x` (n block, k), in place."""
    cdef SparsePattern a
    pattern_of(pattern, &a)
    cdef ptrdiff_t k = x.shape[1], entries = a.fill[a.n], size = a.block * a.block, n = <ptrdiff_t>a.n * a.block
    scratch = np.empty((n, k))
    cdef int *rows = fills_whole(factor[0], (entries,))
    cdef Read lower = reads(factor[1], (entries * size,)), pivots = reads(factor[2], (a.n * size,))
    cdef Written to = fills(x, (n, k)), room = fills(scratch, (n, k))
    with nogil:
        c_sparse_solve(&a, rows, lower, pivots, k, to, room)


def sparse_multiply(tuple pattern, values, x, product):
    """Fill `product` (n block, k) with the matrix, given by `values` of its distinct entries, times `x` (n block, k)."""
    cdef SparsePattern a
    pattern_of(pattern, &a)
    cdef ptrdiff_t k = x.shape[1], n = <ptrdiff_t>a.n * a.block
    cdef Read v = reads(values, (a.start[a.n] * a.block * a.block,))
    c_sparse_multiply(&a, v, k, reads(x, (n, k)), fills(product, (n, k)))


def normal_terms(unknowns, places, derivatives, weight, slope, values, right):
    """Add products of derivatives of k residuals to the entries `values`, and subtract sums from `right` (n, block).

    `unknowns` (k, m) are -1 for fixed values. `places` (p, k) is twice the entry of each pair, plus one if the first is
    eliminated before the second; it is -1 if one of the pair is fixed.
    """
    cdef ptrdiff_t k = len(unknowns), m = unknowns.shape[1], n = len(right), b = right.shape[1]
    if not 1 <= b <= 2 or m > 100:
        raise ValueError(f"blocks of {b} unknowns, {m} of a residual")
    sums = np.empty((n, b))
    cdef Dependence of
    of.n, of.k, of.m, of.block = n, k, <int>m, <int>b
    of.unknowns = reads_places(unknowns, (k, m), n, -1)
    of.places = reads_places(places, (m * (m + 1) // 2, k), 2 * (len(values) // (b * b)), -1)
    cdef Read d = reads(derivatives, (k, m, b)), w = reads(weight, (k,)), s = reads(slope, (k,))
    cdef Written v = fills(values, values.shape), r = fills(right, (n, b)), room = fills(sums, (n, b))
    with nogil:
        c_normal_terms(&of, d, w, s, v, r, room)
