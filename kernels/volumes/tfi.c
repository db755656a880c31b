/* Transfinite interpolation of six faces, with a spline added: one pass, at the speed of memory.

   At node (i, j, k) each direction has a parameter, of the four laws of its edges blended with the mean laws of the two
   other directions:
       ξ = Σ b_m u_m(i), η = Σ b_m v_m(j), ζ = Σ b_m w_m(k),    b_m bilinear in the means of (v, w), (u, w), (u, v).
   A law reaches its own edge exactly, whatever the others are. For fixed i and j all weights are linear in w̄(k), and the
   Boolean sum of the three directions is, row by row, with A to G the faces west, east, south, north, bottom, top and
   E the edges along zeta:
       x = A + ξ (B - A) + C + η (D - C) - (1-ξ)(1-η) E00 - ξ (1-η) E10 - (1-ξ) η E01 - ξ η E11 + (1-ζ) l + ζ h,
   where l and h are what the first part misses at bottom and top: bilinear in ξ and η. Where all four laws of each
   direction are equal, ξ and η are the same all along a row, and fewer terms are left.

   Rows are in whole vectors of LANES, in scratch; of the faces west and east as many rows at a time as the second cache
   holds for all planes i.

   Soni, AIAA paper 85-1526 (1985), is the source of laws by arc length; the iteration to their common point is not
   needed: any smooth parameters that agree on the edges interpolate all faces. */
#include "tfi.h"
#include "clones.h"
#include "lanes.h"
#include "team.h"
#include <stdlib.h>
#include <string.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#define WRITTEN_AROUND ((size_t)1 << 23) /* doubles above which nodes are written past the caches */
#define HELD 60000                       /* doubles of faces that stay in the second cache */

enum { ALONG = 3, SIDES = 3, ROWS = ALONG + 3 * SIDES + 3 }; /* ξ η ζ; three a coordinate; results */

typedef struct {
    double *nodes;
    const Volume *v;
    const Faces *f;
    const Laws *laws;
    const Spline3 *spline;
    const double *west, *east; /* west - E00 and (east - west) - (E10 - E00): (3, n2, width) */
    const double *means;       /* of the laws along xi, eta and zeta; then the latter as in `Bilinear` */
    double *rooms;             /* a scratch for each member */
    ptrdiff_t width;           /* n3 in whole vectors */
    int around, separable;
} Interpolation;

/* Write a row to memory, past the caches if `around`. */
MESHONET_INLINE void write_row(double *restrict to, const double *restrict row, ptrdiff_t n, int around)
{
#if defined(__SSE2__)
    if (around && ((size_t)to & 7) == 0) {
        ptrdiff_t k = 0;
        for (; k < n && ((size_t)(to + k) & 63); k++)
            to[k] = row[k];
        for (; k + 8 <= n; k += 8)
            for (int l = 0; l < 8; l += 2)
                _mm_stream_pd(to + k + l, _mm_loadu_pd(row + k + l));
        for (; k < n; k++)
            to[k] = row[k];
        return;
    }
#endif
    memcpy(to, row, (size_t)n * sizeof *to);
    (void)around;
}

/* Four values at the corners of a square, as a + b s + c t + d s t. */
typedef struct {
    double a, b, c, d;
} Bilinear;

MESHONET_INLINE Bilinear law_at(const double *laws, ptrdiff_t n, ptrdiff_t at)
{
    const double a = laws[at], b = laws[n + at], c = laws[2 * n + at], d = laws[3 * n + at];
    return (Bilinear){a, b - a, c - a, (d - c) - (b - a)};
}

/* The plane of the spline's coefficients at i, three coordinates of (m2, m3). */
MESHONET_INLINE void spline_plane(const Spline3 *s, ptrdiff_t i, double *restrict plane)
{
    const ptrdiff_t size = s->m2 * s->m3;
    const double *w = s->weights[0] + 4 * i;
    for (int c = 0; c < 3; c++) {
        const double *restrict p = s->coefficients + (c * s->m1 + s->first[0][i]) * size;
        double *restrict to = plane + c * size;
        for (ptrdiff_t k = 0; k < size; k++)
            to[k] = w[0] * p[k] + w[1] * p[size + k] + w[2] * p[2 * size + k] + w[3] * p[3 * size + k];
    }
}

