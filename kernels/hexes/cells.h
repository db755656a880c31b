/* One row of cells of a block: the functional's terms at the corners of each, and forces on its nodes. The shape
   functional (power SHAPES) is also evaluated at the eight Gauss points, with most of the weight: it is nearly the
   integral over the trilinear cell, and still infinite if a corner's Jacobian is 0. */
#pragma once
#include "corner3.h"
#include "energy.h"

typedef struct {
    const double *at[2][2]; /* rows of nodes around the cells, by (i, j), in planes of coordinates `nodes` apart */
    const double *over[3];  /* one over the target lengths of edges along each direction */
    const int64_t *skip;    /* bits of corners that do not count; as wide as doubles, for vectors */
    ptrdiff_t nodes, cells;
    Factors3 factors;
} CellRow;

MESHONET_INLINE Vector edge3(const double *from, const double *to, ptrdiff_t nodes, double over)
{
    return (Vector){over * (to[0] - from[0]), over * (to[nodes] - from[nodes]), over * (to[2 * nodes] - from[2 * nodes])};
}

MESHONET_INLINE double lower(double a, double b)
{
    return a < b ? a : b;
}

#define AT_CORNERS 0.015 /* weight of the corners there: a barrier */

/* The twelve edges of a cell, or forces on them: u by (dj, dk), v by (di, dk), w by (di, dj). */
typedef struct {
    Vector u00, u10, u01, u11, v00, v10, v01, v11, w00, w10, w01, w11;
} Edges3;

/* The terms of corner `number`, 0 if it does not count. */
MESHONET_INLINE Corner3 term3(Vector u, Vector v, Vector w, const Factors3 *f, int64_t skip, int number, const int power,
                              const int regular)
{
    const Corner3 c = power == SHAPES ? shape3(u, v, w, f->angle) : corner3(u, v, w, f, power, regular);
    const int64_t out = skip >> number & 1;
    return (Corner3){
        {out ? 0.0 : c.du.x, out ? 0.0 : c.du.y, out ? 0.0 : c.du.z},
        {out ? 0.0 : c.dv.x, out ? 0.0 : c.dv.y, out ? 0.0 : c.dv.z},
        {out ? 0.0 : c.dw.x, out ? 0.0 : c.dw.y, out ? 0.0 : c.dw.z},
        out ? 0.0 : c.energy, out ? INFINITY : c.jacobian,
    };
}

/* The sum of the terms at eight points, their derivatives by the edges, and the smallest Jacobian. */
MESHONET_INLINE double eight_terms(const Edges3 *e, const Factors3 *f, int64_t skip, Edges3 *by, double *low,
                                   const int power, const int regular)
{
    const Corner3 c000 = term3(e->u00, e->v00, e->w00, f, skip, 0, power, regular);
    const Corner3 c100 = term3(e->u00, e->v10, e->w10, f, skip, 4, power, regular);
    const Corner3 c010 = term3(e->u10, e->v00, e->w01, f, skip, 2, power, regular);
    const Corner3 c110 = term3(e->u10, e->v10, e->w11, f, skip, 6, power, regular);
    const Corner3 c001 = term3(e->u01, e->v01, e->w00, f, skip, 1, power, regular);
    const Corner3 c101 = term3(e->u01, e->v11, e->w10, f, skip, 5, power, regular);
    const Corner3 c011 = term3(e->u11, e->v01, e->w01, f, skip, 3, power, regular);
    const Corner3 c111 = term3(e->u11, e->v11, e->w11, f, skip, 7, power, regular);
    const double l0 = lower(lower(c000.jacobian, c100.jacobian), lower(c010.jacobian, c110.jacobian));
    const double l1 = lower(lower(c001.jacobian, c101.jacobian), lower(c011.jacobian, c111.jacobian));
    *low = lower(l0, l1);
    by->u00 = plus(c000.du, c100.du), by->u10 = plus(c010.du, c110.du);
    by->u01 = plus(c001.du, c101.du), by->u11 = plus(c011.du, c111.du);
    by->v00 = plus(c000.dv, c010.dv), by->v10 = plus(c100.dv, c110.dv);
    by->v01 = plus(c001.dv, c011.dv), by->v11 = plus(c101.dv, c111.dv);
    by->w00 = plus(c000.dw, c001.dw), by->w01 = plus(c010.dw, c011.dw);
    by->w10 = plus(c100.dw, c101.dw), by->w11 = plus(c110.dw, c111.dw);
    return ((c000.energy + c100.energy) + (c010.energy + c110.energy)) +
           ((c001.energy + c101.energy) + (c011.energy + c111.energy));
}

