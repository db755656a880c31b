#include "tally.h"

#include "angles.h"

#define LANES 16
#define BLOCK 128 /* values at a time */

MESHONET_CLONES
void values_reduce(const double *restrict row, ptrdiff_t cells, double *low, double *high, double *sum)
{
    double lows[LANES], highs[LANES], sums[LANES];
    ptrdiff_t j = 0;
    for (int lane = 0; lane < LANES; ++lane) {
        lows[lane] = highs[lane] = row[0];
        sums[lane] = 0;
    }
    for (; j + LANES <= cells; j += LANES)
        for (int lane = 0; lane < LANES; ++lane) {
            double value = row[j + lane];
            lows[lane] = smaller(value, lows[lane]);
            highs[lane] = larger(value, highs[lane]);
            sums[lane] += value;
        }
    for (; j < cells; ++j) {
        lows[0] = smaller(row[j], lows[0]);
        highs[0] = larger(row[j], highs[0]);
        sums[0] += row[j];
    }
    for (int lane = 1; lane < LANES; ++lane) {
        lows[0] = smaller(lows[lane], lows[0]);
        highs[0] = larger(highs[lane], highs[0]);
        sums[0] += sums[lane];
    }
    *low = lows[0];
    *high = highs[0];
    *sum = sums[0];
}

MESHONET_CLONES
ptrdiff_t values_catch(const double *restrict row, ptrdiff_t cells, double from, double to, int64_t counts[4],
                      double *restrict caught, ptrdiff_t room)
{
    ptrdiff_t found = 0;
    for (ptrdiff_t start = 0; start < cells; start += BLOCK) {
        const ptrdiff_t count = cells - start < BLOCK ? cells - start : BLOCK;
        int64_t a = 0, b = 0, c = 0, d = 0;
        for (ptrdiff_t j = start; j < start + count; ++j) {
            a += row[j] < from;
            b += row[j] <= from;
            c += row[j] < to;
            d += row[j] <= to;
        }
        counts[0] += a;
        counts[1] += b;
        counts[2] += c;
        counts[3] += d;
        for (ptrdiff_t j = start; c > b && j < start + count; ++j)
            if (row[j] > from && row[j] < to) {
                if (found < room)
                    caught[found] = row[j];
                ++found;
            }
    }
    return found;
}
