/* Minimisation of the functional over quads: interior nodes move in the plane, wall nodes along their curves. */
#pragma once
#include "energy.h"
#include "energy/steps.h"
#include "sparse/factor.h"
#include "walls.h"

/* The preconditioner: the Laplacian of the graph of edges, for moves of all nodes, P^T (L x I) P, factored. Where no wall
   node slides, both coordinates have the same factor, of as many rows as there are nodes. */
typedef struct {
    SparsePattern pattern;
    ptrdiff_t sides; /* unknowns of each row */
    ptrdiff_t entries, *slot;
    double *values, *lower, *pivots, *right, *scratch;
    int *lower_row;
} Stiffness;

/* Unknowns are the coordinates of `free` (free_count) nodes, then arc lengths of wall nodes. Of each of `tied`
   (tied_count, 2) the first is where the second is, moved by `shift`. `unknown` (nodes) is the first unknown of a node,
   -1 for those that stay, `wall` (nodes) its number among wall nodes if it slides, or -1. */
typedef struct {
    QuadMesh mesh;
    Walls walls;
    ptrdiff_t free_count, tied_count;
    const ptrdiff_t *free, *tied, *unknown, *wall;
    const double *shift;
    double bent, allowed; /* weight of the turning of wall edges, beyond an angle */
    double *x, *g, *here, *there, *inverse_size; /* (nodes, 2) twice; unknowns twice; 1 / sizes of cells (unknowns) */
    Stiffness stiffness;
    Steps steps;
} QuadDescent;

/* Doubles that so many unknowns need, and places in such room and in floats (steps.h); the rest is set before. */
void quad_descent_place(QuadDescent *d, ptrdiff_t unknowns, double *doubles, float *floats);
size_t quad_descent_doubles(const QuadDescent *d, ptrdiff_t unknowns);

/* Begin a descent at x, with the preconditioner there is or a new one; returns -1 where memory ran out, 1 where the
   preconditioner is not positive, as nodes that are not finite make it.
   `quad_descent_end` leaves the best nodes in x. */
int quad_descent_start(QuadDescent *d, int renew);
void quad_descent_end(QuadDescent *d);
void quad_descent_free(QuadDescent *d);
