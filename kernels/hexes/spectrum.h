/* Approximate inverse of the functional's Hessian in one block: D M⁻¹ D.

   M approximates the Hessian on a uniform grid of box cells, (2 / N) Σ_d λ_d / L_d² (3/2 + β N^(2/3) Σ_e λ_e),
   λ = 4 sin²(π m / 2n), diagonal after sine transforms along all three directions, which are matrix products
   in single precision. D, at most 1, is the square root of the ratio of M's diagonal to the stiffness at the nodes. */
#pragma once
#include "energy.h"

typedef struct {
    ptrdiff_t m[3], pitch; /* inner nodes; a row of them in whole panels */
    double over[3];        /* one over the mean lengths of edges along each direction */
    HexWeights weights;
    int threads;
    float *sines[3]; /* (m, m): sine transforms, each its own inverse */
    float *packed;   /* the last of them by panels */
    float *eigen[3]; /* 4 sin² of the modes, over those that follow in whole panels */
    float *scale;    /* D, one for each inner node */
    float *w, *v;    /* (m1, m2, pitch) */
    float *panels;   /* of each member */
} Spectrum3;

/* Floats that it needs, 0 without nodes; and their division, with the transforms. `m` and `threads` are set before. */
size_t spectrum3_floats(const Spectrum3 *s);
void spectrum3_place(Spectrum3 *s, float *floats);

/* D from the stiffness (m1, m2, m3) of nodes. */
void spectrum3_renew(Spectrum3 *s, const HexWeights *weights, const double *stiffness);

/* Three planes of numbers at inner nodes divided by the Hessian. */
void spectrum3_divide(const Spectrum3 *s, const double *gradient, float *result);
