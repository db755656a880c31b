/* The variational functional of a grid, its gradient, and a descent of it; see variational.c. */
#pragma once
#include "steps.h"
#include <stddef.h>

typedef struct {
    double aspect;     /* a: reference ratio of eta steps to xi steps */
    double shape;      /* w: weight of the angle term against the harmonic one, 0 to 1 */
    double smoothness; /* β: weight of the edge length term */
    double epsilon;    /* an area: Jacobians are regularised by it; with 0 the value of a folded grid is infinite */
    int periodic;      /* the last row of nodes is the first, and its nodes are free */
    const double *relief; /* (ni,) share of the angle term that corners at nodes (i, 0) keep, or NULL for all of it */
} Weights;

/* The even or the odd modes of a direction, over half of its nodes: q (nodes, modes) and its transpose, rows padded
   with zeros to whole panels of 32. */
typedef struct {
    ptrdiff_t nodes, modes;
    const float *q, *q_t;
} Half;

typedef struct {
    Half even, odd;
} Transform;

/* Transforms that make the Hessian of a uniform grid of mi x mj free nodes diagonal; see spectral.h. `scale` is
   (2, modes of xi, modes of eta), for moves along xi and eta, the even modes first, rows padded as the modes of eta
   are; `rest` for modes beyond. */
typedef struct {
    ptrdiff_t mi, mj;
    Transform xi, eta;
    const float *scale;
    float rest;
} Spectrum;

/* A banded matrix for the moves of mi x mj inner nodes, by rows of these, x beside y: column c holds H(c, c) to
   H(c + width, c), and zeros up to the stride; see hessian.h. */
typedef struct {
    ptrdiff_t mi, mj, width, stride;
    float *column;
} Band;

/* Moves of inner nodes of a coarse grid, SPACE along a direction at the most; see frame.h. */
#define SPACE 16
typedef struct {
    Band band;       /* the factor; no nodes: none of this */
    float *unknowns; /* a vector of it */
    double unit;     /* what the factor's Hessian was multiplied by */
    const float *along, *across, *across_t; /* splines, (mi or mj fine, SPACE) and (SPACE, mj fine) */
} Space;

/* A descent under way. The free nodes are those of rows `first` to `first` + mi - 1, columns 1 to mj. */
typedef struct {
    ptrdiff_t ni, nj, first;
    int threads; /* that work on it, with the same result for any number */
    Weights weights;
    Spectrum spectrum;
    Space space;
    double *z, *full, *work; /* planes (2, ni, nj); room for two such; for the functional */
    float *frame, *transform; /* (2, mi, mj); room */
    Steps steps;              /* the unknowns are planes (2, mi, mj) */
} Descent;

size_t variational_workspace(ptrdiff_t ni, ptrdiff_t nj, int threads);

/* Return the functional of the nodes x, y (ni, nj); its gradient in gx, gy, zero on the rim; the smallest corner
   Jacobian. */
double variational_energy(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const Weights *weights,
                          int threads, double *gx, double *gy, double *smallest, double *work);

/* Shape the band, and return how many floats its columns take; vectors take 2 mi mj + width. */
size_t band_floats(Band *b, ptrdiff_t mi, ptrdiff_t mj);

/* Fill the band with the factor of the Hessian at z (2, mi + 2, mj + 2), or of as much of it as is positive, times
   `unit`; return 0 when z is folded. */
int band_factor(const Band *b, const double *z, const Weights *weights, double *unit);

/* Steps of Newton's method from z (2, mi + 2, mj + 2), in place, `most` at the most, none after one that lowers the
   functional by less than `won` of it; returns how many. `room` holds three times as much as z and the workspace of a thread,
   `moves` a vector of the band. */
int newton_steps(const Band *b, double *z, const Weights *weights, int most, double won, double *room, float *moves);

/* Doubles and floats that a descent needs, and their places in it. */
void descent_sizes(const Descent *d, size_t *doubles, size_t *floats);
void descent_place(Descent *d, double *doubles, float *floats);

/* Frames, value and gradient at z; then `steps_take` is one iteration. */
void descent_start(Descent *d);

/* The norm of the gradient. */
double descent_slope(const Descent *d);