/* row += the spline at the nodes (i, j), by its coefficients along zeta there. */
MESHONET_INLINE void add_spline(const Spline3 *s, const double *restrict plane, ptrdiff_t j, ptrdiff_t n,
                                double *restrict line, double *restrict row)
{
    const double *w = s->weights[1] + 4 * j, *restrict p = plane + s->first[1][j] * s->m3;
    const ptrdiff_t m = s->m3, *restrict first = s->first[2];
    const double *restrict a = s->weights[2], *restrict b = a + n, *restrict c = b + n, *restrict d = c + n;
    for (ptrdiff_t k = 0; k < m; k++)
        line[k] = w[0] * p[k] + w[1] * p[m + k] + w[2] * p[2 * m + k] + w[3] * p[3 * m + k];
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 1; k < n - 1; k++) {
        const double *q = line + first[k];
        row[k] += a[k] * q[0] + b[k] * q[1] + c[k] * q[2] + d[k] * q[3];
    }
}

/* A node of bottom or top minus the interpolation of the sides, in ξ and η; k is its place in rows. */
MESHONET_INLINE Bilinear missing(double face, const double *west, const double *east, const double *rows,
                                 ptrdiff_t width, ptrdiff_t k)
{
    return (Bilinear){face - west[k] - rows[k], -east[k], -rows[width + k], rows[2 * width + k]};
}

/* One coordinate of a row; `along` are ξ, η and ζ, `rows` the south's C, (D - C) - (E01 - E00), E11 - E10 - E01 + E00. */
MESHONET_INLINE void general_row(const double *west, const double *east, const double *rows, const double *along,
                                 Bilinear l, Bilinear r, ptrdiff_t width, double *to)
{
    for (ptrdiff_t k = 0; k < width; k += LANES) {
        const Lanes s = OF(along + k), t = OF(along + width + k), z = OF(along + 2 * width + k);
        const Lanes low = l.a + l.c * t + s * (l.b + l.d * t), rise = r.a + r.c * t + s * (r.b + r.d * t);
        const Lanes sides = OF(west + k) + s * (OF(east + k) - t * OF(rows + 2 * width + k));
        AT(to + k) = sides + OF(rows + k) + t * OF(rows + width + k) + (low + z * rise);
    }
}

/* The same with ξ and η that are constant along the row; E11 - ... has gone into the second of `rows`. */
MESHONET_INLINE void separable_row(const double *west, const double *east, const double *rows, const double *zeta,
                                   double s, double t, double low, double rise, ptrdiff_t width, double *to)
{
    for (ptrdiff_t k = 0; k < width; k += LANES)
        AT(to + k) = OF(west + k) + s * OF(east + k) + (OF(rows + k) + t * OF(rows + width + k)) +
                     (low + rise * OF(zeta + k));
}

/* `rows` of a coordinate at i. */
MESHONET_INLINE void side_rows(const Interpolation *p, ptrdiff_t i, ptrdiff_t c, double *restrict rows)
{
    const ptrdiff_t n3 = p->v->n3, face = p->v->n2 * n3, width = p->width;
    const double *south = p->f->south + (c * p->v->n1 + i) * n3, *north = p->f->north + (c * p->v->n1 + i) * n3;
    const double *e00 = p->f->west + c * face, *e01 = e00 + face - n3;
    const double *e10 = p->f->east + c * face, *e11 = e10 + face - n3;
    const double s = p->separable ? p->means[i] : 0.0;
    for (ptrdiff_t k = 0; k < n3; k++) {
        const double bend = (e11[k] - e01[k]) - (e10[k] - e00[k]);
        rows[k] = south[k];
        rows[width + k] = (north[k] - south[k]) - (e01[k] - e00[k]) - s * bend;
        rows[2 * width + k] = bend;
    }
}

