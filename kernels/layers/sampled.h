/* Points along lines of nodes. */
#pragma once
#include <stddef.h>

/* Lines (lines, nodes >= 3, size) of nodes with `size` coordinates, which are at the ascending `arcs` (lines, nodes). */
typedef struct {
    ptrdiff_t lines, nodes, size;
    const double *node, *arc;
} NodeLines;

/* `points` (lines, count, size) at arc lengths `at` (lines, count): on cubic pieces between nodes, their tangents those of
   parabolas through three of them. First and last points are those of the lines. `slopes` has room for (nodes, size). */
void sampled_lines(const NodeLines *all, const double *at, ptrdiff_t count, double *points, double *slopes);
