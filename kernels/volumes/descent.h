#pragma once
#include "energy.h"
#include "energy/steps.h"

/* A descent of the functional over the inner nodes of a volume. */
typedef struct {
    Functional3 f;
    ptrdiff_t m[3], pitch; /* inner nodes; a row of them in whole panels */
    double *x;             /* the three planes of nodes, those of the caller */
    double *trial, *g, *room;
    float *sines[3];   /* (m, m): sine transforms, each its own inverse */
    float *packed;     /* the last of them by panels */
    float *eigen[3];   /* 4 sin² of the modes, over those that follow in whole panels */
    float *scale;      /* D, one for each inner node */
    float *sizes;      /* of cells around each, squared */
    float *w, *v;      /* (m1, m2, pitch) */
    float *panels;     /* of each member */
    Steps steps;
} Descent3;

/* Doubles and floats of scratch, their places in it, and the transforms; `f` has its counts and threads. */
void descent3_sizes(Descent3 *d, size_t *doubles, size_t *floats);
void descent3_place(Descent3 *d, double *doubles, float *floats);

/* Value, gradient and preconditioner at x; then an iteration at a time. */
void descent3_start(Descent3 *d);
int descent3_take(Descent3 *d);

/* The preconditioner for where the nodes are now. */
void descent3_renew(Descent3 *d);
