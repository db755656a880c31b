/* Minimisation of the functional over hexahedra: free nodes move in space, in planes or along lines. */
#pragma once
#include "energy.h"
#include "energy/steps.h"
#include "spectrum.h"

/* Unknowns are x of the nodes `free[k]`, then y and z. The force on node k is the sum over the places `place[start[k]]` to
   `place[start[k+1] - 1]`; for the nodes `sliding` it is multiplied by `projection` (9 each). */
typedef struct {
    HexMesh mesh;
    HexWeights weights;
    int threads;
    ptrdiff_t count, sliding_count;
    const ptrdiff_t *free, *start, *sliding;
    const int32_t *place;
    const double *projection;
    const double *inverse_size;       /* (count,) of moves, 1 over that of the cells around */
    double *x;                        /* (nodes, 3) */
    double *here, *there, *stiffness; /* unknowns twice; one a node */
    double *room;                     /* of each thread */
    double *gathered, factor;         /* what a team works on */
    Spectrum3 spectrum;               /* of one block whose inner nodes all move freely; or of no nodes */
    Steps steps;
} HexDescent;

/* Doubles and floats that a descent needs, and their division; all else is set before. */
void hex_descent_sizes(const HexDescent *d, size_t *doubles, size_t *floats);
void hex_descent_place(HexDescent *d, double *doubles, float *floats);

/* Begin at x; make the preconditioner anew and forget earlier steps; store the best nodes in x. */
void hex_descent_start(HexDescent *d);
void hex_descent_renew(HexDescent *d);
void hex_descent_end(HexDescent *d);

/* The smallest Jacobian at x. */
double hex_descent_smallest(HexDescent *d);
