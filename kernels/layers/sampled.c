#include "sampled.h"

/* Tangents (m, size) at the nodes of a line. */
static void tangents(const double *line, const double *arc, ptrdiff_t m, ptrdiff_t size, double *slope)
{
    for (ptrdiff_t c = 0; c < size; c++) {
        double h = arc[1] - arc[0], rise = (line[size + c] - line[c]) / h;
        const double first = rise;
        for (ptrdiff_t j = 1; j < m - 1; j++) {
            const double *here = line + size * j + c;
            const double next = arc[j + 1] - arc[j], after = (here[size] - here[0]) / next;
            slope[size * j + c] = (rise * next + after * h) / (h + next);
            h = next, rise = after;
        }
        slope[c] = 2.0 * first - slope[size + c];
        slope[size * (m - 1) + c] = 2.0 * rise - slope[size * (m - 2) + c];
    }
}

void sampled_lines(const NodeLines *all, const double *at, ptrdiff_t count, double *points, double *slopes)
{
    const ptrdiff_t m = all->nodes, size = all->size;
    for (ptrdiff_t k = 0; k < all->lines; k++, at += count, points += size * count) {
        const double *line = all->node + size * m * k, *arc = all->arc + m * k;
        ptrdiff_t piece = 0;
        tangents(line, arc, m, size, slopes);
        for (ptrdiff_t j = 0; j < count; j++) {
            while (piece < m - 2 && arc[piece + 1] <= at[j])
                piece++;
            while (piece > 0 && arc[piece] > at[j])
                piece--;
            const double step = arc[piece + 1] - arc[piece], q = (at[j] - arc[piece]) / step;
            const double side = q * (1.0 - q) * step, part = q * q * (3.0 - 2.0 * q);
            const double *start = line + size * piece, *slope = slopes + size * piece;
            for (ptrdiff_t c = 0; c < size; c++) {
                const double bend = side * ((1.0 - q) * slope[c] - q * slope[size + c]);
                points[size * j + c] = start[c] + part * (start[size + c] - start[c]) + bend;
            }
        }
        for (ptrdiff_t c = 0; c < size; c++)
            points[c] = line[c], points[size * (count - 1) + c] = line[size * (m - 1) + c];
    }
}
