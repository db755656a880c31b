/* A row of hexahedra along k, and its corners.

        node (i+a, j+b, k) is lines[a][b] at k; edges along i are u, along j v, along k w:

             *------w------*            the Jacobian at corner (a, b, c) is det(u, v, w) of the three edges that meet
            /|            /|            there, all taken in the direction of their index; the trilinear cell has
           v |           / |            dX/di = u bilinear in (j, k), and so on: 4 vectors for each direction
          *------w------*  |
          |  *----------|--*     j k
          u             |        |/     */
#pragma once
#include "angles.h"
#include "solids.h"
#include "vectors.h"

typedef struct {
    const double *at[2][2][3]; /* x, y, z of node (i+a, j+b, 0) */
} SolidLines;

MESHONET_INLINE Vector solid_node(const SolidLines *lines, int a, int b, ptrdiff_t k)
{
    return (Vector){lines->at[a][b][0][k], lines->at[a][b][1][k], lines->at[a][b][2][k]};
}

MESHONET_INLINE SolidLines solid_lines(const SolidNodes *nodes, ptrdiff_t i, ptrdiff_t j)
{
    SolidLines lines;
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            for (int axis = 0; axis < 3; axis++)
                lines.at[a][b][axis] = nodes->at[axis] + ((i + a) * nodes->nj + j + b) * nodes->nk;
    return lines;
}

/* Edges of cell k: u[b][c] from (0, b, c) to (1, b, c), v[a][c], w[a][b]. */
typedef struct {
    Vector u[2][2], v[2][2], w[2][2];
} SolidEdges;

MESHONET_INLINE SolidEdges solid_edges(const SolidLines *lines, ptrdiff_t k)
{
    SolidEdges e;
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
            e.u[a][b] = minus(solid_node(lines, 1, a, k + b), solid_node(lines, 0, a, k + b));
            e.v[a][b] = minus(solid_node(lines, a, 1, k + b), solid_node(lines, a, 0, k + b));
            e.w[a][b] = minus(solid_node(lines, a, b, k + 1), solid_node(lines, a, b, k));
        }
    return e;
}

/* The least of the Bezier coefficients of the Jacobian of one index p along i,

       B_pqr = sum over a+a' = p, b+b' = q, c+c' = r of w_p w_q w_r det(u_bc, v_ac', w_a'b'),  w = 1, 1/2, 1

   where all 27 are positive, so is the Jacobian everywhere in the cell: A. Johnen, J.-F. Remacle, C. Geuzaine,
   J. Comput. Phys. 233 (2013) 359-372. */
MESHONET_INLINE double bezier_least(const SolidEdges *e, int p)
{
    double d[2][2][2][2]; /* b, b', c, c' */
    for (int bb = 0; bb < 2; bb++)
        for (int cc = 0; cc < 2; cc++) {
            Vector normal = p == 0   ? cross(e->v[0][cc], e->w[0][bb])
                            : p == 2 ? cross(e->v[1][cc], e->w[1][bb])
                                     : plus(cross(e->v[0][cc], e->w[1][bb]), cross(e->v[1][cc], e->w[0][bb]));
            if (p == 1)
                normal = (Vector){0.5 * normal.x, 0.5 * normal.y, 0.5 * normal.z};
            for (int b = 0; b < 2; b++)
                for (int c = 0; c < 2; c++)
                    d[b][bb][c][cc] = dot(e->u[b][c], normal);
        }
    double least = 1e300;
    for (int c = 0; c < 3; c++) {
        double t[2][2];
        for (int b = 0; b < 2; b++)
            for (int bb = 0; bb < 2; bb++)
                t[b][bb] = c == 1 ? 0.5 * (d[b][bb][0][1] + d[b][bb][1][0]) : d[b][bb][c / 2][c / 2];
        double q = 0.5 * (t[0][1] + t[1][0]);
        least = smaller(least, smaller(q, smaller(t[0][0], t[1][1])));
    }
    return least;
}

/* Inverse lengths of the edges of a row of cells, 0 for an edge of no length; u[b] and v[a] have nk, w[a][b] nk - 1. */
typedef struct {
    double *u[2], *v[2], *w[2][2];
} SolidLengths;

/* All metrics of a row of cells into out[metric * stride + k]; `volumes` points at that of cell 0, `beside` are the
   distances of its neighbours' volumes. */
void solid_row(const SolidLines *lines, const SolidLengths *inverse, const double *volumes, const ptrdiff_t beside[2],
               ptrdiff_t cells, ptrdiff_t stride, double *out);

/* 1 over the distances of `count` points a from points b. */
void solid_inverse_lengths(const double *const a[3], const double *const b[3], ptrdiff_t count, double *out);
