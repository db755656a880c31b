/* Descents of the functional over hexahedra: nodes that move do so freely, in planes or along lines. */
#pragma once
#include "energy.h"
#include "energy/steps.h"

/* Unknowns are the coordinates of `count` nodes, those of node `free[k]` of the table from 3 k on. Its forces are those
   at `place[start[k]]` to `place[start[k+1] - 1]` in the bricks. Of the `sliding_count` unknowns in `sliding`, nodes
   move only as `projection` (9 each) lets them. */
typedef struct {
    HexMesh mesh;
    HexWeights weights;
    int threads;
    ptrdiff_t count, sliding_count;
    const ptrdiff_t *free, *start, *sliding;
    const int32_t *place;
    const double *projection;
    const double *inverse_size;        /* (count,) of moves, 1 over that of the cells around */
    double *x;                         /* (nodes, 3) */
    double *here, *there, *stiffness;  /* unknowns twice; one a node */
    double *room;                                    /* of each thread */
    double *gathered, factor;                        /* what a team works on */
    Steps steps;
} HexDescent;

/* Doubles that a descent needs, and places in such room and in floats (steps.h); the rest is set before. */
size_t hex_descent_doubles(const HexDescent *d);
void hex_descent_place(HexDescent *d, double *doubles, float *floats);

/* Begin a descent at x; `hex_descent_renew` takes the stiffness where the nodes are and forgets earlier steps, and
   `hex_descent_end` leaves the best nodes in x. */
void hex_descent_start(HexDescent *d);
void hex_descent_renew(HexDescent *d);
void hex_descent_end(HexDescent *d);
