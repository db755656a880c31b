/* A surface as a graph: nodes, their neighbours in the order around them, and ghosts beyond its open edges.

   Nodes are sorted such that no two of the first `red` ones are neighbours. A ghost belongs to one node, its owner, and
   depends on the owner and on a neighbour, its base:
       ghost = own x(owner) + sign x(base) + shift        (own 0, sign -1 or 1: mirrored in planes;
                                                           own > 0, sign < 0: extrapolated)
   Ghosts follow the nodes in every array of positions, sorted by owner. Each is read only by its owner, so that a thread
   computes the ghosts of its range of nodes before it works on them. */
#pragma once
#include "vectors.h"
#include <stddef.h>

#define MOST_NEIGHBOURS 24 /* of a node */

typedef struct {
    ptrdiff_t nodes, red, ghosts, odd, fixed;
    const ptrdiff_t *near;      /* (4, nodes): neighbours of nodes that have four, in order */
    const ptrdiff_t *odd_nodes; /* (odd): the other nodes, ascending */
    const ptrdiff_t *odd_start; /* (odd + 1): where their neighbours begin */
    const ptrdiff_t *odd_near;
    const ptrdiff_t *owner, *base; /* (ghosts) */
    const double *own;             /* (ghosts) */
    const double *sign, *shift;    /* (3, ghosts) */
    const ptrdiff_t *fixed_nodes;  /* (fixed): nodes that stay in planes, ascending */
    const double *boost;           /* (nodes): factor of the explicit smoothing */
    const double *hollow;          /* (nodes): distance from the next concave edge, not 0 */
    const double *moves;           /* (3, fixed): 0 where they do not move along an axis, else 1 */
} Graph;

/* First of `count` ascending numbers that is not less than `least`. */
static inline ptrdiff_t first_from(const ptrdiff_t *numbers, ptrdiff_t count, ptrdiff_t least)
{
    ptrdiff_t low = 0, high = count;
    while (low < high) {
        const ptrdiff_t middle = (low + high) / 2;
        if (numbers[middle] < least)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Fill the ghosts of nodes first .. last - 1 in values (3, nodes + ghosts); `still` leaves out the shift, for what is
   a difference of positions. */
static inline void fill_ghosts(const Graph *g, double *values, ptrdiff_t first, ptrdiff_t last, int still)
{
    const ptrdiff_t end = first_from(g->owner, g->ghosts, last), rows = g->nodes + g->ghosts;
    for (ptrdiff_t k = first_from(g->owner, g->ghosts, first); k < end; k++)
        for (int d = 0; d < 3; d++) {
            double *v = values + d * rows;
            v[g->nodes + k] = g->own[k] * v[g->owner[k]] + g->sign[d * g->ghosts + k] * v[g->base[k]] +
                              (still ? 0.0 : g->shift[d * g->ghosts + k]);
        }
}

/* The same for one number a node: a ghost has that of its base. */
static inline void fill_equal_ghosts(const Graph *g, double *values, ptrdiff_t first, ptrdiff_t last)
{
    const ptrdiff_t end = first_from(g->owner, g->ghosts, last);
    for (ptrdiff_t k = first_from(g->owner, g->ghosts, first); k < end; k++)
        values[g->nodes + k] = values[g->base[k]];
}

/* Stop nodes first .. last - 1 that stay in planes from leaving them: values (3, rows). */
static inline void hold_in_planes(const Graph *g, double *values, ptrdiff_t rows, ptrdiff_t first, ptrdiff_t last)
{
    const ptrdiff_t end = first_from(g->fixed_nodes, g->fixed, last);
    for (ptrdiff_t k = first_from(g->fixed_nodes, g->fixed, first); k < end; k++)
        for (int d = 0; d < 3; d++)
            values[d * rows + g->fixed_nodes[k]] *= g->moves[d * g->fixed + k];
}

MESHONET_INLINE Vector at(const double *values, ptrdiff_t rows, ptrdiff_t i)
{
    return (Vector){values[i], values[rows + i], values[2 * rows + i]};
}

MESHONET_INLINE void put(double *values, ptrdiff_t rows, ptrdiff_t i, Vector v)
{
    values[i] = v.x, values[rows + i] = v.y, values[2 * rows + i] = v.z;
}
