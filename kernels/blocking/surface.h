/* Walks over a surface of triangles. Corner c = 3 f + i is corner i of triangle f; edge c goes from corner i to the next
   corner of f. The triangle on the other side is neighbour[c], in which it has the number across[c]; both are -1 at a
   wall. */
#pragma once
#include <stddef.h>

typedef struct {
    ptrdiff_t triangles, vertices;
    const ptrdiff_t *vertex;              /* (3 triangles,) at each corner, counter-clockwise */
    const ptrdiff_t *neighbour, *across;  /* (3 triangles,) */
} Surface;

/* Corners around every vertex, counter-clockwise: those of vertex v are fan[start[v]] to fan[start[v + 1]], at a wall
   from the edge that leaves along it. Returns how many corners were reached: fewer than all where a vertex pinches. */
ptrdiff_t surface_fans(const Surface *s, ptrdiff_t *start, ptrdiff_t *fan);

/* Turn the frames of triangles by turn[f] quarters so that they agree over the edges of a spanning tree, breadth first,
   whose edges get cut[c] = 0 and all other inner ones 1. Frame g is frame f turned by quarters[c] when neighbour[c] = g.
   Returns the number of triangles reached, or -1 where memory ran out. */
ptrdiff_t surface_comb(const Surface *s, const ptrdiff_t *quarters, ptrdiff_t *turn, unsigned char *cut);

/* Take edges out of the cut that end at a vertex where no other does and that is not to be kept, again and again.
   Returns 0, or -1 where memory ran out. */
int surface_prune(const Surface *s, const ptrdiff_t *start, const ptrdiff_t *fan, const unsigned char *keep,
                  unsigned char *cut);