/* The bilinear interpolation of four edges at a Gauss point nearest to `own`. */
MESHONET_INLINE Vector blend(Vector own, Vector one, Vector two, Vector both)
{
    const double near = 0.78867513459481288225, far = 1.0 - near; /* (1 + 1/sqrt(3)) / 2 */
    const double p = near * near, q = near * far, r = far * far;
    return (Vector){p * own.x + q * (one.x + two.x) + r * both.x, p * own.y + q * (one.y + two.y) + r * both.y,
                     p * own.z + q * (one.z + two.z) + r * both.z};
}

/* The edges at the Gauss points; this matrix is symmetric. */
MESHONET_INLINE Edges3 at_gauss(const Edges3 *e)
{
    return (Edges3){
        blend(e->u00, e->u10, e->u01, e->u11), blend(e->u10, e->u00, e->u11, e->u01),
        blend(e->u01, e->u11, e->u00, e->u10), blend(e->u11, e->u01, e->u10, e->u00),
        blend(e->v00, e->v10, e->v01, e->v11), blend(e->v10, e->v00, e->v11, e->v01),
        blend(e->v01, e->v11, e->v00, e->v10), blend(e->v11, e->v01, e->v10, e->v00),
        blend(e->w00, e->w10, e->w01, e->w11), blend(e->w10, e->w00, e->w11, e->w01),
        blend(e->w01, e->w11, e->w00, e->w10), blend(e->w11, e->w01, e->w10, e->w00),
    };
}

MESHONET_INLINE Edges3 added(const Edges3 *a, const Edges3 *b)
{
    return (Edges3){plus(a->u00, b->u00), plus(a->u10, b->u10), plus(a->u01, b->u01), plus(a->u11, b->u11),
                    plus(a->v00, b->v00), plus(a->v10, b->v10), plus(a->v01, b->v01), plus(a->v11, b->v11),
                    plus(a->w00, b->w00), plus(a->w10, b->w10), plus(a->w01, b->w01), plus(a->w11, b->w11)};
}

/* The functional of a cell from its edges, as eight_terms. */
MESHONET_INLINE double cell_terms(const Edges3 *e, const Factors3 *f, int64_t skip, Edges3 *by, double *low,
                                  const int power, const int regular)
{
    if (power != SHAPES)
        return eight_terms(e, f, skip, by, low, power, regular);
    const Factors3 corners = {.angle = AT_CORNERS * f->angle}, inside = {.angle = (1.0 - AT_CORNERS) * f->angle};
    const Edges3 inner = at_gauss(e);
    Edges3 first, second;
    double least;
    const double energy = eight_terms(e, &corners, skip, &first, low, SHAPES, 0);
    const double more = eight_terms(&inner, &inside, skip, &second, &least, SHAPES, 0);
    *low = lower(*low, least), second = at_gauss(&second);
    *by = added(&first, &second);
    return energy + more;
}

/* `forces` (8, 3, width): on the nodes of cell k at [di][dj][dk], its rows k; `least` (width): smallest Jacobians.
   Returns the sum of the energies. */
