/* The functional, with u and v the edges along xi and eta at a cell's corner, or their means at its centre,
   g = |u|², h = |v|², J = u × v, χ = J (or (J + √(J² + ε²)) / 2 when regularised):

       E = mean over cells of ( mean over corners + 2 at the centre ) / 3 of
               (1-w) (a g + h/a) / (2χ) + w (g h / χ²)²
         + β mean over cells of the squares of (ni-1) Δ_i log l and (nj-1) Δ_j log l, l the edge lengths

   Δ_i and Δ_j are differences to the next edge of the same family, with weight one half along the boundary. Angle
   terms are reduced where the boundary turns sharply. Rows of forces are stored in buffers, then added to the nodes. */
#pragma once
#include "corner.h"
#include "sums.h"
#include "variational.h"

/* Forces on the four edges of each cell of a row, in x and y, its smallest Jacobian and its energy. */
typedef struct {
    double *sx, *sy, *nx, *ny, *wx, *wy, *ex, *ey, *least, *energy;
} CellRow;

MESHONET_INLINE double cell_row(const double *restrict xa, const double *restrict ya, const double *restrict xb,
                                const double *restrict yb, ptrdiff_t cells, const Factors *at_corner,
                                const Factors *at_centre, int regular, const CellRow *row)
{
    double *restrict sx = row->sx, *restrict sy = row->sy, *restrict nx = row->nx, *restrict ny = row->ny;
    double *restrict wx = row->wx, *restrict wy = row->wy, *restrict ex = row->ex, *restrict ey = row->ey;
    double *restrict least = row->least, *restrict energy = row->energy;
    const Factors f = *at_corner, fm = *at_centre;
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < cells; j++) {
        const double south_x = xb[j] - xa[j], south_y = yb[j] - ya[j];
        const double north_x = xb[j + 1] - xa[j + 1], north_y = yb[j + 1] - ya[j + 1];
        const double west_x = xa[j + 1] - xa[j], west_y = ya[j + 1] - ya[j];
        const double east_x = xb[j + 1] - xb[j], east_y = yb[j + 1] - yb[j];
        const Corner a = corner(south_x, south_y, west_x, west_y, &f, regular);
        const Corner b = corner(south_x, south_y, east_x, east_y, &f, regular);
        const Corner c = corner(north_x, north_y, east_x, east_y, &f, regular);
        const Corner d = corner(north_x, north_y, west_x, west_y, &f, regular);
        const Corner m = corner(south_x + north_x, south_y + north_y, west_x + east_x, west_y + east_y, &fm, regular);
        energy[j] = ((a.energy + b.energy) + (c.energy + d.energy)) + m.energy;
        const double south = a.jacobian < b.jacobian ? a.jacobian : b.jacobian;
        const double north = c.jacobian < d.jacobian ? c.jacobian : d.jacobian;
        least[j] = south < north ? south : north;
        sx[j] = a.du_x + b.du_x + m.du_x, sy[j] = a.du_y + b.du_y + m.du_y;
        nx[j] = c.du_x + d.du_x + m.du_x, ny[j] = c.du_y + d.du_y + m.du_y;
        wx[j] = a.dv_x + d.dv_x + m.dv_x, wy[j] = a.dv_y + d.dv_y + m.dv_y;
        ex[j] = b.dv_x + c.dv_x + m.dv_x, ey[j] = b.dv_y + c.dv_y + m.dv_y;
    }
    return sum_of(energy, cells);
}

/* An edge force pushes its end node and pulls its start node; one coordinate of one row of cells. */
MESHONET_INLINE void scatter(const double *restrict s, const double *restrict n, const double *restrict w,
                             const double *restrict e, double *restrict ga, double *restrict gb, ptrdiff_t cells)
{
    ga[0] -= s[0] + w[0], gb[0] += s[0] - e[0];
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 1; j < cells; j++) {
        ga[j] += (w[j - 1] - n[j - 1]) - (s[j] + w[j]);
        gb[j] += (n[j - 1] + e[j - 1]) + (s[j] - e[j]);
    }
    ga[cells] += w[cells - 1] - n[cells - 1], gb[cells] += n[cells - 1] + e[cells - 1];
}

/* Half the logarithm of |edge|² and its inverse, for one row of edges; `next` is the offset of an edge's end. */
MESHONET_INLINE void measure_row(const double *restrict x, const double *restrict y, ptrdiff_t next, ptrdiff_t n,
                                 double *restrict length, double *restrict inverse)
{
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < n; j++) {
        const double dx = x[j + next] - x[j], dy = y[j + next] - y[j];
        length[j] = 0.5 * logarithm(dx * dx + dy * dy, inverse + j);
    }
}

