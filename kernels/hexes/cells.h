/* The terms of the corners of a row of cells. */
#pragma once
#include "corner3.h"
#include "energy.h"

/* The rows of cells between four rows of nodes, (0, 0), (0, 1), (1, 0) and (1, 1) in xi and eta. */
typedef struct {
    const double *x[4], *y[4], *z[4], *inverse[3];
    const uint8_t *skip; /* bits of corners that do not count, NULL where all do */
    double fx[8][BRICK_K], fy[8][BRICK_K], fz[8][BRICK_K], least[BRICK_K]; /* on node 4 alpha + 2 beta + gamma */
} CellRow;

/* What is asked of a row; `size` is t / 2 times the weight of the place. */
typedef struct {
    Factors3 factors;
    double size;
    int power, regular;
} Terms;

/* Energy of a row; its forces and smallest Jacobians. */
double cells_of_row(CellRow *row, ptrdiff_t count, const Terms *terms);

/* Fill fx with the stiffness of edges, a share for each node at their ends. */
void stiffness_of_row(CellRow *row, ptrdiff_t count, const Terms *terms);
