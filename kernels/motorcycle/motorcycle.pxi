cdef extern from "motorcycle/lines.h":
    ctypedef struct MapPoint:
        double x, y
    ctypedef struct TriangleMap:
        ptrdiff_t triangles
        const MapPoint *coordinates
        const ptrdiff_t *neighbours
        const ptrdiff_t *edges
        const ptrdiff_t *turns

cdef extern from "motorcycle/trace.h":
    ctypedef struct RayLines:
        TriangleMap map
        const ptrdiff_t *node
        const ptrdiff_t *port
        ptrdiff_t nodes, ports
        double near
    ctypedef struct RayStart:
        ptrdiff_t node, port, face, corner, axis, batch
    ctypedef struct RayEnd:
        ptrdiff_t kind, other, place
        double along, length
    ctypedef struct RayPiece:
        ptrdiff_t ray, face, axis
        MapPoint start "from"
        MapPoint to
        double length
    void c_probe_rays "probe_rays"(const RayLines *lines, const RayStart *starts, ptrdiff_t rays, ptrdiff_t limit,
                                   ptrdiff_t *met) nogil
    ptrdiff_t c_trace_rays "trace_rays"(const RayLines *lines, const RayStart *starts, ptrdiff_t rays, ptrdiff_t limit,
                                        RayEnd *ends, RayPiece *pieces, ptrdiff_t room) nogil


cdef TriangleMap seamless(tuple tables) except *:
    """Return the map whose coordinates are (t, 3, 2) and whose tables are (t, 3)."""
    cdef TriangleMap found
    coordinates, neighbours, edges, turns = tables
    cdef ptrdiff_t t = len(coordinates)
    found.triangles = t
    found.coordinates = <const MapPoint *>reads(coordinates, (t, 3, 2))
    found.neighbours = reads_places(neighbours, (t, 3), t, -1)
    found.edges = reads_places(edges, (t, 3), 3, -1)
    found.turns = reads_indices(turns, (t, 3))
    if np.any((neighbours >= 0) & (edges < 0)):
        raise ValueError("neighbours across no edge")
    return found


cdef RayLines lines_of(tuple tables, node, port, ptrdiff_t nodes, ptrdiff_t ports, double near) except *:
    cdef RayLines lines
    lines.map = seamless(tables)
    lines.node = reads_places(node, (lines.map.triangles, 3), nodes, -1)
    lines.port = reads_places(port, (lines.map.triangles, 3, 4), ports, -1)
    lines.nodes, lines.ports, lines.near = nodes, ports, near
    return lines


cdef const ptrdiff_t *starts_of(starts, ptrdiff_t nodes, ptrdiff_t ports, ptrdiff_t triangles) except NULL:
    if np.any(starts < 0) or np.any(starts[:, :5] >= (nodes, ports, triangles, 3, 4)):
        raise ValueError("starts beyond the last")
    return reads_indices(starts, (len(starts), 6))


def probe_rays(tuple tables, node, port, ptrdiff_t nodes, ptrdiff_t ports, double near, starts, ptrdiff_t limit):
    """Return node and port (r, 2) that each of r rays meets, or -1; for the arguments see ``motorcycle/trace.h``."""
    cdef RayLines lines = lines_of(tables, node, port, nodes, ports, near)
    cdef const ptrdiff_t *rays = starts_of(starts, nodes, ports, lines.map.triangles)
    cdef ptrdiff_t count = len(starts)
    met = np.empty((count, 2), dtype=np.intp)
    cdef ptrdiff_t *to = <ptrdiff_t *>numbers(met, b"i", sizeof(ptrdiff_t), (count, 2), True)
    with nogil:
        c_probe_rays(&lines, <const RayStart *>rays, count, limit, to)
    return met


def trace_rays(tuple tables, node, port, ptrdiff_t nodes, ptrdiff_t ports, double near, starts, ptrdiff_t limit,
               ptrdiff_t room):
    """Return the ends of rays, (r, 3) and (r, 2), and their pieces, (p, 3) and (p, 5); see ``motorcycle/trace.h``.

    None is returned if there are more than `room` pieces.
    """
    cdef RayLines lines = lines_of(tables, node, port, nodes, ports, near)
    cdef const ptrdiff_t *rays = starts_of(starts, nodes, ports, lines.map.triangles)
    cdef ptrdiff_t count = len(starts), done, i
    cdef RayEnd *ends = <RayEnd *>malloc((count + 1) * sizeof(RayEnd))
    cdef RayPiece *pieces = <RayPiece *>malloc((room + 1) * sizeof(RayPiece))
    try:
        if ends == NULL or pieces == NULL:
            raise MemoryError
        with nogil:
            done = c_trace_rays(&lines, <const RayStart *>rays, count, limit, ends, pieces, room)
        if done == -2:
            raise MemoryError
        if done == -1:
            return None
        whole = np.empty((count, 3), dtype=np.intp), np.empty((done, 3), dtype=np.intp)
        real = np.empty((count, 2)), np.empty((done, 5))
        end_ints = <ptrdiff_t *>numbers(whole[0], b"i", sizeof(ptrdiff_t), (count, 3), True)
        piece_ints = <ptrdiff_t *>numbers(whole[1], b"i", sizeof(ptrdiff_t), (done, 3), True)
        end_reals, piece_reals = fills(real[0], (count, 2)), fills(real[1], (done, 5))
        for i in range(count):
            end_ints[3 * i], end_ints[3 * i + 1], end_ints[3 * i + 2] = ends[i].kind, ends[i].other, ends[i].place
            end_reals[2 * i], end_reals[2 * i + 1] = ends[i].along, ends[i].length
        for i in range(done):
            piece_ints[3 * i], piece_ints[3 * i + 1] = pieces[i].ray, pieces[i].face
            piece_ints[3 * i + 2] = pieces[i].axis
            piece_reals[5 * i], piece_reals[5 * i + 1] = pieces[i].start.x, pieces[i].start.y
            piece_reals[5 * i + 2], piece_reals[5 * i + 3] = pieces[i].to.x, pieces[i].to.y
            piece_reals[5 * i + 4] = pieces[i].length
    finally:
        free(ends)
        free(pieces)
    return whole[0], real[0], whole[1], real[1]
