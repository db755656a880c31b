/* Consecutive edges along grid lines of a mesh of quads. */
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
