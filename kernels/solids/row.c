#include "row.h"

#define BLOCK 64 /* cells of a row at a time */
#define LARGE 1e30   /* what Verdict puts in place of infinity */
#define SMALL 1e-300 /* keeps a cell without volume or edges from a division by 0 */

MESHONET_CLONES
void solid_inverse_lengths(const double *const a[3], const double *const b[3], ptrdiff_t count, double *restrict out)
{
    const double *restrict ax = a[0], *restrict ay = a[1], *restrict az = a[2];
    const double *restrict bx = b[0], *restrict by = b[1], *restrict bz = b[2];
    for (ptrdiff_t k = 0; k < count; k++) {
        const double x = bx[k] - ax[k], y = by[k] - ay[k], z = bz[k] - az[k];
        const double square = x * x + y * y + z * z;
        const double inverse = 1.0 / __builtin_sqrt(larger(square, SMALL));
        out[k] = square > 0 ? inverse : 0.0;
    }
}

/* What is known of a block of cells, one corner after the other. */
typedef struct {
    double least[BLOCK], most[BLOCK], scaled[BLOCK], narrow[BLOCK], wide[BLOCK], bezier[BLOCK], cross[BLOCK];
    double off[8][BLOCK]; /* greatest cosine of the three angles at each corner */
} SolidBlock;

/* Take corner (a, b, c) of `count` cells from `start` on into the block. */
MESHONET_INLINE void solid_corner(const SolidLines *restrict lines, const SolidLengths *restrict inverse, const int a,
                                  const int b, const int c, ptrdiff_t start, ptrdiff_t count, SolidBlock *restrict at)
{
    const SolidLines own = *lines;
    const double *restrict lu = inverse->u[b] + start + c, *restrict lv = inverse->v[a] + start + c;
    const double *restrict lw = inverse->w[a][b] + start;
    double *restrict off = at->off[4 * a + 2 * b + c];
    const double uv_sign = a == b ? 1 : -1, vw_sign = b == c ? 1 : -1, wu_sign = c == a ? 1 : -1;
    const int first = a + b + c == 0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t m = 0; m < count; m++) {
        const ptrdiff_t k = start + m;
        const Vector u = minus(solid_node(&own, 1, b, k + c), solid_node(&own, 0, b, k + c));
        const Vector v = minus(solid_node(&own, a, 1, k + c), solid_node(&own, a, 0, k + c));
        const Vector w = minus(solid_node(&own, a, b, k + 1), solid_node(&own, a, b, k));
        const double jacobian = triple(u, v, w), product = lu[m] * lv[m] * lw[m];
        const double uv = uv_sign * dot(u, v) * (lu[m] * lv[m]), vw = vw_sign * dot(v, w) * (lv[m] * lw[m]);
        const double wu = wu_sign * dot(w, u) * (lw[m] * lu[m]);
        const double high = larger(larger(uv, vw), wu), low = smaller(smaller(uv, vw), wu);
        const double scaled = product > 0 ? jacobian * product : 1.0; /* no corner where an edge has no length */
        off[m] = larger(high, -low);
        at->narrow[m] = first ? high : larger(at->narrow[m], high);
        at->wide[m] = first ? low : smaller(at->wide[m], low);
        at->scaled[m] = first ? scaled : smaller(at->scaled[m], scaled);
        at->least[m] = first ? jacobian : smaller(at->least[m], jacobian);
        at->most[m] = first ? magnitude(jacobian) : larger(at->most[m], magnitude(jacobian));
    }
}

/* The three principal axes of the cells, twice the sums of the edges of a direction: crossing and ratio of lengths. */
MESHONET_INLINE void solid_axes(const SolidLines *restrict lines, ptrdiff_t start, ptrdiff_t count,
                                SolidBlock *restrict at, double *restrict aspect)
{
    const SolidLines own = *lines;
    MESHONET_INDEPENDENT
    for (ptrdiff_t m = 0; m < count; m++) {
        const SolidEdges e = solid_edges(&own, start + m);
        const Vector u = plus(plus(e.u[0][0], e.u[0][1]), plus(e.u[1][0], e.u[1][1]));
        const Vector v = plus(plus(e.v[0][0], e.v[0][1]), plus(e.v[1][0], e.v[1][1]));
        const Vector w = plus(plus(e.w[0][0], e.w[0][1]), plus(e.w[1][0], e.w[1][1]));
        const double lu = __builtin_sqrt(dot(u, u)), lv = __builtin_sqrt(dot(v, v)), lw = __builtin_sqrt(dot(w, w));
        const double inverse = 1.0 / larger(lu * lv * lw, SMALL);
        const double uv = magnitude(dot(u, v)) * lw, vw = magnitude(dot(v, w)) * lu, wu = magnitude(dot(w, u)) * lv;
        const double centre = triple(u, v, w) * inverse;
        at->scaled[m] = smaller(at->scaled[m], centre);
        at->cross[m] = larger(larger(uv, vw), wu) * inverse;
        const double longest = larger(larger(lu, lv), lw), shortest = smaller(smaller(lu, lv), lw);
        aspect[m] = smaller(longest / larger(shortest, SMALL), LARGE);
    }
}

