#include "tally.h"

#include "angles.h"

#define LANES 16

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

ptrdiff_t value_place(const double *row, ptrdiff_t cells, double value)
{
    ptrdiff_t j = 0;
    while (j < cells - 1 && row[j] != value)
        ++j;
    return j;
}
