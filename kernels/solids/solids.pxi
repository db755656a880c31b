cdef extern from "solids/solids.h":
    int SOLID_METRICS
    ctypedef struct SolidNodes:
        const double *at[3]
        ptrdiff_t ni, nj, nk
    ctypedef struct SolidRun:
        SolidNodes nodes
        const double *volumes
        double *summary
        int64_t *where
        ptrdiff_t keep, n_kept
        double *kept
    void c_solids_folded "solids_folded"(const SolidNodes *nodes, int test, int threads, int64_t *counts) nogil
    void c_solids_places "solids_places"(const SolidNodes *nodes, int test, const int64_t *counts, int64_t *places) nogil
    void c_solids_volumes "solids_volumes"(const SolidNodes *nodes, int threads, double *volumes) nogil
    ptrdiff_t c_solids_chunks "solids_chunks"(const SolidNodes *nodes) nogil
    int c_solids_run "solids_run"(const SolidRun *run, int threads) nogil
    int c_solids_lines "solids_lines"(const SolidNodes *nodes, int threads, double *summary, int64_t *where,
                                         float *values) nogil


cdef SolidNodes solid_nodes(nodes) except *:
    """Return the coordinate planes of nodes (ni, nj, nk, 3), each of which must be contiguous."""
    cdef SolidNodes block
    block.ni, block.nj, block.nk = nodes.shape[:3]
    if nodes.shape[3:] != (3,) or block.ni < 2 or block.nj < 2 or block.nk < 2:
        raise ValueError(f"nodes of shape {nodes.shape}")
    for axis in range(3):
        block.at[axis] = reads(nodes[..., axis], nodes.shape[:3])
    return block


cdef int64_t *fills_long(array, tuple shape) except NULL:
    return <int64_t *>numbers(array, b"i", 8, shape, True)


def solids_folded(nodes, int test, int threads, counts):
    """Fill counts (ni-1, nj-1) with the cells of each row that fail `test`: 0 for corner, 1 for Bezier Jacobians."""
    cdef SolidNodes block = solid_nodes(nodes)
    cdef int64_t *to = fills_long(counts, (block.ni - 1, block.nj - 1))
    with nogil:
        c_solids_folded(&block, test, threads, to)


def solids_places(nodes, int test, counts, places):
    """Fill places (n, 3) with the indices of the cells that `solids_folded` counted."""
    cdef SolidNodes block = solid_nodes(nodes)
    cdef int64_t *of = fills_long(counts, (block.ni - 1, block.nj - 1))
    cdef int64_t *to = fills_long(places, (int(counts.sum()), 3))
    with nogil:
        c_solids_places(&block, test, of, to)


def solids_volumes(nodes, int threads, volumes):
    """Fill the interior of `volumes` (ni+1, nj+1, nk+1) with the volumes of the cells."""
    cdef SolidNodes block = solid_nodes(nodes)
    cdef Written to = fills(volumes, (block.ni + 1, block.nj + 1, block.nk + 1))
    with nogil:
        c_solids_volumes(&block, threads, to)


def solids_chunks(nodes):
    """Return the number of chunks in which `solids_run` processes a block."""
    cdef SolidNodes block = solid_nodes(nodes)
    return c_solids_chunks(&block)


def solids_run(nodes, volumes, summary, where, ptrdiff_t keep, kept, int threads):
    """Compute the metrics of all cells in one pass; for the arguments see SolidRun in ``solids/solids.h``."""
    cdef SolidRun run
    run.nodes = solid_nodes(nodes)
    cdef ptrdiff_t ni = run.nodes.ni, nj = run.nodes.nj, nk = run.nodes.nk, chunks = c_solids_chunks(&run.nodes)
    if not 0 <= keep <= SOLID_METRICS - len(kept):
        raise ValueError("metrics beyond the last")
    run.volumes = reads(volumes, (ni + 1, nj + 1, nk + 1))
    run.keep, run.n_kept = keep, len(kept)
    run.summary, run.where = fills(summary, (chunks, SOLID_METRICS, 3)), fills_long(where, (chunks, SOLID_METRICS, 2, 3))
    run.kept = fills(kept, (run.n_kept, ni - 1, nj - 1, nk - 1))
    cdef int done
    with nogil:
        done = c_solids_run(&run, threads)
    if not done:
        raise MemoryError


def solids_lines(nodes, int threads, summary, where, values=None):
    """Fill summary (ni, 3, 2, 2) and where (ni, 3, 2, 3) with growth and bend along each axis; see ``solids/solids.h``.

    `values` (3, 2, ni, nj, nk) receives those of every inner node of a line.
    """
    cdef SolidNodes block = solid_nodes(nodes)
    cdef Written to = fills(summary, (block.ni, 3, 2, 2))
    cdef int64_t *places = fills_long(where, (block.ni, 3, 2, 3))
    cdef int done
    cdef float *every = NULL if values is None else fills_single(values)
    if values is not None and values.shape != (3, 2, *nodes.shape[:3]):
        raise ValueError(f"an array of shape {values.shape}")
    with nogil:
        done = c_solids_lines(&block, threads, to, places, every)
    if not done:
        raise MemoryError
