#include "span.h"
#include "clones.h"

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
