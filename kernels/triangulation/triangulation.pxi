cdef extern from "triangulation/mesh.h":
    ctypedef struct Node "Node":
        int64_t x, y
    ctypedef struct Triangle "Triangle":
        int32_t corner[3]
        int32_t beside[3]
        unsigned char wall[3]
        unsigned char inside
    ctypedef struct Mesh "Mesh":
        ptrdiff_t n, m
        Node *node
        double *size
        int32_t *at
        Triangle *triangle
        int32_t last
    int BOX, SIDE_BITS, OUT_OF_MEMORY, SAME_PLACE
    int mesh_start(Mesh *mesh, ptrdiff_t nodes) nogil
    void mesh_free(Mesh *mesh) nogil
    int mesh_reserve(Mesh *mesh, ptrdiff_t nodes) nogil
    int32_t mesh_find(Mesh *mesh, Node p, int32_t start) nogil
    int mesh_insert(Mesh *mesh, int32_t v, int32_t t) nogil
    int mesh_flip_all(Mesh *mesh) nogil
    int32_t mesh_edge(const Mesh *mesh, int32_t a, int32_t b, int *edge) nogil
    int mesh_force(Mesh *mesh, int32_t a, int32_t b, int32_t *way) nogil
    int edge_to(const Triangle *u, int32_t t) nogil
    void mesh_walls(Mesh *mesh, const int32_t *pairs, ptrdiff_t count, int wall) nogil
    int mesh_inside(Mesh *mesh, const int32_t *pairs, ptrdiff_t count) nogil

cdef extern from "triangulation/refine.h":
    ctypedef struct Sizes "Sizes":
        double largest, growth
        ptrdiff_t n_sources
        const double *source
        const double *source_size
    int c_refine "refine"(Mesh *mesh, const Sizes *sizes, ptrdiff_t most) nogil
    int c_smooth "smooth"(Mesh *mesh, ptrdiff_t first, double part) nogil
    int c_shake "shake"(Mesh *mesh, ptrdiff_t first, double part, uint64_t seed) nogil

cdef extern from "triangulation/walls.h":
    ctypedef struct WallPoints:
        ptrdiff_t n
        const double *points
        const double *normals
        const double *corner
        const ptrdiff_t *piece
        const ptrdiff_t *beside
    int c_wall_gaps "wall_gaps"(const WallPoints *wall, double part, double cone, double *size) nogil
    int c_wall_growth "wall_growth"(const double *points, ptrdiff_t n, double growth, double *size) nogil


def wall_gaps(points, normals, piece, beside, corner, double part, double cone, size):
    """Reduce `size` (n,) to the fraction `part` of the gap in front of wall points (n, 2); see ``triangulation/walls.h``."""
    cdef WallPoints wall
    cdef ptrdiff_t n = len(points)
    wall.n, wall.points, wall.normals = n, reads(points, (n, 2)), reads(normals, (n, 2))
    wall.corner, wall.piece = reads(corner, (n, 2)), reads_indices(piece, (n,))
    wall.beside = reads_indices(beside, (n, 2))
    if c_wall_gaps(&wall, part, cone, fills(size, (n,))):
        raise MemoryError


def wall_growth(points, double growth, size):
    """Reduce `size` (n,) at points (n, 2) to the least of size + growth * distance over all points."""
    cdef ptrdiff_t n = len(points)
    if c_wall_growth(reads(points, (n, 2)), n, growth, fills(size, (n,))):
        raise MemoryError


