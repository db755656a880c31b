/* The variational functional over quads that share nodes; see energy.c. */
#pragma once
#include <stddef.h>

/* What there is of a mesh, and room to evaluate. Edges, `line` and targets as in topology.h; `aspect` (m, 2) is a of each
   cell and 1 / a, `area` (m) that which cells are held to while folded, and what Jacobians are parts of. Corners in `eased` (k, 3) are a node and those
   before and behind it, and give away the part `ease` (k) of their angle term. */
typedef struct {
    ptrdiff_t nodes, cells, edges, pairs, eased_count, crossed_count;
    const ptrdiff_t *quads, *edge, *line, *eased, *crossed; /* crossed (k, 2): edges at irregular nodes, whose growth counts too */
    const double *aspect, *area, *target, *ease;
    double *length, *force; /* (edges,) */
    unsigned char *rests; /* of each batch of edges: whether its lengths and what they are compared with are fixed */
    double shape, smoothness, epsilon, size;
    double steep, limit; /* weight of growth along lines and the logarithm of the ratio from which on it counts */
} QuadMesh;

/* Return the functional at nodes x (n, 2), its gradient g (n, 2), and the smallest Jacobian as a part of its cell's
   area; infinite if that is not positive and nothing is regularised. */
double quad_energy(const QuadMesh *mesh, const double *x, double *g, double *smallest);

/* Find the batches of edges that rest, since no node moves, those of `unknown` (n) -1; and their lengths at x. */
size_t quad_batches(const QuadMesh *mesh);
void quad_rest(const QuadMesh *mesh, const double *x, const ptrdiff_t *unknown);
