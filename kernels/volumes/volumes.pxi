cdef extern from "volumes/tfi.h":
    ctypedef struct Volume:
        ptrdiff_t n1, n2, n3, plane
    ctypedef struct Faces:
        Read west, east, south, north, bottom, top
    ctypedef struct Laws:
        Read xi, eta, zeta
    ctypedef struct Spline3:
        Read coefficients
        ptrdiff_t m1, m2, m3
        const ptrdiff_t *first[3]
        Read weights[3]
    int c_tfi_volume "tfi_volume"(double *nodes, const Volume *volume, const Faces *faces, const Laws *laws,
                                  const Spline3 *spline, int threads) nogil

def tfi_volume(nodes, tuple faces, tuple laws, int threads, spline=None):
    """Fill the planes `nodes` (3, n1, n2, n3) by transfinite interpolation between six faces.

    `faces`: west, east (3, n2, n3), south, north (3, n1, n3), bottom, top (3, n1, n2). `laws`: for each direction the
    node distributions (4, n), from 0 to 1, on its edges at the (low, low), (high, low), (low, high) and (high, high)
    ends of the other directions. `spline`, added to inner nodes: coefficients (3, m1, m2, m3); for each direction the
    first (n,) of the four that affect a node; then their weights, (n, 4) of the first two directions and (4, n) of the
    last.
    """
    cdef ptrdiff_t n1, n2, n3
    cdef Volume volume
    cdef Faces f
    cdef Laws l
    cdef Spline3 s
    cdef const Spline3 *added = NULL
    cdef int failed
    n1, n2, n3 = nodes.shape[1:]
    volume.n1, volume.n2, volume.n3, volume.plane = n1, n2, n3, n1 * n2 * n3
    cdef Written to = fills(nodes, (3, n1, n2, n3))
    f.west, f.east = reads(faces[0], (3, n2, n3)), reads(faces[1], (3, n2, n3))
    f.south, f.north = reads(faces[2], (3, n1, n3)), reads(faces[3], (3, n1, n3))
    f.bottom, f.top = reads(faces[4], (3, n1, n2)), reads(faces[5], (3, n1, n2))
    l.xi, l.eta, l.zeta = reads(laws[0], (4, n1)), reads(laws[1], (4, n2)), reads(laws[2], (4, n3))
    if spline is not None:
        coefficients, first, weights = spline
        s.m1, s.m2, s.m3 = coefficients.shape[1:]
        s.coefficients = reads(coefficients, (3, s.m1, s.m2, s.m3))
        s.first[0], s.first[1] = reads_places(first[0], (n1,), s.m1 - 3), reads_places(first[1], (n2,), s.m2 - 3)
        s.first[2] = reads_places(first[2], (n3,), s.m3 - 3)
        s.weights[0], s.weights[1] = reads(weights[0], (n1, 4)), reads(weights[1], (n2, 4))
        s.weights[2] = reads(weights[2], (4, n3))
        added = &s
    with nogil:
        failed = c_tfi_volume(to, &volume, &f, &l, added, threads)
    if failed:
        raise MemoryError


cdef extern from "volumes/winslow.h":
    ctypedef struct Winslow3:
        ptrdiff_t n1, n2, n3
        double *x
        const double *f
        int threads
    size_t c_winslow_room "winslow_room"(const Winslow3 *w) nogil
    void c_winslow_smooth "winslow_smooth"(const Winslow3 *w, double factor, double *room) nogil
    double c_winslow_residual "winslow_residual"(const Winslow3 *w, double *r, double *room) nogil
    void c_combine_along "combine_along"(const double *source, ptrdiff_t before, ptrdiff_t n, ptrdiff_t after,
                                         ptrdiff_t m, const ptrdiff_t *first, const double *weights, ptrdiff_t terms,
                                         int add, int threads, double *to) nogil


cdef Winslow3 winslow3(x, right, int threads) except *:
    cdef Winslow3 w
    w.n1, w.n2, w.n3 = x.shape[1:]
    if min(x.shape[1:]) < 3:
        raise ValueError("nodes without inner ones")
    w.x, w.f, w.threads = fills(x, (3, w.n1, w.n2, w.n3)), NULL, min(max(threads, 1), 64)
    if right is not None:
        w.f = reads(right, x.shape)
    return w


def winslow_room(tuple counts, int threads):
    """Return the number of doubles of scratch that relaxation of (n1, n2, n3) nodes needs."""
    cdef Winslow3 w
    w.n1, w.n2, w.n3 = counts
    w.threads = min(max(threads, 1), 64)
    return c_winslow_room(&w)


