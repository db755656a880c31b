/* One level of the multigrid hierarchy for Winslow's system with control functions, and what can be done to it. */
#pragma once
#include <stddef.h>

/* Weights of the differences at the nodes of one direction, whose steps need not be equal:
       second difference  forward[k] (x[k+1] - x[k]) + backward[k] (x[k-1] - x[k])
       first difference   centred[k] (x[k+1] - x[k-1]) */
typedef struct {
    const double *forward, *backward, *centred;
} Differences;

/* A control function: the logarithm of the ratio of neighbouring steps, l(i, j) = Σ_t along[t][i] across[t][j];
   `reach` is the longer of the two steps at each node. */
typedef struct {
    ptrdiff_t terms;
    const double *along, *across; /* terms x (mi + 1) and terms x (mj + 1) */
    const double *reach;
} Control;

/* Weights between the nodes of one direction and the coarse nodes 0, 2, 4 ... and the last:
       interpolation  x[k] = (1 - right[k]) X[left] + right[k] X[left + 1] at nodes that the coarse level lacks
       restriction    F[K] = before[K] f[2K-1] + at[K] f[2K] + after[K] f[2K+1] */
typedef struct {
    const double *right;
    const double *before, *at, *after;
} Transfer;

typedef struct {
    ptrdiff_t mi, mj; /* cells along xi and eta: planes hold (mi + 1) rows of mj + 1 nodes */
    int periodic;     /* in xi: row mi repeats row 0 */
    double *x, *y;    /* the nodes; the rim is given */
    double *fx, *fy;  /* right side, null where it is zero (the finest level) */
    double *x0, *y0;  /* what the finer level sent down, null on the finest */
    Differences xi, eta;
    Transfer xi_coarse, eta_coarse; /* to the next coarser level, null on the coarsest */
    Control phi, psi;               /* along xi and along eta; no terms: none */
    int threads;                    /* that work on it */
    double *scratch;                /* multigrid_scratch() doubles */
} Level;

/* Doubles of scratch that so many threads need for a level of mi x mj cells. */
size_t multigrid_scratch(ptrdiff_t mi, ptrdiff_t mj, int threads);

/* One sweep of zebra relaxation along eta lines, then along xi lines, in place. `forced`: use the right side. */
void multigrid_smooth(const Level *level, int forced);

/* Sum over the nodes solved for of |f - L(x)|^2. */
double multigrid_residual(const Level *level, int forced);

/* Coarse x, y, x0, y0 = injection of fine x, y; coarse f = restriction of f - L(x) + L of the coarse x. */
void multigrid_restrict(const Level *fine, const Level *coarse, int forced);

/* fine x += interpolation of coarse (x - x0), at the nodes solved for. Returns the sum of |coarse (x - x0)|^2. */
double multigrid_correct(const Level *fine, const Level *coarse);
