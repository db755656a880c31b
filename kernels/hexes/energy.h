/* The variational functional over hexahedra in blocks that share nodes; see energy.c. */
#pragma once
#include "team.h"
#include <stddef.h>
#include <stdint.h>

enum { SHAPES = 0 }; /* the power that stands for the energy of shapes: see corner3.h */

/* A block, a lattice of (n[0], n[1], n[2]) places: its nodes and, around them, those one step across connected sides.
   Where its places, its cells (n[0] - 3, ...) and its rows of cells begin in the tables. */
typedef struct {
    int64_t n[3], places, cells, rows;
} HexBlock;

/* Weights of the functional, `cells` is N. */
typedef struct {
    double shape, smoothness, size; /* w, β and t */
    double epsilon;                 /* of regularised Jacobians; 0: the barrier */
    double cells;
    int power; /* p, 1 or 2, 1 where it is regularised; or SHAPES, with w 1 and without β and ε */
} HexWeights;

/* Tables of numbers of places, P of them, and of cells, C of them, all blocks one after the other. */
typedef struct {
    ptrdiff_t blocks, places, cells, widest; /* how many; the longest row of places */
    const HexBlock *block;
    const int32_t *node;      /* of each place, -1: there is none */
    const double *inverse;    /* (3, C) one over the lengths that edges of cells should have */
    const uint8_t *skip;      /* (C,) bits of corners that do not count, 2^(4 di + 2 dj + dk) */
    const uint8_t *busy;      /* of each row of cells, whether a corner of it counts */
    const float *target;      /* (3, P) logarithms that the lengths of edges from a place should have; NaN: no edge */
    double *x, *g;            /* (3, P) coordinates and forces */
    double *lengths, *pulls;  /* (3, P) */
    double *energies, *least; /* sums of rows: (4, P / the shortest row at the most) */
} HexMesh;

/* Scratch doubles of one member of a team. */
size_t hex_room(const HexMesh *mesh);

/* What a team of which all come fills in at x (n, 3): forces g at the own places of blocks, energies and least
   Jacobians of rows, to be summed by hex_sum; or in the first plane of g the stiffness, about a third of the traces of
   blocks of the Hessian, with that of pairs of edges where `pairs`. */
void hex_energy(const HexMesh *mesh, const HexWeights *weights, const double *x, double *room, Member member);
void hex_stiffness(const HexMesh *mesh, const HexWeights *weights, const double *x, int pairs, double *room,
                   Member member);

/* The value after hex_energy, infinite where it is folded and nothing is regularised; the smallest Jacobian. */
double hex_sum(const HexMesh *mesh, const HexWeights *weights, double *smallest);