def winslow_smooth(x, right, double factor, int threads, room):
    """Relax the planes x (3, n1, n2, n3) by lines in three directions, in place; `right` is the right-hand side, or None."""
    cdef Winslow3 w = winslow3(x, right, threads)
    cdef Written work = fills_room(room, c_winslow_room(&w))
    with nogil:
        c_winslow_smooth(&w, factor, work)


def winslow_residual(x, right, residual, int threads, room):
    """Fill `residual` (3, n1, n2, n3) with `right` minus the operator at x; return the sum of its squares."""
    cdef Winslow3 w = winslow3(x, right, threads)
    cdef Written work = fills_room(room, c_winslow_room(&w)), r = fills(residual, x.shape)
    cdef double total
    with nogil:
        total = c_winslow_residual(&w, r, work)
    return total


def combine_along(source, int axis, first, weights, bint add, int threads, to):
    """Write to `to`, or `add`, along `axis`, the sum over k of weights (m, k) times `source` at index first (m,) + k."""
    cdef ptrdiff_t n = source.shape[axis], m = to.shape[axis], before = 1, after = 1, terms = weights.shape[1]
    for size in source.shape[:axis]:
        before *= size
    for size in source.shape[axis + 1:]:
        after *= size
    if to.shape != (*source.shape[:axis], m, *source.shape[axis + 1:]):
        raise ValueError("arrays of different shapes")
    cdef const ptrdiff_t *places = reads_places(first, (m,), n - terms + 1)
    cdef Read w = reads(weights, (m, terms)), values = reads(source, source.shape)
    cdef Written result = fills(to, to.shape)
    with nogil:
        c_combine_along(values, before, n, after, m, places, w, terms, add, threads, result)


cdef extern from "volumes/lines.h":
    int c_volume_lines "volume_lines"(double *nodes, ptrdiff_t before, ptrdiff_t n, ptrdiff_t after, const double *low,
                                        const double *high, double reach, int threads) nogil


def volume_lines(nodes, int axis, low, high, double reach, int threads):
    """Move nodes of planes (3, n1, n2, n3) along the grid lines of direction `axis`, in place.

    `low` and `high`, arrays without that direction, are the new lengths of the first and last steps, 0 where a line
    stays as it is at this end, or None. The relative change of a step decays as exp(-k / `reach`) with its distance k
    from the end.
    """
    cdef ptrdiff_t before = 1, after = 1, n = nodes.shape[axis + 1]
    cdef int failed
    cdef const double *first = NULL
    cdef const double *last = NULL
    for size in nodes.shape[1:axis + 1]:
        before *= size
    for size in nodes.shape[axis + 2:]:
        after *= size
    if n < 3:
        raise ValueError("lines without inner nodes")
    shape = (*nodes.shape[1:axis + 1], *nodes.shape[axis + 2:])
    cdef Written x = fills(nodes, (3, *nodes.shape[1:]))
    if low is not None:
        first = reads(low, shape)
    if high is not None:
        last = reads(high, shape)
    with nogil:
        failed = c_volume_lines(x, before, n, after, first, last, reach, threads)
    if failed:
        raise MemoryError


cdef extern from "volumes/near_faces.h":
    ctypedef struct Wall3:
        Read nodes
        ptrdiff_t n, m
        int axis, end
    ptrdiff_t c_closed_node "closed_node"(const Wall3 *walls, int count, const ptrdiff_t *first, const ptrdiff_t *last,
                                          int threads) nogil


def closed_node(tuple walls, tuple ranges, int threads):
    """Return the number of the first node in `ranges` that has no valid position next to `walls`, or -1.

    `walls`: at most three (nodes (n, m, 3), axis, end), across different axes; `ranges`: first and last (excluded)
    index of inner nodes along each direction.
    """
    cdef Wall3 faces[3]
    cdef ptrdiff_t first[3]
    cdef ptrdiff_t last[3]
    cdef ptrdiff_t found
    cdef int count = len(walls), k, e
    if not 1 <= count <= 3:
        raise ValueError("one to three walls")
    for k in range(3):
        first[k], last[k] = ranges[k]
    for k, (nodes, axis, end) in enumerate(walls):
        if not 0 <= axis < 3:
            raise ValueError("no such direction")
        faces[k].n, faces[k].m = nodes.shape[:2]
        faces[k].nodes, faces[k].axis, faces[k].end = reads(nodes, (faces[k].n, faces[k].m, 3)), axis, end
        sizes = [faces[k].n, faces[k].m]
        for e, size in zip([each for each in range(3) if each != axis], sizes):
            if first[e] < 1 or last[e] > size - 1:
                raise ValueError("a range beyond the inner nodes")
    with nogil:
        found = c_closed_node(faces, count, first, last, min(max(threads, 1), 64))
    return found
