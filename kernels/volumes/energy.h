#pragma once
#include <stddef.h>

enum { SHAPES = 0 }; /* the power that stands for the energy of shapes: see corner3.h */

/* The functional of a volume's nodes (n1, n2, n3), k contiguous. */
typedef struct {
    ptrdiff_t n1, n2, n3;
    double over[3];    /* 1 / length of an edge along xi, eta, zeta, in the mean */
    double shape;      /* w, from 0 (Winslow's functional) to 1 (angles only) */
    double smoothness; /* β */
    double epsilon;    /* of the regularisation; 0: the barrier */
    int power;         /* p, 1 or 2, 1 with a regularisation; or SHAPES, with w 1 and without one */
    int threads;
} Functional3;

/* Doubles of scratch that the functional needs. */
size_t volume_energy_room(const Functional3 *f);

/* Value at the three planes x, and its gradient at inner nodes in the three planes g; infinite where a corner's
   Jacobian is not positive and epsilon is 0. */
double volume_energy(const Functional3 *f, const double *x, double *g, double *smallest, double *room);

/* The smallest corner Jacobian of each cell, (n1 - 1, n2 - 1, n3 - 1), its edges over the lengths of f. */
void volume_jacobians(const Functional3 *f, const double *x, double *least);

/* About a third of the traces of the blocks of the Hessian at inner nodes, in one plane h. */
void volume_stiffness(const Functional3 *f, const double *x, double *h, double *room);