cdef class DelaunayMesh:
    """Delaunay triangulation of points with integer coordinates from 1 to 2^30 - 2; see ``triangulation/mesh.h``."""

    cdef Mesh mesh

    def __cinit__(self):
        if mesh_start(&self.mesh, 1000):
            raise MemoryError

    def __dealloc__(self):
        mesh_free(&self.mesh)

    cdef const int32_t *_pairs(self, pairs) except NULL:
        """Return the address of pairs (n, 2) of nodes, numbered with the box corners, after a check that all exist."""
        cdef ptrdiff_t n = len(pairs), k
        cdef const int32_t *node = <const int32_t *>numbers(pairs, b"i", 4, (n, 2), False)
        for k in range(2 * n):
            if not BOX <= node[k] < self.mesh.n or self.mesh.at[node[k]] < 0:
                raise ValueError("no such node")
        return node

    def insert(self, places, sizes, order):
        """Insert nodes at `places` (n, 2) with `sizes` (n,), in the given `order` (n,); return which (n,) were new places.

        Node numbers start at 4, after the corners of the bounding box.
        """
        cdef ptrdiff_t n = len(places), k, v, first = self.mesh.n
        cdef const int64_t *xy = <const int64_t *>numbers(places, b"i", 8, (n, 2), False)
        cdef Read size = reads(sizes, (n,))
        cdef const ptrdiff_t *turn = reads_indices(order, (n,))
        cdef int64_t side = <int64_t>1 << SIDE_BITS
        cdef int32_t t
        cdef int status = 0
        new = np.ones(n, np.uint8)
        cdef unsigned char *is_new = <unsigned char *>numbers(new, b"B", 1, (n,), True)
        if mesh_reserve(&self.mesh, first + n):
            raise MemoryError
        for k in range(n):
            if not 0 <= turn[k] < n or not 0 < xy[2 * k] < side - 1 or not 0 < xy[2 * k + 1] < side - 1:
                raise ValueError("a place out of the box")
            self.mesh.at[first + k] = -1
        for k in range(n):
            v = first + turn[k]
            self.mesh.node[v].x, self.mesh.node[v].y = xy[2 * turn[k]], xy[2 * turn[k] + 1]
            self.mesh.size[v] = size[turn[k]]
            t = mesh_find(&self.mesh, self.mesh.node[v], self.mesh.last)
            status = mesh_insert(&self.mesh, <int32_t>v, t) if t >= 0 else SAME_PLACE
            if status == OUT_OF_MEMORY:
                raise MemoryError
            is_new[turn[k]] = status == 0
        self.mesh.n = first + n
        return new.view(bool)

    def are_edges(self, pairs):
        """Return which pairs (n, 2) of nodes are joined by an edge."""
        cdef ptrdiff_t n = len(pairs), k
        cdef const int32_t *pair = self._pairs(pairs)
        cdef int edge
        result = np.empty(n, np.uint8)
        for k in range(n):
            result[k] = mesh_edge(&self.mesh, pair[2 * k], pair[2 * k + 1], &edge) >= 0
        return result.view(bool)

    def force(self, pairs):
        """Flip edges until these pairs (n, 2) are edges, and mark them as walls.

        Return, for each pair, -1 on success, or the ends (n, 2) of a wall that blocks it, or twice a node that does.
        """
        cdef ptrdiff_t n = len(pairs), k
        cdef const int32_t *pair = self._pairs(pairs)
        way = np.full((n, 2), -1, np.int32)
        cdef int32_t *to = <int32_t *>numbers(way, b"i", 4, (n, 2), True)
        for k in range(n):
            mesh_force(&self.mesh, pair[2 * k], pair[2 * k + 1], to + 2 * k)
            mesh_walls(&self.mesh, pair + 2 * k, 1, 1)
        return way

    def set_walls(self, pairs, bint wall):
        """Mark the edges between pairs (n, 2) as walls, or unmark them; then flip the others until they are Delaunay."""
        mesh_walls(&self.mesh, self._pairs(pairs), len(pairs), wall)
        if mesh_flip_all(&self.mesh):
            raise MemoryError

    def refine(self, walls, double largest, double growth, sources, source_sizes, ptrdiff_t most):
        """Insert nodes left of the walls (n, 2) until circumradii are below 0.75 local sizes or `most` nodes exist."""
        cdef Sizes sizes
        cdef const int32_t *pair = self._pairs(walls)
        cdef ptrdiff_t n = len(walls)
        cdef int status
        sizes.largest, sizes.growth, sizes.n_sources = largest, growth, len(sources)
        sizes.source, sizes.source_size = reads(sources, (sizes.n_sources, 2)), reads(source_sizes, (sizes.n_sources,))
        with nogil:
            status = mesh_inside(&self.mesh, pair, n)
            if status == 0:
                status = c_refine(&self.mesh, &sizes, most)
        if status:
            raise MemoryError

    def smooth(self, ptrdiff_t first, double part):
        """Move the nodes from `first` on by the fraction `part` of the way to the mean of their neighbours."""
        if c_smooth(&self.mesh, max(first, BOX), part):
            raise MemoryError

    def shake(self, ptrdiff_t first, double part, uint64_t seed):
        """Move the nodes from `first` on at random, by up to the fraction `part` of their size."""
        if c_shake(&self.mesh, max(first, BOX), part, seed):
            raise MemoryError

    def nodes(self):
        """Return the places (n, 2) of the nodes, without the corners of the bounding box, and their sizes (n,)."""
        cdef ptrdiff_t k, n = self.mesh.n - BOX
        places, sizes = np.empty((n, 2), np.int64), np.empty(n)
        cdef int64_t *xy = <int64_t *>numbers(places, b"i", 8, (n, 2), True)
        cdef Written size = fills(sizes, (n,))
        for k in range(n):
            xy[2 * k], xy[2 * k + 1] = self.mesh.node[k + BOX].x, self.mesh.node[k + BOX].y
            size[k] = self.mesh.size[k + BOX]
        return places, sizes

    def triangles(self):
        """Return the inner triangles, (t, 3) each: corners, numbered without those of the box; neighbours at the edges
        i to i + 1 (-1: none); numbers of these edges in the neighbours."""
        cdef ptrdiff_t k, n = 0, m = self.mesh.m
        cdef int i, other
        cdef Triangle *t
        number = np.full(m, -1, np.intp)
        cdef ptrdiff_t *to = <ptrdiff_t *>numbers(number, b"i", sizeof(ptrdiff_t), (m,), True)
        for k in range(m):
            if self.mesh.triangle[k].inside:
                to[k] = n
                n += 1
        corners, beside, edges = (np.empty((n, 3), np.intp) for _ in range(3))
        cdef ptrdiff_t *c = <ptrdiff_t *>numbers(corners, b"i", sizeof(ptrdiff_t), (n, 3), True)
        cdef ptrdiff_t *b = <ptrdiff_t *>numbers(beside, b"i", sizeof(ptrdiff_t), (n, 3), True)
        cdef ptrdiff_t *e = <ptrdiff_t *>numbers(edges, b"i", sizeof(ptrdiff_t), (n, 3), True)
        n = 0
        for k in range(m):
            t = &self.mesh.triangle[k]
            if not t.inside:
                continue
            for i in range(3):
                c[n + i], b[n + i], e[n + i] = t.corner[i] - BOX, -1, -1
                other = t.beside[(i + 2) % 3]
                if other >= 0 and to[other] >= 0 and not t.wall[(i + 2) % 3]:
                    b[n + i] = to[other]
                    e[n + i] = (edge_to(&self.mesh.triangle[other], k) + 1) % 3
            n += 3
        return corners, beside, edges
