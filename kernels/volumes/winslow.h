#pragma once
#include <stddef.h>

/* Winslow's equations on a volume's nodes (n1, n2, n3), three planes of coordinates one after the other. */
typedef struct {
    ptrdiff_t n1, n2, n3;
    double *x;
    const double *f; /* right sides, or NULL */
    int threads;
} Winslow3;

/* Doubles of scratch that relaxation needs. */
size_t winslow_room(const Winslow3 *w);

/* One sweep of lines along xi, then eta, then zeta, two colours each, over-relaxed by `factor`. */
void winslow_smooth(const Winslow3 *w, double factor, double *room);

/* r = f - L(x) at inner nodes, 0 on the faces; returns the sum of its squares. */
double winslow_residual(const Winslow3 *w, double *r, double *room);

/* Along one direction of arrays (before, n, after): to[m] = Σ weights[m][k] from[first[m] + k], k < terms; `add`s it, or
   sets it. */
void combine_along(const double *from, ptrdiff_t before, ptrdiff_t n, ptrdiff_t after, ptrdiff_t m,
                   const ptrdiff_t *first, const double *weights, ptrdiff_t terms, int add, int threads, double *to);
