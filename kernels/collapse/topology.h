/* Adjacency in a mesh of quads, and its blocks and chords.

   Half-edge 4 q + i runs from corner i of quad q, counter-clockwise, to the next; its twin is the same edge in the quad on
   the other side. A line of the mesh continues straight through a regular node:

            d                  h arrives at b; next(h) leaves b; its twin returns to b in the adjacent quad,
       q2   |   .              and the next half-edge of that continues straight from b to d.
     -------b-------
       q    |   .
            a  */
#pragma once
#include <stddef.h>

typedef struct {
    const ptrdiff_t *quads; /* (m, 4) nodes, counter-clockwise */
    ptrdiff_t m, n;         /* quads and nodes */
    ptrdiff_t *edge, *twin; /* (4 m) edge of each half-edge; its twin, -1 where there is no quad on the other side */
    ptrdiff_t *ends;        /* (4 m, 2) nodes of each edge, the lower first; edges ascend */
    ptrdiff_t edges;
    int manifold; /* whether no edge has more than two quads, nor two that see it the same way round */
} HalfEdges;

/* Fill edge, twin, ends, edges and manifold; `room` is of n + 1 + 4 m. */
void mesh_connect(HalfEdges *mesh, ptrdiff_t *room);

/* Label 0, 1, ... (n), by first appearance, the classes of numbers that `pairs` (k, 2) join; return how many. */
ptrdiff_t joined_classes(const ptrdiff_t *pairs, ptrdiff_t k, ptrdiff_t n, ptrdiff_t *label, ptrdiff_t *parent);

/* Mark (edges) the lines that start at nodes where `irregular` (n) is set, and one more through every ring; edges marked
   before bound blocks too. Label (m) the blocks of each quad. Return their count, -1 where some have not four corners.
   `room` is of 6 m. */
ptrdiff_t mesh_blocks(const HalfEdges *mesh, const unsigned char *irregular, unsigned char *marked, ptrdiff_t *label,
                      ptrdiff_t *room);

/* Write the nodes of each block as a lattice [i][j], one after another, of sizes (count, 2). Return how many numbers
   were written, -1 for a block that is no rectangle. `lattices` is of 4 m. */
ptrdiff_t mesh_lattices(const HalfEdges *mesh, const unsigned char *marked, const ptrdiff_t *label, ptrdiff_t count,
                        ptrdiff_t *sizes, ptrdiff_t *lattices, ptrdiff_t *room);

/* Label (edges) the chord of each edge: edges opposite in some quad. With `marked`, chords that run side by side through a
   block are one. Return how many there are; `room` is of 8 m. */
ptrdiff_t mesh_chords(const HalfEdges *mesh, const unsigned char *marked, ptrdiff_t *label, ptrdiff_t *room);
