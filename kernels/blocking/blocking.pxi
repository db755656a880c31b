cdef extern from "blocking/surface.h":
    ctypedef struct Surface:
        ptrdiff_t triangles, vertices
        const ptrdiff_t *vertex
        const ptrdiff_t *neighbour
        const ptrdiff_t *across
    ptrdiff_t c_surface_fans "surface_fans"(const Surface *s, ptrdiff_t *start, ptrdiff_t *fan) nogil
    ptrdiff_t c_surface_comb "surface_comb"(const Surface *s, const ptrdiff_t *quarters, ptrdiff_t *turn,
                                            unsigned char *cut) nogil
    int c_surface_prune "surface_prune"(const Surface *s, const ptrdiff_t *start, const ptrdiff_t *fan,
                                        const unsigned char *keep, unsigned char *cut) nogil


cdef Surface surface_of(tuple arrays, ptrdiff_t vertices) except *:
    """Return pointers into arrays (t, 3): vertices of triangles, neighbours, and the edge's number in each neighbour."""
    vertex, neighbour, across = arrays
    cdef Surface s
    cdef tuple shape = (len(vertex), 3)
    s.triangles, s.vertices = len(vertex), vertices
    if s.triangles == 0:
        raise ValueError("no surface")
    s.vertex, s.neighbour = reads_places(vertex, shape, vertices), reads_places(neighbour, shape, s.triangles, -1)
    s.across = reads_places(across, shape, 3, -1)
    if ((neighbour >= 0) & (across < 0)).any():
        raise ValueError("triangles have three edges")
    return s


def surface_fans(tuple surface, ptrdiff_t vertices):
    """Return where the corners of each vertex start (vertices + 1,) in a list (3 t,), the list, and its used length."""
    cdef Surface s = surface_of(surface, vertices)
    start, fan = np.empty(vertices + 1, np.intp), np.empty(3 * s.triangles, np.intp)
    cdef ptrdiff_t *begins = fills_indices(start, (vertices + 1,))
    cdef ptrdiff_t *to = fills_indices(fan, (3 * s.triangles,))
    return start, fan, c_surface_fans(&s, begins, to)


def surface_comb(tuple surface, ptrdiff_t vertices, quarters):
    """Return quarter-turns (t,) with which frames agree along a spanning tree, and a mask (t, 3) of inner edges off it."""
    cdef Surface s = surface_of(surface, vertices)
    turn, cut = np.empty(s.triangles, np.intp), np.empty((s.triangles, 3), np.uint8)
    cdef unsigned char *cuts = <unsigned char *>numbers(cut, b"B", 1, (s.triangles, 3), True)
    cdef ptrdiff_t reached = c_surface_comb(&s, reads_indices(quarters, (s.triangles, 3)),
                                            fills_indices(turn, (s.triangles,)), cuts)
    if reached < 0:
        raise MemoryError
    if reached < s.triangles:
        raise ValueError("a surface in pieces")
    return turn, cut


def surface_prune(tuple surface, start, fan, keep, cut):
    """Remove from the mask `cut` (t, 3), in place, edges with a free end at a vertex outside the mask `keep`."""
    cdef Surface s = surface_of(surface, len(keep))
    cdef unsigned char *cuts = <unsigned char *>numbers(cut, b"B", 1, (s.triangles, 3), True)
    cdef const unsigned char *kept = <const unsigned char *>numbers(keep, b"B", 1, (s.vertices,), False)
    if (cut.astype(bool) & (surface[1] < 0)).any():
        raise ValueError("cuts along walls")
    cdef const ptrdiff_t *begins = reads_starts(start, s.vertices, 3 * s.triangles)
    if c_surface_prune(&s, begins, reads_places(fan, (3 * s.triangles,), 3 * s.triangles), kept, cuts):
        raise MemoryError