MESHONET_INLINE double cell_row(const CellRow *row, double *restrict forces, double *restrict least, ptrdiff_t width,
                                 const int power, const int regular)
{
    const double *a = row->at[0][0], *b = row->at[0][1], *c = row->at[1][0], *d = row->at[1][1];
    const ptrdiff_t n = row->nodes;
    const double *restrict along = row->over[0], *restrict across = row->over[1], *restrict up = row->over[2];
    const int64_t *restrict skip = row->skip;
    const Factors3 f = row->factors;
    double energy = 0.0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < row->cells; k++) {
        const double o1 = along[k], o2 = across[k], o3 = up[k];
        const Edges3 edges = {
            edge3(a + k, c + k, n, o1), edge3(b + k, d + k, n, o1),
            edge3(a + k + 1, c + k + 1, n, o1), edge3(b + k + 1, d + k + 1, n, o1),
            edge3(a + k, b + k, n, o2), edge3(c + k, d + k, n, o2),
            edge3(a + k + 1, b + k + 1, n, o2), edge3(c + k + 1, d + k + 1, n, o2),
            edge3(a + k, a + k + 1, n, o3), edge3(c + k, c + k + 1, n, o3),
            edge3(b + k, b + k + 1, n, o3), edge3(d + k, d + k + 1, n, o3),
        };
        Edges3 by;
        energy += cell_terms(&edges, &f, skip[k], &by, least + k, power, regular);
#define PUT(node, expression)                                                                                           \
    forces[(3 * (node)) * width + k] = (expression(x)), forces[(3 * (node) + 1) * width + k] = (expression(y)),          \
                              forces[(3 * (node) + 2) * width + k] = (expression(z))
#define AT_000(t) -o1 * by.u00.t - o2 * by.v00.t - o3 * by.w00.t
#define AT_001(t) -o1 * by.u01.t - o2 * by.v01.t + o3 * by.w00.t
#define AT_010(t) -o1 * by.u10.t + o2 * by.v00.t - o3 * by.w01.t
#define AT_011(t) -o1 * by.u11.t + o2 * by.v01.t + o3 * by.w01.t
#define AT_100(t) o1 * by.u00.t - o2 * by.v10.t - o3 * by.w10.t
#define AT_101(t) o1 * by.u01.t - o2 * by.v11.t + o3 * by.w10.t
#define AT_110(t) o1 * by.u10.t + o2 * by.v10.t - o3 * by.w11.t
#define AT_111(t) o1 * by.u11.t + o2 * by.v11.t + o3 * by.w11.t
        PUT(0, AT_000), PUT(1, AT_001), PUT(2, AT_010), PUT(3, AT_011);
        PUT(4, AT_100), PUT(5, AT_101), PUT(6, AT_110), PUT(7, AT_111);
    }
    return energy;
}

/* The stiffness at the nodes of each cell of a row, `parts` (8, width) as forces are. */
MESHONET_INLINE void stiffness_row(const CellRow *row, double *restrict parts, ptrdiff_t width, const int power,
                                    const int regular)
{
    const ptrdiff_t n = row->nodes;
    const double *restrict o1 = row->over[0], *restrict o2 = row->over[1], *restrict o3 = row->over[2];
    const int64_t *restrict skip = row->skip;
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
                double *restrict next = parts + (4 * (1 - di) + 2 * dj + dk) * width;
                double *restrict beside = parts + (4 * di + 2 * (1 - dj) + dk) * width;
                double *restrict above = parts + (4 * di + 2 * dj + (1 - dk)) * width;
                MESHONET_INDEPENDENT
                for (ptrdiff_t k = 0; k < row->cells; k++) {
                    const Vector u = edge3(a + k, b + k, n, o1[k]), v = edge3(c + k, d + k, n, o2[k]);
                    const Vector w = edge3(e + k, e + k + 1, n, o3[k]);
                    const Stiffness3 s = power == SHAPES ? shape_stiffness3(u, v, w, f.angle)
                                                         : stiffness3(u, v, w, &f, power, regular);
                    const int64_t out = skip[k] >> (4 * di + 2 * dj + dk) & 1;
                    const double uu = out ? 0.0 : o1[k] * o1[k] * s.uu, vv = out ? 0.0 : o2[k] * o2[k] * s.vv;
                    const double ww = out ? 0.0 : o3[k] * o3[k] * s.ww;
                    here[k] += uu + vv + ww, next[k] += uu, beside[k] += vv, above[k] += ww;
                }
            }
}