/* ξ, η and ζ along the row (i, j). */
MESHONET_INLINE void along_row(const Interpolation *p, ptrdiff_t i, ptrdiff_t j, double *restrict along)
{
    const ptrdiff_t n1 = p->v->n1, n2 = p->v->n2, n3 = p->v->n3, width = p->width;
    const double *restrict mean = p->means + n1 + n2, *restrict z = mean + n3;
    const Bilinear u = law_at(p->laws->xi, n1, i), v = law_at(p->laws->eta, n2, j);
    const double s = p->means[i], t = p->means[n1 + j], both = s * t;
    const double u0 = u.a + u.b * t, u1 = u.c + u.d * t, v0 = v.a + v.b * s, v1 = v.c + v.d * s;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n3; k++) {
        along[k] = u0 + u1 * mean[k], along[width + k] = v0 + v1 * mean[k];
        along[2 * width + k] = (z[k] + s * z[n3 + k]) + (t * z[2 * n3 + k] + both * z[3 * n3 + k]);
    }
}

/* Rows first to last (excluded) of the plane i. */
MESHONET_CLONES
static void fill_rows(const Interpolation *p, ptrdiff_t i, ptrdiff_t first, ptrdiff_t last, double *room)
{
    const ptrdiff_t n1 = p->v->n1, n2 = p->v->n2, n3 = p->v->n3, width = p->width;
    double *along = room, *rows = along + ALONG * width, *results = rows + 3 * SIDES * width;
    double *line = results + 3 * width, *plane = line + (p->spline ? p->spline->m3 : 0);
    for (ptrdiff_t c = 0; c < 3; c++)
        side_rows(p, i, c, rows + c * SIDES * width);
    if (p->spline)
        spline_plane(p->spline, i, plane);
    for (ptrdiff_t k = 0; p->separable && k < n3; k++)
        along[2 * width + k] = p->means[n1 + n2 + k];
    for (ptrdiff_t j = first; j < last; j++) {
        const double s = p->means[i], t = p->means[n1 + j];
        if (!p->separable)
            along_row(p, i, j, along);
        for (ptrdiff_t c = 0; c < 3; c++) {
            const double *west = p->west + (c * n2 + j) * width, *east = p->east + (c * n2 + j) * width;
            const double *sides = rows + c * SIDES * width;
            const double bottom = p->f->bottom[(c * n1 + i) * n2 + j], top = p->f->top[(c * n1 + i) * n2 + j];
            const Bilinear l = missing(bottom, west, east, sides, width, 0);
            const Bilinear h = missing(top, west, east, sides, width, n3 - 1);
            const Bilinear r = {h.a - l.a, h.b - l.b, h.c - l.c, h.d - l.d};
            double *row = results + c * width, *to = p->nodes + c * p->v->plane + (i * n2 + j) * n3;
            if (p->separable) { /* d is in the second row */
                const double low = l.a + s * l.b + t * l.c;
                separable_row(west, east, sides, along + 2 * width, s, t, low, r.a + s * r.b + t * r.c, width, row);
            } else
                general_row(west, east, sides, along, l, r, width, row);
            if (p->spline)
                add_spline(p->spline, plane + c * p->spline->m2 * p->spline->m3, j, n3, line, row);
            row[0] = bottom, row[n3 - 1] = top;
            write_row(to, row, n3, p->around);
        }
    }
}

static size_t member_room(const Interpolation *p)
{
    const Spline3 *s = p->spline;
    return (size_t)(ROWS * p->width + (s ? (s->m3 + 3 * s->m2 * s->m3 + LANES) / LANES * LANES : 0));
}

