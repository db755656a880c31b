/* Layers of a convolutional network in single and double precision; see network.c. */
#pragma once
#include <stddef.h>

/* A batch of m x n images with `inputs` channels, any padding included, to `outputs` by size x size taps. */
typedef struct {
    ptrdiff_t batch, m, n, inputs, outputs;
    int size, stride;
} Convolution;

/* One layer of a network on arrays of T, float when `single` and else double.

   CONVOLVE: x (batch, m, n, inputs), w (size size inputs, outputs rounded up to 64 bytes), taps along xi slowest,
   bias likewise, add NULL or as out (batch, (m - size)/stride + 1, (n - size)/stride + 1, outputs).
   ACTIVATE, REFINE: see layers_of_type.h; c.size is the padding. */
enum { CONVOLVE, ACTIVATE, REFINE };
typedef struct {
    int kind, single, around;
    Convolution c;
    const void *x, *w, *bias, *add;
    void *out;
} Layer;

void network_layer(const Layer *layer);

#define LOOK_FEATURES 20 /* of encoding.py, as are the numbers below */
#define LOOK_FLOOR 1e-2
#define LOOK_TINY 1e-6
#define LOOK_STILL 1e-3
#define LOOK_STRETCH 30.0
#define LOOK_MOST 129 /* nodes along an axis at the most */

/* out (batch, n, n, LOOK_FEATURES) of grids and their last steps, both (batch, 2, n, n). */
void network_look_float(const double *planes, const double *steps, ptrdiff_t batch, ptrdiff_t n, float *out);
void network_look_double(const double *planes, const double *steps, ptrdiff_t batch, ptrdiff_t n, double *out);
