#include "cells.h"

#include <string.h>

#include "angles.h"
#include "tally.h"
#include "team.h"

/* A cell and its edges; i runs along e0, j against e3:

       d --e2-- c        a = (i, j)    b = (i+1, j)    c = (i+1, j+1)    d = (i, j+1)
       |        |
      e3        e1       the Jacobian at a corner is the cross product of the two edges that meet there:
       |        |        at b  e0 x e1,  at c  e1 x e2,  at d  e2 x e3,  at a  e3 x e0
       a --e0-- b

   Cells of one row are contiguous in j, so every loop below runs over j and the compiler vectorises it. */

#define LARGE 1e30 /* what Verdict puts in place of infinity */
#define SMALL 1e-300 /* keeps a cell without area or edges from a division by 0 */
#define BLOCK 128 /* cells of a row at a time */

/* Folded cells of one row of cells: any corner Jacobian <= 0, or not a number. x, y point at node (i, 0). */
MESHONET_CLONES
static ptrdiff_t cells_folded_in_row(const double *restrict x, const double *restrict y, ptrdiff_t nj, ptrdiff_t cells)
{
    const double *restrict xb = x + nj, *restrict yb = y + nj;
    int64_t good = 0;
    for (ptrdiff_t j = 0; j < cells; ++j) {
        double e0x = xb[j] - x[j], e0y = yb[j] - y[j];
        double e1x = xb[j + 1] - xb[j], e1y = yb[j + 1] - yb[j];
        double e2x = x[j + 1] - xb[j + 1], e2y = y[j + 1] - yb[j + 1];
        double e3x = x[j] - x[j + 1], e3y = y[j] - y[j + 1];
        double ja = e3x * e0y - e3y * e0x, jb = e0x * e1y - e0y * e1x;
        double jc = e1x * e2y - e1y * e2x, jd = e2x * e3y - e2y * e3x;
        good += (ja > 0) & (jb > 0) & (jc > 0) & (jd > 0);
    }
    return cells - (ptrdiff_t)good;
}

typedef struct {
    const double *x, *y;
    ptrdiff_t ni, nj;
    int64_t folded; /* in all rows */
} Count;

static void count_share(void *data, Member member)
{
    Count *count = data;
    const ptrdiff_t nj = count->nj;
    int64_t folded = 0;
    const Range mine = team_share(count->ni - 1, member);
    for (ptrdiff_t i = mine.first; i < mine.last; ++i)
        folded += cells_folded_in_row(count->x + i * nj, count->y + i * nj, nj, nj - 1);
    team_add(&count->folded, folded);
}

ptrdiff_t cells_folded(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, int threads)
{
    Count count = {x, y, ni, nj, 0};
    team_run(threads, count_share, &count);
    return (ptrdiff_t)count.folded;
}

void cells_places(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, int64_t *pairs, ptrdiff_t room)
{
    ptrdiff_t folded = 0;
    for (ptrdiff_t i = 0; i + 1 < ni; ++i, x += nj, y += nj) {
        const ptrdiff_t all = folded + cells_folded_in_row(x, y, nj, nj - 1);
        for (ptrdiff_t j = 0; folded < all && folded < room && j + 1 < nj; ++j)
            if (cells_folded_in_row(x + j, y + j, nj, 1)) {
                pairs[2 * folded] = i;
                pairs[2 * folded++ + 1] = j;
            }
        folded = all;
    }
}

/* Magnitudes of the areas of one row of cells into area[1 ... nj-1]; area[0] and area[nj] repeat their neighbours. */
MESHONET_CLONES
static void cells_areas(const double *restrict x, const double *restrict y, ptrdiff_t nj, double *restrict area)
{
    const double *restrict xb = x + nj, *restrict yb = y + nj;
    for (ptrdiff_t j = 0; j < nj - 1; ++j)
        area[j + 1] = 0.5 * magnitude((xb[j + 1] - x[j]) * (y[j + 1] - yb[j]) - (yb[j + 1] - y[j]) * (x[j + 1] - xb[j]));
    area[0] = area[1];
    area[nj] = area[nj - 1];
}

