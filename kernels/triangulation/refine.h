/* Delaunay refinement to a field of sizes, and smoothing. */
#ifndef MESHONET_TRIANGULATION_REFINE_H
#define MESHONET_TRIANGULATION_REFINE_H

#include "mesh.h"

typedef struct {
    double largest, growth;                 /* size <= largest, and changes by at most `growth` a length */
    ptrdiff_t n_sources;                    /* size <= source_size + growth * distance */
    const double *source, *source_size;
} Sizes;

/* Insert circumcentres of inner triangles, worst first, until each radius is below .75 of the size there or there
   are `most` nodes. */
int refine(Mesh *mesh, const Sizes *sizes, ptrdiff_t most);

/* Move the nodes from `first` on towards the mean of their neighbours, then flip. */
int smooth(Mesh *mesh, ptrdiff_t first, double part);

/* Move the nodes from `first` on at random by up to `part` of their size. */
int shake(Mesh *mesh, ptrdiff_t first, double part, uint64_t seed);

#endif