MESHONET_INLINE void solid_bezier(const SolidLines *restrict lines, const int p, ptrdiff_t start, ptrdiff_t count,
                                  SolidBlock *restrict at)
{
    const SolidLines own = *lines;
    MESHONET_INDEPENDENT
    for (ptrdiff_t m = 0; m < count; m++) {
        const SolidEdges e = solid_edges(&own, start + m);
        const double least = bezier_least(&e, p);
        at->bezier[m] = p == 0 ? least : smaller(at->bezier[m], least);
    }
}

MESHONET_INLINE void solid_angles(SolidBlock *restrict at, ptrdiff_t count, ptrdiff_t stride, double *restrict out)
{
    double *restrict widest = out + SOLID_MAX_ANGLE * stride, *restrict narrowest = out + SOLID_MIN_ANGLE * stride;
    double *restrict skewness = out + SOLID_SKEWNESS * stride, *restrict deviation = out + SOLID_DEVIATION * stride;
    double *restrict orthogonality = out + SOLID_ORTHOGONALITY * stride;
    for (ptrdiff_t m = 0; m < count; m++)
        widest[m] = angle(at->wide[m]);
    for (ptrdiff_t m = 0; m < count; m++)
        narrowest[m] = angle(at->narrow[m]);
    for (ptrdiff_t m = 0; m < count; m++)
        orthogonality[m] = angle(at->cross[m]);
    for (ptrdiff_t m = 0; m < count; m++)
        skewness[m] = larger(widest[m] - 90.0, 90.0 - narrowest[m]) * (1.0 / 90.0);
    for (ptrdiff_t m = 0; m < count; m++)
        deviation[m] = 90.0;
    for (int corner = 0; corner < 8; corner++)
        for (ptrdiff_t m = 0; m < count; m++)
            deviation[m] -= 0.125 * angle(at->off[corner][m]);
}

MESHONET_INLINE void solid_volume_ratio(const double *restrict v, const ptrdiff_t beside[2], ptrdiff_t cells,
                                        double *restrict ratio)
{
    const double *restrict west = v - beside[0], *restrict east = v + beside[0];
    const double *restrict south = v - beside[1], *restrict north = v + beside[1];
    for (ptrdiff_t k = 0; k < cells; k++) {
        const double high = larger(larger(larger(west[k], east[k]), larger(south[k], north[k])),
                                   larger(larger(v[k - 1], v[k + 1]), v[k]));
        const double low = smaller(smaller(smaller(west[k], east[k]), smaller(south[k], north[k])),
                                   smaller(smaller(v[k - 1], v[k + 1]), v[k]));
        ratio[k] = smaller(larger(high / larger(v[k], SMALL), v[k] / larger(low, SMALL)), LARGE);
    }
}

MESHONET_CLONES
void solid_row(const SolidLines *lines, const SolidLengths *inverse, const double *volumes, const ptrdiff_t beside[2],
               ptrdiff_t cells, ptrdiff_t stride, double *out)
{
    SolidBlock at;
    for (ptrdiff_t start = 0; start < cells; start += BLOCK) {
        const ptrdiff_t count = cells - start < BLOCK ? cells - start : BLOCK;
        double *restrict scaled = out + SOLID_SCALED_JACOBIAN * stride + start;
        double *restrict jacobians = out + SOLID_JACOBIAN_RATIO * stride + start;
        double *restrict bezier = out + SOLID_BEZIER_RATIO * stride + start;
        solid_corner(lines, inverse, 0, 0, 0, start, count, &at);
        solid_corner(lines, inverse, 0, 0, 1, start, count, &at);
        solid_corner(lines, inverse, 0, 1, 0, start, count, &at);
        solid_corner(lines, inverse, 0, 1, 1, start, count, &at);
        solid_corner(lines, inverse, 1, 0, 0, start, count, &at);
        solid_corner(lines, inverse, 1, 0, 1, start, count, &at);
        solid_corner(lines, inverse, 1, 1, 0, start, count, &at);
        solid_corner(lines, inverse, 1, 1, 1, start, count, &at);
        solid_axes(lines, start, count, &at, out + SOLID_ASPECT_RATIO * stride + start);
        solid_bezier(lines, 0, start, count, &at);
        solid_bezier(lines, 1, start, count, &at);
        solid_bezier(lines, 2, start, count, &at);
        solid_angles(&at, count, stride, out + start);
        for (ptrdiff_t m = 0; m < count; m++) {
            const double most = 1.0 / larger(at.most[m], SMALL);
            scaled[m] = at.scaled[m];
            jacobians[m] = at.least[m] * most;
            bezier[m] = at.bezier[m] * most;
        }
    }
    solid_volume_ratio(volumes, beside, cells, out + SOLID_VOLUME_RATIO * stride);
}
