#pragma once
#include <stddef.h>

/* What is worst above each quadrilateral of a surface. */
typedef struct {
    double *corner;    /* (quads): least determinant of a corner over the product of its edges */
    double *quality;   /* (quads): least over largest determinant of the corners of a cell */
    ptrdiff_t *level;  /* (quads): of the cell whose corner is least */
    ptrdiff_t *folded; /* (quads): cells with a corner that is not positive */
    ptrdiff_t *doubtful; /* (quads): cells with a Bezier coefficient that is not */
} Folds;

/* Test the cells of lines (3, nodes, levels) above `count` quadrilaterals (count, 4). */
void find_folds(const double *lines, ptrdiff_t nodes, ptrdiff_t levels, const ptrdiff_t *quads, ptrdiff_t count,
                const Folds *folds, int threads);
