/* Measures of the cells of a block of hexahedra, whose nodes are the planes x, y and z (ni, nj, nk). */
#pragma once
#include <stddef.h>
#include <stdint.h>

enum {
    SOLID_MAX_ANGLE,
    SOLID_MIN_ANGLE,
    SOLID_SKEWNESS,
    SOLID_DEVIATION,
    SOLID_SCALED_JACOBIAN,
    SOLID_JACOBIAN_RATIO,
    SOLID_BEZIER_RATIO,
    SOLID_ASPECT_RATIO,
    SOLID_ORTHOGONALITY,
    SOLID_VOLUME_RATIO,
    SOLID_METRICS
};

typedef struct {
    const double *at[3]; /* x, y, z */
    ptrdiff_t ni, nj, nk;
} SolidNodes;

/* The test of a cell: its eight corner Jacobians are positive, or the 27 Bezier coefficients of its Jacobian. Corners at
   an edge of no length are left out if others are left. */
enum { SOLID_CORNERS, SOLID_BEZIER };

/* Rows of cells, (ni-1, nj-1): how many cells of each do not pass. */
void solids_folded(const SolidNodes *nodes, int test, int threads, int64_t *counts);

/* Indices (i, j, k) of the cells that do not pass, in order, of rows whose count is not 0. */
void solids_places(const SolidNodes *nodes, int test, const int64_t *counts, int64_t *places);

/* Magnitudes of the volumes of the cells, inside an array (ni+1, nj+1, nk+1) with a layer around. */
void solids_volumes(const SolidNodes *nodes, int threads, double *volumes);

/* Cells are measured in chunks of SOLID_ROWS rows (i, j ...) of one i, results kept by chunk. */
#define SOLID_ROWS 32
ptrdiff_t solids_chunks(const SolidNodes *nodes);

/* What one run over all cells takes and leaves. */
typedef struct {
    SolidNodes nodes;
    const double *volumes; /* those of solids_volumes; the layer around has the neighbours', or the cells' own again */
    double *summary;       /* (chunks, metrics, 3): min, sum, max */
    int64_t *where;        /* (chunks, metrics, 2, 3): cell (i, j, k) of the min and of the max, first in order */
    ptrdiff_t keep, n_kept; /* the first of the metrics whose values are kept, and how many are */
    double *kept;          /* (n_kept, ni-1, nj-1, nk-1) */
} SolidRun;

/* Returns 0 when there is no memory. */
int solids_run(const SolidRun *run, int threads);

/* Growth of steps and bend in degrees of grid lines at their nodes. `summary` (ni, 3, 2, 2): maximum (-1 without nodes) and
   sum, for each plane i, axis, and growth or bend; `where` (ni, 3, 2, 3): the node of the maximum; `values`, if any, all of
   them (3, 2, ni, nj, nk). Returns 0 without memory. */
int solids_lines(const SolidNodes *nodes, int threads, double *summary, int64_t *where, float *values);
