/* The variational functional over hexahedra that share nodes; see energy.c. */
#pragma once
#include <stddef.h>
#include <stdint.h>

#define BRICK_I 8 /* cells of a brick at the most along each direction */
#define BRICK_J 8
#define BRICK_K 32

/* A part of a block: (a, b, c) cells. Where its numbers begin: nodes (a+3, b+3, c+3), with one beyond each side, -1 where
   there is none; reciprocal lengths of cells, three planes (a, b, c); wanted logarithms of edges, along xi
   (a+2, b+1, c+1) with one edge beyond either end, then along eta and zeta; forces on its own nodes
   (a+1, b+1, c+1, 3). `ragged` bricks have edges without a length or cells of which no node moves. */
typedef struct {
    int64_t count[3], nodes, cells, targets, forces, ragged;
} Brick;

/* Weights of the functional, `cells` is N; with epsilon > 0 Jacobians are regularised, and p is 1, else 2. */
typedef struct {
    double shape, smoothness, epsilon, size, cells;
} HexWeights;

typedef struct {
    ptrdiff_t bricks;
    const Brick *brick;
    const int32_t *node;
    const uint8_t *moves; /* of each node of the table, whether it does */
    const double *inverse; /* reciprocal lengths */
    const float *target;
    double *force; /* of all bricks */
    double *energy, *least; /* (bricks,) value and smallest Jacobian */
} HexMesh;

/* Scratch doubles of one thread. */
size_t brick_room(void);

/* Fill energy, least and forces of a brick at nodes x (n, 3); without forces where it is folded and nothing is
   regularised. */
void brick_energy(const HexMesh *mesh, ptrdiff_t number, const HexWeights *weights, const double *x, double *room);

/* Fill the first force of each node of a brick with the stiffness of its corners and edges. */
void brick_stiffness(const HexMesh *mesh, ptrdiff_t number, const HexWeights *weights, const double *x, double *room);