/* What the corners of one cell say; a block of cells goes through it and through the angles in turn, since one
   loop with everything in it is more than the compiler vectorises. */
struct corners {
    double inner[BLOCK], outer[BLOCK], cross[BLOCK], jacobian[BLOCK], product[BLOCK];
};

/* Corners of `cells` cells: cosines of the least angle and of the turn at the greatest, of the crossing of the
   grid lines, the least Jacobian, and the metrics that need no angle. */
MESHONET_INLINE void corners(const double *restrict x, const double *restrict y, const double *restrict xb,
                             const double *restrict yb, ptrdiff_t cells, struct corners *restrict at,
                             double *restrict scaled, double *restrict aspect)
{
    for (ptrdiff_t j = 0; j < cells; ++j) {
        double e0x = xb[j] - x[j], e0y = yb[j] - y[j];
        double e1x = xb[j + 1] - xb[j], e1y = yb[j + 1] - yb[j];
        double e2x = x[j + 1] - xb[j + 1], e2y = y[j + 1] - yb[j + 1];
        double e3x = x[j] - x[j + 1], e3y = y[j] - y[j + 1];

        double ja = e3x * e0y - e3y * e0x, jb = e0x * e1y - e0y * e1x;
        double jc = e1x * e2y - e1y * e2x, jd = e2x * e3y - e2y * e3x;
        double l0 = __builtin_sqrt(e0x * e0x + e0y * e0y), l1 = __builtin_sqrt(e1x * e1x + e1y * e1y);
        double l2 = __builtin_sqrt(e2x * e2x + e2y * e2y), l3 = __builtin_sqrt(e3x * e3x + e3y * e3y);

        /* one division for all four corners, whose products of lengths share these two */
        double la = l3 * l0, lc = l1 * l2, lb = l0 * l1, ld = l2 * l3;
        double product = la * lc, r = 1.0 / larger(product, SMALL);
        double ra = lc * r, rb = ld * r, rc = la * r, rd = lb * r;
        double ca = (e3x * e0x + e3y * e0y) * ra, cb = (e0x * e1x + e0y * e1y) * rb;
        double cc = (e1x * e2x + e1y * e2y) * rc, cd = (e2x * e3x + e2y * e3y) * rd;
        at->inner[j] = -smaller(smaller(ca, cb), smaller(cc, cd));
        at->outer[j] = larger(larger(ca, cb), larger(cc, cd));
        at->product[j] = product;
        at->jacobian[j] = smaller(smaller(ja, jb), smaller(jc, jd));
        scaled[j] = smaller(smaller(ja * ra, jb * rb), smaller(jc * rc, jd * rd));

        double four_areas = 2.0 * magnitude(jb + jd);
        double longest = larger(larger(l0, l1), larger(l2, l3));
        aspect[j] = smaller(longest * (l0 + l1 + l2 + l3) / larger(four_areas, SMALL), LARGE);

        /* principal axes: twice the lines that join the middles of opposite edges */
        double ux = e0x - e2x, uy = e0y - e2y, vx = e1x - e3x, vy = e1y - e3y;
        double uv = __builtin_sqrt((ux * ux + uy * uy) * (vx * vx + vy * vy));
        at->cross[j] = magnitude(ux * vx + uy * vy) / larger(uv, SMALL);
    }
}

/* All metrics of one row of cells into out[metric * (nj-1) + j].

   before, here, after: areas of this row of cells and of its neighbours, from cells_areas. An edge of no length
   has no direction: such a cell has angles of 0 and 180 degrees and a scaled Jacobian of 0. */
