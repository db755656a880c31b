cdef extern from "collapse/topology.h":
    ctypedef struct HalfEdges:
        const ptrdiff_t *quads
        ptrdiff_t m, n, edges
        ptrdiff_t *edge
        ptrdiff_t *twin
        ptrdiff_t *ends
        int manifold
    void mesh_connect(HalfEdges *mesh, ptrdiff_t *room) nogil
    ptrdiff_t c_joined_classes "joined_classes"(const ptrdiff_t *pairs, ptrdiff_t k, ptrdiff_t n, ptrdiff_t *label,
                                  ptrdiff_t *parent) nogil
    ptrdiff_t mesh_blocks(const HalfEdges *mesh, const unsigned char *irregular, unsigned char *marked, ptrdiff_t *label,
                          ptrdiff_t *room) nogil
    ptrdiff_t mesh_lattices(const HalfEdges *mesh, const unsigned char *marked, const ptrdiff_t *label,
                            ptrdiff_t count, ptrdiff_t *sizes, ptrdiff_t *lattices,
                            ptrdiff_t *room) nogil
    ptrdiff_t mesh_chords(const HalfEdges *mesh, const unsigned char *marked, ptrdiff_t *label, ptrdiff_t *room) nogil


def connect_quads(quads, ptrdiff_t n):
    """Return edge and twin (m, 4) of each half-edge of quads of n nodes, the end nodes (e, 2) of the edges, and whether
    the mesh is manifold; see ``collapse/topology.h``."""
    cdef HalfEdges mesh
    cdef ptrdiff_t m = len(quads)
    edge, twin, ends = np.empty((m, 4), np.intp), np.empty((m, 4), np.intp), np.empty((4 * m, 2), np.intp)
    room = np.empty(n + 1 + 4 * m, np.intp)
    mesh.quads, mesh.m, mesh.n = reads_places(quads, (m, 4), n), m, n
    mesh.edge, mesh.twin, mesh.ends = fills_indices(edge, (m, 4)), fills_indices(twin, (m, 4)), fills_indices(ends, (4 * m, 2))
    cdef ptrdiff_t *scratch = fills_indices(room, (n + 1 + 4 * m,))
    with nogil:
        mesh_connect(&mesh, scratch)
    return edge, twin, ends[: mesh.edges].copy(), bool(mesh.manifold)


def joined_classes(pairs, ptrdiff_t n):
    """Return the class (n,) of each of n numbers, where `pairs` (k, 2) are in one class, and the number of classes."""
    cdef ptrdiff_t k = len(pairs), count
    label, parent = np.empty(n, np.intp), np.empty(n, np.intp)
    cdef const ptrdiff_t *joined = reads_places(pairs, (k, 2), n)
    cdef ptrdiff_t *to = fills_indices(label, (n,))
    cdef ptrdiff_t *room = fills_indices(parent, (n,))
    with nogil:
        count = c_joined_classes(joined, k, n, to, room)
    return label, count


def split_quads(quads, edge, twin, irregular, marked):
    """Return the node arrays of the blocks, the chord (e,) of each edge and the number of chords.

    None is returned if a block is not four-sided. `edge` and `twin` are those of `quads`. Block boundaries start at
    nodes where `irregular` (n,) is set and at edges where `marked` (e,) is; the edges of all block boundaries are added
    to `marked`.
    """
    cdef HalfEdges mesh
    cdef ptrdiff_t m = len(quads), count, written = -1, chords = 0, n = len(irregular), edges = len(marked)
    label, chord = np.empty(m, np.intp), np.empty(edges, np.intp)
    sizes, lattices, room = np.empty((m, 2), np.intp), np.empty(4 * m, np.intp), np.empty(8 * m, np.intp)
    mesh.quads, mesh.m, mesh.n, mesh.edges = reads_places(quads, (m, 4), n), m, n, edges
    mesh.edge = <ptrdiff_t *>reads_places(edge, (m, 4), edges)
    mesh.twin, mesh.ends = <ptrdiff_t *>reads_places(twin, (m, 4), 4 * m, -1), NULL
    cdef const unsigned char *begins = <const unsigned char *>numbers(irregular, b"?", 1, (n,), False)
    cdef unsigned char *mark = <unsigned char *>numbers(marked, b"?", 1, (edges,), True)
    cdef ptrdiff_t *block = fills_indices(label, (m,))
    cdef ptrdiff_t *size = fills_indices(sizes, (m, 2))
    cdef ptrdiff_t *lattice = fills_indices(lattices, (4 * m,))
    cdef ptrdiff_t *side = fills_indices(chord, (edges,))
    cdef ptrdiff_t *scratch = fills_indices(room, (8 * m,))
    with nogil:
        count = mesh_blocks(&mesh, begins, mark, block, scratch)
        if count >= 0:
            written = mesh_lattices(&mesh, mark, block, count, size, lattice, scratch)
            chords = mesh_chords(&mesh, mark, side, scratch)
    if written < 0:
        return None
    ends = np.cumsum(sizes[:count, 0] * sizes[:count, 1])[:-1]
    parts = [part.reshape(shape) for part, shape in zip(np.split(lattices[:written], ends), sizes[:count].tolist())]
    return parts, chord, chords