static void fill_share(void *data, Member member)
{
    const Interpolation *p = data;
    const ptrdiff_t n1 = p->v->n1, n2 = p->v->n2, n3 = p->v->n3, face = n2 * n3;
    const ptrdiff_t block = HELD / (6 * p->width) + 1;
    double *room = p->rooms + (size_t)member.rank * member_room(p);
    memset(room, 0, member_room(p) * sizeof *room); /* what fills up vectors */
    const Range mine = team_share(n1, member);
    for (ptrdiff_t j = 1; j < n2 - 1; j += block)
        for (ptrdiff_t i = mine.first > 1 ? mine.first : 1; i < mine.last && i < n1 - 1; i++)
            fill_rows(p, i, j, j + block < n2 - 1 ? j + block : n2 - 1, room);
    for (ptrdiff_t c = 0; c < 3; c++)
        for (ptrdiff_t i = mine.first; i < mine.last; i++) {
            double *to = p->nodes + c * p->v->plane + i * face;
            if (i == 0 || i == n1 - 1) {
                memcpy(to, (i ? p->f->east : p->f->west) + c * face, (size_t)face * sizeof *to);
                continue;
            }
            memcpy(to, p->f->south + (c * n1 + i) * n3, (size_t)n3 * sizeof *to);
            memcpy(to + face - n3, p->f->north + (c * n1 + i) * n3, (size_t)n3 * sizeof *to);
        }
#if defined(__SSE2__)
    _mm_sfence();
#endif
}

/* Means of the laws and those along zeta as in `Bilinear`; whether laws are equal. */
static int mean_laws(const Volume *v, const Laws *laws, double *means)
{
    const double *four[3] = {laws->xi, laws->eta, laws->zeta};
    const ptrdiff_t n[3] = {v->n1, v->n2, v->n3};
    int equal = 1;
    for (int d = 0; d < 3; d++)
        for (ptrdiff_t k = 0; k < n[d]; k++) {
            const double *l = four[d] + k;
            *means++ = 0.25 * ((l[0] + l[n[d]]) + (l[2 * n[d]] + l[3 * n[d]]));
            equal = equal && l[0] == l[n[d]] && l[0] == l[2 * n[d]] && l[0] == l[3 * n[d]];
        }
    for (ptrdiff_t k = 0; k < v->n3; k++) {
        const Bilinear z = law_at(laws->zeta, v->n3, k);
        means[k] = z.a, means[v->n3 + k] = z.b, means[2 * v->n3 + k] = z.c, means[3 * v->n3 + k] = z.d;
    }
    return equal;
}

/* West and east in whole vectors, less their edges. */
static void end_faces(const Interpolation *p, double *west, double *east)
{
    const ptrdiff_t n2 = p->v->n2, n3 = p->v->n3;
    for (ptrdiff_t c = 0; c < 3; c++)
        for (ptrdiff_t j = 0; j < n2; j++)
            for (ptrdiff_t k = 0; k < p->width; k++) {
                const ptrdiff_t here = (c * n2 + j) * n3 + k, edge = c * n2 * n3 + k, to = (c * n2 + j) * p->width + k;
                west[to] = k < n3 ? p->f->west[here] - p->f->west[edge] : 0.0;
                east[to] = k < n3 ? (p->f->east[here] - p->f->west[here]) - (p->f->east[edge] - p->f->west[edge]) : 0.0;
            }
}

int tfi_volume(double *nodes, const Volume *v, const Faces *faces, const Laws *laws, const Spline3 *spline, int threads)
{
    const ptrdiff_t width = (v->n3 + LANES - 1) / LANES * LANES;
    const size_t face = 3 * (size_t)(v->n2 * width);
    const size_t lines = (size_t)((v->n1 + v->n2 + 5 * v->n3 + LANES - 1) / LANES * LANES);
    Interpolation p = {.nodes = nodes, .v = v, .f = faces, .laws = laws, .spline = spline, .width = width};
    double *room = malloc((2 * face + lines + (size_t)threads * member_room(&p) + LANES) * sizeof *room);
    if (!room)
        return -1;
    double *memory = room + (LANES - (size_t)room / sizeof *room % LANES) % LANES; /* whole cache lines */
    p.west = memory, p.east = memory + face, p.means = memory + 2 * face, p.rooms = memory + 2 * face + lines;
    p.separable = mean_laws(v, laws, memory + 2 * face);
    p.around = 3 * (size_t)(v->n1 * v->n2 * v->n3) > WRITTEN_AROUND;
    end_faces(&p, memory, memory + face);
    team_run(threads, fill_share, &p);
    free(room);
    return 0;
}