MESHONET_CLONES
static void cells_row(const double *restrict x, const double *restrict y, ptrdiff_t nj, const double *restrict before,
               const double *restrict here, const double *restrict after, double *restrict out)
{
    struct corners at;
    const ptrdiff_t cells = nj - 1;
    for (ptrdiff_t start = 0; start < cells; start += BLOCK) {
        const ptrdiff_t count = cells - start < BLOCK ? cells - start : BLOCK;
        double *restrict max_angle = out + MAX_ANGLE * cells + start, *restrict min_angle = out + MIN_ANGLE * cells + start;
        double *restrict skewness = out + SKEWNESS * cells + start;
        double *restrict orthogonality = out + ORTHOGONALITY * cells + start;
        corners(x + start, y + start, x + nj + start, y + nj + start, count, &at,
                out + SCALED_JACOBIAN * cells + start, out + ASPECT_RATIO * cells + start);
        for (ptrdiff_t j = 0; j < count; ++j)
            min_angle[j] = angle(at.inner[j]);
        for (ptrdiff_t j = 0; j < count; ++j)
            orthogonality[j] = angle(at.cross[j]);
        for (ptrdiff_t j = 0; j < count; ++j)
            at.outer[j] = angle(at.outer[j]);
        for (ptrdiff_t j = 0; j < count; ++j) {
            double turn = at.product[j] > 0 ? at.outer[j] : 0.0;
            max_angle[j] = at.jacobian[j] < 0 ? 180.0 + turn : 180.0 - turn;
            min_angle[j] = at.product[j] > 0 ? min_angle[j] : 0.0;
            skewness[j] = larger(max_angle[j] - 90.0, 90.0 - min_angle[j]) * (1.0 / 90.0);
        }
    }
    double *restrict ratio = out + AREA_RATIO * cells;
    for (ptrdiff_t j = 0; j < cells; ++j) {
        double area = here[j + 1];
        double big = larger(larger(larger(before[j + 1], after[j + 1]), larger(here[j], here[j + 2])), area);
        double small = smaller(smaller(smaller(before[j + 1], after[j + 1]), smaller(here[j], here[j + 2])), area);
        ratio[j] = smaller(larger(big / larger(area, SMALL), area / larger(small, SMALL)), LARGE);
    }
}

/* What one thread knows of its rows, and room for one row. */
typedef struct {
    double *areas;   /* of four rows of cells, (nj + 1) each */
    double *metrics; /* (METRICS, cells) */
    double *summary; /* (METRICS, 2): min, max */
    int64_t *where;  /* (METRICS, 2, 2) */
    int64_t *rows;   /* how many */
} Own;

/* A run and what is known of it. */
typedef struct {
    const double *x, *y;
    ptrdiff_t ni, nj;
    const CellRun *run;
    double *sums; /* of each row of cells, (ni - 1, METRICS) */
    double *room;
} Cells;

static size_t member_room(ptrdiff_t nj) { return (size_t)(4 * (nj + 1) + METRICS * (nj - 1) + 6 * METRICS + 1); }

static Own own_of(const Cells *c, int rank)
{
    Own own;
    own.areas = c->room + (size_t)rank * member_room(c->nj);
    own.metrics = own.areas + 4 * (c->nj + 1), own.summary = own.metrics + METRICS * (c->nj - 1);
    own.where = (int64_t *)(own.summary + 2 * METRICS), own.rows = own.where + 4 * METRICS;
    return own;
}

size_t cells_scratch(ptrdiff_t ni, ptrdiff_t nj, int threads)
{
    return (size_t)(METRICS * (ni - 1)) + (size_t)threads * member_room(nj);
}

/* Take the metrics of row i of cells into what the thread knows of those before. */
static void take_row(const Cells *c, const Own *own, ptrdiff_t i)
{
    const ptrdiff_t cells = c->nj - 1;
    const int fresh = !(*own->rows)++;
    double low, high;
    for (ptrdiff_t k = 0; k < METRICS; ++k) {
        const double *row = own->metrics + k * cells;
        double *summary = own->summary + 2 * k;
        int64_t *where = own->where + 4 * k;
        values_reduce(row, cells, &low, &high, c->sums + i * METRICS + k);
        if (fresh || low < summary[0])
            summary[0] = low, where[0] = i, where[1] = value_place(row, cells, low);
        if (fresh || high > summary[1])
            summary[1] = high, where[2] = i, where[3] = value_place(row, cells, high);
    }
}

