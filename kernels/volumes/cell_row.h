/* One row of cells of a volume: the functional's terms at the eight corners of each, and forces on its nodes. */
#pragma once
#include "corner3.h"

/* Rows of nodes around a row of cells: (i, j), (i, j+1), (i+1, j), (i+1, j+1), of planes of coordinates `nodes` apart. */
typedef struct {
    const double *at[2][2];
    ptrdiff_t nodes, cells;
    Factors3 factors;
    double over[3];
} CellRow3;

MESHONET_INLINE Vector3 edge3(const double *from, const double *to, ptrdiff_t nodes, double over)
{
    return (Vector3){over * (to[0] - from[0]), over * (to[nodes] - from[nodes]), over * (to[2 * nodes] - from[2 * nodes])};
}

MESHONET_INLINE Vector3 sum3(Vector3 a, Vector3 b, double factor)
{
    return (Vector3){factor * (a.x + b.x), factor * (a.y + b.y), factor * (a.z + b.z)};
}

MESHONET_INLINE double lower(double a, double b)
{
    return a < b ? a : b;
}

/* `forces` (8, 3, width): on the nodes of cell k at [di][dj][dk], its rows k; `least` (width): smallest Jacobians.
   Returns the sum of the energies. */
MESHONET_INLINE double cell_row3(const CellRow3 *row, double *restrict forces, double *restrict least, ptrdiff_t width,
                                 const int power, const int regular)
{
    const double *a = row->at[0][0], *b = row->at[0][1], *c = row->at[1][0], *d = row->at[1][1];
    const ptrdiff_t n = row->nodes;
    const double o1 = row->over[0], o2 = row->over[1], o3 = row->over[2];
    const Factors3 f = row->factors;
    double energy = 0.0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < row->cells; k++) {
        const Vector3 u00 = edge3(a + k, c + k, n, o1), u10 = edge3(b + k, d + k, n, o1); /* by dj, dk */
        const Vector3 u01 = edge3(a + k + 1, c + k + 1, n, o1), u11 = edge3(b + k + 1, d + k + 1, n, o1);
        const Vector3 v00 = edge3(a + k, b + k, n, o2), v10 = edge3(c + k, d + k, n, o2); /* by di, dk */
        const Vector3 v01 = edge3(a + k + 1, b + k + 1, n, o2), v11 = edge3(c + k + 1, d + k + 1, n, o2);
        const Vector3 w00 = edge3(a + k, a + k + 1, n, o3), w01 = edge3(b + k, b + k + 1, n, o3); /* by di, dj */
        const Vector3 w10 = edge3(c + k, c + k + 1, n, o3), w11 = edge3(d + k, d + k + 1, n, o3);
        const Corner3 c000 = corner3(u00, v00, w00, &f, power, regular);
        const Corner3 c100 = corner3(u00, v10, w10, &f, power, regular);
        const Corner3 c010 = corner3(u10, v00, w01, &f, power, regular);
        const Corner3 c110 = corner3(u10, v10, w11, &f, power, regular);
        const Corner3 c001 = corner3(u01, v01, w00, &f, power, regular);
        const Corner3 c101 = corner3(u01, v11, w10, &f, power, regular);
        const Corner3 c011 = corner3(u11, v01, w01, &f, power, regular);
        const Corner3 c111 = corner3(u11, v11, w11, &f, power, regular);
        energy += ((c000.energy + c100.energy) + (c010.energy + c110.energy)) +
                  ((c001.energy + c101.energy) + (c011.energy + c111.energy));
        const double l0 = lower(lower(c000.jacobian, c100.jacobian), lower(c010.jacobian, c110.jacobian));
        const double l1 = lower(lower(c001.jacobian, c101.jacobian), lower(c011.jacobian, c111.jacobian));
        least[k] = lower(l0, l1);
        const Vector3 fu00 = sum3(c000.du, c100.du, o1), fu10 = sum3(c010.du, c110.du, o1);
        const Vector3 fu01 = sum3(c001.du, c101.du, o1), fu11 = sum3(c011.du, c111.du, o1);
        const Vector3 fv00 = sum3(c000.dv, c010.dv, o2), fv10 = sum3(c100.dv, c110.dv, o2);
        const Vector3 fv01 = sum3(c001.dv, c011.dv, o2), fv11 = sum3(c101.dv, c111.dv, o2);
        const Vector3 fw00 = sum3(c000.dw, c001.dw, o3), fw01 = sum3(c010.dw, c011.dw, o3);
        const Vector3 fw10 = sum3(c100.dw, c101.dw, o3), fw11 = sum3(c110.dw, c111.dw, o3);
#define PUT(node, expression)                                                                                           \
    forces[(3 * (node)) * width + k] = (expression(x)), forces[(3 * (node) + 1) * width + k] = (expression(y)),          \
                              forces[(3 * (node) + 2) * width + k] = (expression(z))
#define AT_000(t) -fu00.t - fv00.t - fw00.t
#define AT_001(t) -fu01.t - fv01.t + fw00.t
#define AT_010(t) -fu10.t + fv00.t - fw01.t
#define AT_011(t) -fu11.t + fv01.t + fw01.t
#define AT_100(t) fu00.t - fv10.t - fw10.t
#define AT_101(t) fu01.t - fv11.t + fw10.t
#define AT_110(t) fu10.t + fv10.t - fw11.t
#define AT_111(t) fu11.t + fv11.t + fw11.t
        PUT(0, AT_000), PUT(1, AT_001), PUT(2, AT_010), PUT(3, AT_011);
        PUT(4, AT_100), PUT(5, AT_101), PUT(6, AT_110), PUT(7, AT_111);
    }
    return energy;
}

/* The stiffness at the nodes of each cell of a row, `parts` (8, width) as forces are. */
MESHONET_INLINE void stiffness_row3(const CellRow3 *row, double *restrict parts, ptrdiff_t width, const int power,
                                    const int regular)
{
    const ptrdiff_t n = row->nodes;
    const double o1 = row->over[0], o2 = row->over[1], o3 = row->over[2];
    const Factors3 f = row->factors;
    for (int at = 0; at < 8; at++)
        for (ptrdiff_t k = 0; k < row->cells; k++)
            parts[at * width + k] = 0.0;
    for (int di = 0; di < 2; di++)
        for (int dj = 0; dj < 2; dj++)
            for (int dk = 0; dk < 2; dk++) {
                const double *a = row->at[0][dj] + dk, *b = row->at[1][dj] + dk;
                const double *c = row->at[di][0] + dk, *d = row->at[di][1] + dk, *e = row->at[di][dj];
                double *restrict here = parts + (4 * di + 2 * dj + dk) * width;
                double *restrict along = parts + (4 * (1 - di) + 2 * dj + dk) * width;
                double *restrict across = parts + (4 * di + 2 * (1 - dj) + dk) * width;
                double *restrict up = parts + (4 * di + 2 * dj + (1 - dk)) * width;
                MESHONET_INDEPENDENT
                for (ptrdiff_t k = 0; k < row->cells; k++) {
                    const Vector3 u = edge3(a + k, b + k, n, o1), v = edge3(c + k, d + k, n, o2);
                    const Stiffness3 s = stiffness3(u, v, edge3(e + k, e + k + 1, n, o3), &f, power, regular);
                    const double uu = o1 * o1 * s.uu, vv = o2 * o2 * s.vv, ww = o3 * o3 * s.ww;
                    here[k] += uu + vv + ww, along[k] += uu, across[k] += vv, up[k] += ww;
                }
            }
}
