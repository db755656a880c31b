/* Consecutive edges along grid lines of a mesh of quads, and meshes that are images of themselves. */
#pragma once
#include <stddef.h>

#define NEXT_EDGES 4 /* neighbours of an edge along grid lines at the most: beside it in two cells, before and behind it */
#define FIRST_BEHIND 2 /* the first of those before and behind it */

/* Fill `line` (e, NEXT_EDGES) with the edges whose lengths those of each edge are compared with, itself where there are fewer:
   opposite ones in a quad, and the next ones through regular nodes: inner ones of four quads, and those of two along
   the boundary. Nodes and edges that a period makes one are given the same `node` (n) and `edge` (e); only the edges
   that stand for themselves are compared. Returns the number of pairs; `room` holds 2 n + 1 + 5 m + 2 e. */
ptrdiff_t line_neighbours(const ptrdiff_t *quads, const ptrdiff_t *edge_of, ptrdiff_t m, ptrdiff_t n, ptrdiff_t e,
                          const ptrdiff_t *node, const ptrdiff_t *edge, ptrdiff_t *line, ptrdiff_t *room);

/* Fill the quad `images` (m) that each quad becomes in a mirror, and the corner `first` (m) of it that its first corner
   becomes, from those of one `quad`: quads turn round, corner i becomes number first - i of the image. -1 is the image of
   quads that are not reached. `twin` (m, 4) is 4 q + k where edge k of quad q is on the other side of an edge, or -1.
   Returns 0 where one of two edges that become each other is on the boundary and the other is not. `room` holds 3 m. */
int quad_images(const ptrdiff_t *twin, ptrdiff_t m, ptrdiff_t quad, ptrdiff_t image, ptrdiff_t corner,
                ptrdiff_t *images, ptrdiff_t *first, ptrdiff_t *room);
