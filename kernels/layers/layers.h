/* Moves nodes along grid lines into layers of given heights at one or both ends. */
#pragma once
#include <stddef.h>

/* Heights asked for: of the `constant` first and last cells, 0 where an end asks for none. */
typedef struct {
    double first, last;
    ptrdiff_t constant;
} Layers;

/* steps[0 .. cells-1] add up to `length`. `log_ratio` is the guess and the result. Returns the largest ratio of
   neighbouring steps, infinite when there is none that fits. */
double layer_steps(double *steps, ptrdiff_t cells, double length, const Layers *layers, double *log_ratio);

/* Lines i of x, y (ni, nj >= 3) sampled anew with nodes into X, Y (ni, NJ). Returns the largest ratio; ends are kept.
   `scratch` has 10 nj + NJ doubles a thread. */
double layer_lines(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, double *X, double *Y, ptrdiff_t NJ,
                   const Layers *layers, int threads, double *scratch);

/* Move the nodes of every line of the planes x and y (ni, nj) along it so that its first cell is `first[i]` high;
   `scratch` has 5 nj doubles a thread. */
void redistribute_lines(double *x, double *y, ptrdiff_t ni, ptrdiff_t nj, const double *first, const double *fade,
                        int threads, double *scratch);