static void run_rows(const Cells *c, const Own *own, ptrdiff_t first, ptrdiff_t last)
{
    const CellRun *run = c->run;
    const double *x = c->x, *y = c->y;
    const ptrdiff_t ni = c->ni, nj = c->nj, cells = nj - 1, width = nj + 1;
    /* areas of the rows of cells i-1, i, i+1 take turns in buffers 0 to 2; buffer 3 is the row across the seam */
    double *seam = own->areas + 3 * width, *before = own->areas + (first + 2) % 3 * width;
    cells_areas(x + first * nj, y + first * nj, nj, own->areas + first % 3 * width);
    if (first > 0)
        cells_areas(x + (first - 1) * nj, y + (first - 1) * nj, nj, before);
    else if (run->periodic)
        cells_areas(x + (ni - 2) * nj, y + (ni - 2) * nj, nj, before = seam);
    else
        before = own->areas;
    for (ptrdiff_t i = first; i < last; ++i) {
        double *here = own->areas + i % 3 * width, *after = here;
        if (i < ni - 2) {
            after = own->areas + (i + 1) % 3 * width;
            cells_areas(x + (i + 1) * nj, y + (i + 1) * nj, nj, after);
        } else if (run->periodic) {
            after = seam;
            cells_areas(x, y, nj, after);
        }
        if (i < run->wake || i >= ni - 1 - run->wake) { /* cell a is the one on the other side of the wake */
            const double *xa = x + (ni - 2 - i) * nj, *ya = y + (ni - 2 - i) * nj, *xb = xa + nj, *yb = ya + nj;
            here[0] = 0.5 * magnitude((xb[1] - xa[0]) * (ya[1] - yb[0]) - (yb[1] - ya[0]) * (xa[1] - xb[0]));
        }
        cells_row(x + i * nj, y + i * nj, nj, before, here, after, own->metrics);
        before = here;
        take_row(c, own, i);
        for (ptrdiff_t k = 0; k < run->n_kept; ++k)
            memcpy(run->kept + (k * (ni - 1) + i) * cells, own->metrics + (run->keep + k) * cells,
                   (size_t)cells * sizeof(double));
    }
}

static void run_share(void *data, Member member)
{
    const Cells *c = data;
    const Own own = own_of(c, member.rank);
    const Range mine = team_share(c->ni - 1, member);
    if (mine.first < mine.last)
        run_rows(c, &own, mine.first, mine.last);
}

/* Add what a thread knows of its rows to what is known of those before. */
static void add_rows(const CellRun *run, const Own *own, int fresh)
{
    for (ptrdiff_t k = 0; k < METRICS; ++k) {
        double *summary = run->summary + 3 * k;
        int64_t *where = run->where + 4 * k;
        if (fresh || own->summary[2 * k] < summary[0]) {
            summary[0] = own->summary[2 * k];
            memcpy(where, own->where + 4 * k, 2 * sizeof *where);
        }
        if (fresh || own->summary[2 * k + 1] > summary[2]) {
            summary[2] = own->summary[2 * k + 1];
            memcpy(where + 2, own->where + 4 * k + 2, 2 * sizeof *where);
        }
    }
}

/* The means, of the sums of rows in their order. */
static void add_sums(const Cells *c)
{
    double *summary = c->run->summary;
    for (ptrdiff_t k = 0; k < METRICS; ++k)
        summary[3 * k + 1] = 0.0;
    for (ptrdiff_t i = 0; i < c->ni - 1; ++i)
        for (ptrdiff_t k = 0; k < METRICS; ++k)
            summary[3 * k + 1] += c->sums[i * METRICS + k];
    for (ptrdiff_t k = 0; k < METRICS; ++k)
        summary[3 * k + 1] /= (double)((c->ni - 1) * (c->nj - 1));
}

void cells_run(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const CellRun *run, int threads,
               double *scratch)
{
    Cells c = {x, y, ni, nj, run, scratch, scratch + METRICS * (ni - 1)};
    for (int rank = 0; rank < threads; ++rank)
        *own_of(&c, rank).rows = 0;
    team_run(threads, run_share, &c);
    for (int rank = 0, fresh = 1; rank < threads; ++rank) {
        const Own own = own_of(&c, rank);
        if (*own.rows)
            add_rows(run, &own, fresh), fresh = 0;
    }
    add_sums(&c);
}