/* Push the two nodes of each edge of a row by its force over l², times the edge; `force` has room for 3 n. */
MESHONET_INLINE void push_row(const double *restrict x, const double *restrict y, ptrdiff_t next, ptrdiff_t n,
                              double *restrict force, const double *restrict inverse, double *restrict gx,
                              double *restrict gy)
{
    double *restrict fx = force + n, *restrict fy = force + 2 * n;
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < n; j++) {
        const double f = force[j] * inverse[j];
        fx[j] = f * (x[j + next] - x[j]), fy[j] = f * (y[j + next] - y[j]);
    }
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < n; j++)
        gx[j] -= fx[j], gy[j] -= fy[j];
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < n; j++)
        gx[j + next] += fx[j], gy[j + next] += fy[j];
}

/* One family of edges, (rows, n) of them; those along xi (`next` > 1) wrap around when periodic. `length` and
   `inverse` hold rows * n doubles. */
typedef struct {
    ptrdiff_t nj, rows, n, next;
    int periodic;
    double by_i, by_j;
    double *length, *inverse;
} Family;

/* The edge length terms of rows `first` to before `last` of a family, to the gradient of the nodes from row `first` on.
   `length` and `inverse` hold the measures of all rows, `force` room for 3 n. */
MESHONET_INLINE void length_rows(const double *x, const double *y, const Family *f, const int next, ptrdiff_t first,
                                 ptrdiff_t last, double *gx, double *gy, double *energies, double *restrict force)
{
    const ptrdiff_t n = f->n, nj = f->nj, rows = f->rows;
    const double by_i = f->by_i, by_j = f->by_j;
    const double *length = f->length, *inverse = f->inverse;
    const int along_i = next != 1, periodic = f->periodic;
    double *restrict change = force + n; /* to the next edge; room that the push of a row takes later */
    for (ptrdiff_t i = first; i < last; i++, gx += nj, gy += nj) {
        const double *restrict l = length + i * n;
        const double *restrict west = i > 0 ? l - n : along_i && periodic ? length + (rows - 1) * n : l;
        const double *restrict east = i < rows - 1 ? l + n : along_i && periodic ? length : l;
        const double on_rim = !along_i && (i == 0 || i == rows - 1) ? 0.5 * by_j : by_j;
        MESHONET_INDEPENDENT
        for (ptrdiff_t j = 0; j < n; j++) {
            change[j] = east[j] - l[j];
            force[j] = 2.0 * by_i * ((l[j] - west[j]) - change[j]);
        }
        double sum_i = product_of(change, change, n);
        if (along_i) {
            const double start = east[0] - l[0], end = east[n - 1] - l[n - 1];
            sum_i -= 0.5 * (start * start + end * end);
        }
        MESHONET_INDEPENDENT
        for (ptrdiff_t j = 0; j < n - 1; j++)
            change[j] = l[j + 1] - l[j];
        const double sum_j = product_of(change, change, n - 1);
        MESHONET_INDEPENDENT
        for (ptrdiff_t j = 1; j < n - 1; j++)
            force[j] += 2.0 * on_rim * (2.0 * l[j] - l[j - 1] - l[j + 1]);
        if (n > 1) {
            force[0] -= 2.0 * on_rim * (l[1] - l[0]);
            force[n - 1] += 2.0 * on_rim * (l[n - 1] - l[n - 2]);
        }
        energies[i] = by_i * sum_i + on_rim * sum_j;
        push_row(x + i * nj, y + i * nj, along_i ? nj : 1, n, force, inverse + i * n, gx, gy);
    }
}

/* Take away from the energy what the corners at nodes (i, 0) do not keep of their angle terms, w over the number of
   corners each; the only free node that it moves is (i, 1). */
MESHONET_INLINE double relieve(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const Weights *weights,
                               double angle, double *gx, double *gy)
{
    double energy = 0.0;
    for (ptrdiff_t i = weights->periodic ? 0 : 1; i < ni - 1; i++) {
        if (!(weights->relief[i] < 1.0))
            continue;
        const Factors f = {0.0, 0.0, angle * (1.0 - weights->relief[i]), 0.0};
        const ptrdiff_t k = i * nj, east = k + nj, west = i > 0 ? k - nj : (ni - 2) * nj;
        const double vx = x[k + 1] - x[k], vy = y[k + 1] - y[k];
        const Corner a = corner(x[east] - x[k], y[east] - y[k], vx, vy, &f, 0);
        const Corner b = corner(x[k] - x[west], y[k] - y[west], vx, vy, &f, 0);
        energy += a.energy + b.energy;
        gx[k + 1] -= a.dv_x + b.dv_x, gy[k + 1] -= a.dv_y + b.dv_y;
    }
    return energy;
}

/* Zero at fixed nodes; with periodic rows the last row is the first. */
MESHONET_INLINE void clear_rim(double *g, ptrdiff_t ni, ptrdiff_t nj, int periodic)
{
    double *last = g + (ni - 1) * nj;
    for (ptrdiff_t j = 0; j < nj; j++) {
        g[j] = periodic ? g[j] + last[j] : 0.0;
        last[j] = 0.0;
    }
    for (ptrdiff_t i = 0; i < ni; i++)
        g[i * nj] = g[i * nj + nj - 1] = 0.0;
}
