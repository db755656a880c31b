#include "law.h"
#include "clones.h"
#include "elementary.h"
#include <math.h>

#define COLUMNS 8  /* that are worked out together, in vectors */
#define PARTIAL 8  /* sums, in which every eighth cell is */
#define STEPS 60   /* of bisection, to round-off */
#define NEWTON 6   /* steps to the root, after which few of bisection are left to do */
#define CLOSE 1e-12 /* change in the last of these, with which they have arrived */
#define STEEPEST 60.0  /* slope */
#define LEAST 1e-200 /* sums whose logarithm is taken */

typedef enum { SLOPE, BEND } Unknown;

MESHONET_INLINE double place(ptrdiff_t row, ptrdiff_t rows)
{
    return (double)row / (double)(rows > 1 ? rows - 1 : 1);
}

/* Add the cells of a row to sums, and to `rises` their derivatives by the unknown. */
MESHONET_INLINE void add_cells(double k, const double *slope, const double *bend, Unknown unknown, double *sum,
                               double *rise)
{
    MESHONET_INDEPENDENT
    for (int l = 0; l < COLUMNS; l++) {
        const double cell = exp_double(slope[l] * k + bend[l] * k * (1.0 - k));
        sum[l] += cell;
        rise[l] += (unknown == SLOPE ? k : k * (1.0 - k)) * cell;
    }
}

/* The sums of all cells, added in a fixed order. */
MESHONET_INLINE void totals(ptrdiff_t rows, const double *slope, const double *bend, Unknown unknown, double *total,
                            double *rise)
{
    const ptrdiff_t whole = rows - rows % PARTIAL;
    double sum[PARTIAL][COLUMNS] = {{0.0}};
    for (int l = 0; l < COLUMNS; l++)
        rise[l] = 0.0;
    for (ptrdiff_t row = 0; row < whole; row++)
        add_cells(place(row, rows), slope, bend, unknown, sum[row % PARTIAL], rise);
    for (int l = 0; l < COLUMNS; l++)
        total[l] = ((sum[0][l] + sum[1][l]) + (sum[2][l] + sum[3][l])) + ((sum[4][l] + sum[5][l]) + (sum[6][l] + sum[7][l]));
    for (ptrdiff_t row = whole; row < rows; row++)
        add_cells(place(row, rows), slope, bend, unknown, total, rise);
}

/* Set the unknown, slope or bend, to where between `low` and `high` the sums are as wanted, or to an end of that.

   Newton's method for the logarithm of the sum, which is nearly linear, tells how most steps of a bisection end. */
MESHONET_INLINE void solve(ptrdiff_t rows, const double *wanted, double *slope, double *bend, Unknown unknown, double low,
                           double high)
{
    double *x = unknown == SLOPE ? slope : bend, total[COLUMNS], rise[COLUMNS], step[COLUMNS];
    double least[COLUMNS], most[COLUMNS], under[COLUMNS], over[COLUMNS];
    for (int l = 0; l < COLUMNS; l++)
        x[l] = larger(low, 0.0), least[l] = low, most[l] = high;
    for (int round = 0; round < NEWTON; round++) {
        totals(rows, slope, bend, unknown, total, rise);
        for (int l = 0; l < COLUMNS; l++) {
            const double to = x[l] + log_double(larger(wanted[l] / total[l], LEAST)) * (total[l] / rise[l]);
            const double inside = larger(smaller(to, high), low);
            step[l] = inside - x[l], x[l] = inside;
        }
    }
    for (int l = 0; l < COLUMNS; l++) {
        const double near = magnitude(step[l]) <= CLOSE * (1.0 + magnitude(x[l])) ? 2.0 * CLOSE * (1.0 + magnitude(x[l])) : high - low;
        under[l] = x[l] - near, over[l] = x[l] + near;
    }
    for (int k = 0; k < STEPS; k++) {
        int open = 0;
        for (int l = 0; l < COLUMNS; l++)
            x[l] = 0.5 * (least[l] + most[l]), open |= x[l] >= under[l] && x[l] <= over[l];
        if (open)
            totals(rows, slope, bend, unknown, total, rise);
        for (int l = 0; l < COLUMNS; l++)
            if (x[l] < under[l] || (x[l] <= over[l] && total[l] < wanted[l]))
                least[l] = x[l];
            else
                most[l] = x[l];
    }
    for (int l = 0; l < COLUMNS; l++)
        x[l] = 0.5 * (least[l] + most[l]);
}

MESHONET_CLONES
static void laws(const double *wanted, double *slope, double *bend, ptrdiff_t rows, double most, double steeper)
{
    double plain[COLUMNS], free[COLUMNS], bound[COLUMNS];
    int changed = 0;
    for (int l = 0; l < COLUMNS; l++)
        bend[l] = 0.0;
    solve(rows, wanted, plain, bend, SLOPE, 0.0, STEEPEST);
    for (int l = 0; l < COLUMNS; l++)
        slope[l] = slope[l] < INFINITY ? smaller(slope[l], STEEPEST) : plain[l];
    solve(rows, wanted, slope, bend, BEND, -4.0 * STEEPEST, 4.0 * STEEPEST);
    for (int l = 0; l < COLUMNS; l++) {
        const double steepest = larger((1.0 + steeper) * plain[l], most), room = smaller(steepest - plain[l], plain[l]);
        const int steep = slope[l] + magnitude(bend[l]) > steepest || slope[l] < magnitude(bend[l]);
        bound[l] = steep ? smaller(larger(bend[l], -room), room) : bend[l]; /* the last cell gives way */
        changed |= bound[l] != bend[l];
        free[l] = slope[l];
    }
    if (changed) {
        solve(rows, wanted, free, bound, SLOPE, -STEEPEST, STEEPEST);
        for (int l = 0; l < COLUMNS; l++)
            slope[l] = bound[l] != bend[l] ? free[l] : slope[l], bend[l] = bound[l];
    }
}

MESHONET_CLONES
void layer_law(const double *wanted, const double *slopes, ptrdiff_t n, ptrdiff_t rows, double most, double steeper,
               double *cells)
{
    double sum[COLUMNS], slope[COLUMNS], bend[COLUMNS];
    for (ptrdiff_t first = 0; first < n; first += COLUMNS) {
        for (ptrdiff_t l = 0; l < COLUMNS; l++) {
            const ptrdiff_t column = first + l < n ? first + l : n - 1;
            sum[l] = wanted[column], slope[l] = slopes[column];
        }
        laws(sum, slope, bend, rows, most, steeper);
        for (ptrdiff_t l = 0; l < COLUMNS && first + l < n; l++)
            for (ptrdiff_t row = 0; row < rows; row++) {
                const double k = place(row, rows);
                cells[(first + l) * rows + row] = exp_double(slope[l] * k + bend[l] * k * (1.0 - k));
            }
    }
}
