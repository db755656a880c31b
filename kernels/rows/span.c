#include "span.h"
#include "clones.h"

#define NEWTON 4 /* steps: lines bend little */
#define TILE 8   /* nodes of a level that share lines of the cache */
#define BATCH 64 /* functions at a time: what is kept of them stays in the first cache */

/* Clenshaw, Math. Comp. 9 (1955) 118. */
MESHONET_INLINE void sums_at(const double *restrict c, ptrdiff_t terms, ptrdiff_t n, const double *restrict x,
                             ptrdiff_t count, double *restrict out)
{
    double after[BATCH], here[BATCH];
    const double *last = c + (terms - 1) * n;
    for (ptrdiff_t k = 0; k < count; k++)
        after[k] = 0.0, here[k] = last[k];
    for (ptrdiff_t term = terms - 2; term > 0; term--) {
        const double *own = c + term * n;
        for (ptrdiff_t k = 0; k < count; k++) {
            const double next = (x[k] * here[k] - after[k]) + own[k];
            after[k] = here[k], here[k] = next;
        }
    }
    for (ptrdiff_t k = 0; k < count; k++)
        out[k] = (0.5 * x[k] * here[k] - after[k]) + c[k];
}

MESHONET_CLONES
void chebyshev_sums(const double *c, ptrdiff_t terms, ptrdiff_t n, const double *heights, ptrdiff_t levels,
                    ptrdiff_t lines, double *out)
{
    const ptrdiff_t width = lines > 0 ? n / lines : 1;
    double x[BATCH];
    for (ptrdiff_t first = 0; first < n; first += BATCH) {
        const ptrdiff_t count = n - first < BATCH ? n - first : BATCH;
        for (ptrdiff_t level = 0; level < levels; level++) {
            const double *h = heights + level * lines + first / width;
            for (ptrdiff_t k = 0, of_line = first % width; k < count; k++) {
                x[k] = 4.0 * *h - 2.0;
                if (++of_line == width)
                    of_line = 0, h++;
            }
            sums_at(c + first, terms, n, x, count, out + level * n + first);
        }
    }
}

MESHONET_CLONES
void way_ahead(const double *behind, const double *slope, const double *keys, ptrdiff_t count, ptrdiff_t n, double *parts)
{
    double x[BATCH], off[BATCH], by[BATCH], part[BATCH];
    for (ptrdiff_t first = 0; first < n; first += BATCH) {
        const ptrdiff_t width = n - first < BATCH ? n - first : BATCH;
        for (ptrdiff_t key = 0; key < count; key++) {
            for (ptrdiff_t k = 0; k < width; k++)
                part[k] = keys[key];
            for (int step = 0; step < NEWTON; step++) {
                for (ptrdiff_t k = 0; k < width; k++)
                    x[k] = 4.0 * part[k] - 2.0;
                sums_at(behind + first, count, n, x, width, off);
                sums_at(slope + first, count, n, x, width, by);
                for (ptrdiff_t k = 0; k < width; k++) {
                    const double to = part[k] - (part[k] + off[k] - keys[key]) / by[k];
                    part[k] = to < 0.0 ? 0.0 : to > 1.0 ? 1.0 : to;
                }
            }
            for (ptrdiff_t k = 0; k < width; k++)
                parts[key * n + first + k] = part[k] - keys[key];
        }
    }
}

void stacked_block(const double *nodes, ptrdiff_t levels, ptrdiff_t count, const ptrdiff_t *ids, ptrdiff_t n, double *block)
{
    for (ptrdiff_t first = 0; first < n; first += TILE)
        for (ptrdiff_t level = 0; level < levels; level++)
            for (ptrdiff_t k = first; k < n && k < first + TILE; k++) {
                const double *from = nodes + 3 * (level * count + ids[k]);
                for (int c = 0; c < 3; c++)
                    block[(c * n + k) * levels + level] = from[c];
            }
}
