/* The variational functional over hexahedra in blocks that share nodes; see energy.c. */
#pragma once
#include "team.h"
#include <stddef.h>
#include <stdint.h>

enum { SHAPES = 0 }; /* the power that stands for the energy of shapes: see corner3.h */

/* A block: a lattice of n places, its nodes and those one step across connected sides; and the first of its places, of its
   cells (n[0] - 3, ...) and of its rows of cells in the tables. */
typedef struct {
    int64_t n[3], places, cells, rows;
} HexBlock;

/* Weights of the functional, `cells` is N. */
typedef struct {
    double shape, smoothness, size; /* w, β and t */
    double epsilon;                 /* of regularised Jacobians; 0: the barrier */
    double cells;
    int power; /* p, 1 or 2, 1 if regularised; or SHAPES, with w 1 and without β and ε */
} HexWeights;

/* Tables of the P places and the C cells of all blocks. */
typedef struct {
    ptrdiff_t blocks, places, cells, widest; /* how many; the longest row of places */
    const HexBlock *block;
    const int32_t *node;      /* of each place, or -1 */
    const double *inverse;    /* (3, C) one over the target lengths of cells */
    const uint8_t *skip;      /* (C,) bits of corners that do not count, 2^(4 di + 2 dj + dk) */
    const uint8_t *busy;      /* of each row of cells, whether a corner of it counts */
    const float *target;      /* (3, P) logarithms of the target lengths of edges from a place; NaN: no edge */
    double *x, *g;            /* (3, P) coordinates and forces */
    double *lengths, *pulls;  /* (3, P) */
    double *energies, *least; /* sums of rows: (4, P / the shortest row at the most) */
} HexMesh;

/* Scratch doubles of one member of a team. */
size_t hex_room(const HexMesh *mesh);

/* All members of a team compute at x (n, 3) the forces g, energies and least Jacobians of rows, for hex_sum; or in the
   first plane of g the stiffness, about a third of the trace of each node's Hessian, with pairs of edges if `pairs`. */
void hex_energy(const HexMesh *mesh, const HexWeights *weights, const double *x, double *room, Member member);
void hex_stiffness(const HexMesh *mesh, const HexWeights *weights, const double *x, int pairs, double *room,
                   Member member);

/* The value after hex_energy, infinite if folded and not regularised; and the smallest Jacobian. */
double hex_sum(const HexMesh *mesh, const HexWeights *weights, double *smallest);
