/* The functional, with u and v the edges along xi and eta that meet at a cell's corner, g = |u|², h = |v|²,
   J = u × v, χ = J (or (J + √(J² + ε²)) / 2 when regularised):

       E = mean over corners [ (1-w) (a g + h/a) / (2χ) + w (g h / χ²)² ]
         + β mean over edges [ ((ni-1) Δ_i log l)² + ((nj-1) Δ_j log l)² ]

   The second mean is taken over the edges along xi and over those along eta, and both are added; Δ_i and Δ_j are
   the differences to the next edge of the same family in either direction. One row of cells, or of edges, at a time:
   first the forces of each into row buffers, which vectorises, then onto the nodes. */
#include "variational_kernel.h"
#include "clones.h"
#include <math.h>
#include <stdint.h>
#include <string.h>

typedef struct {
    double du_x, du_y, dv_x, dv_y, energy, jacobian;
} Corner;

typedef struct {
    double along, across, angle, eps2; /* (1-w) a / 2, (1-w) / (2a) and w over the number of corners; ε² */
} Factors;

MESHONET_INLINE Corner corner(double ux, double uy, double vx, double vy, const Factors *f, int regular)
{
    Corner c;
    const double g = ux * ux + uy * uy, h = vx * vx + vy * vy;
    c.jacobian = ux * vy - uy * vx;
    const double root = regular ? sqrt(c.jacobian * c.jacobian + f->eps2) : c.jacobian;
    const double inverse = regular ? 2.0 / (c.jacobian + root) : 1.0 / c.jacobian;
    const double chain = regular ? 0.5 * (1.0 + c.jacobian / root) : 1.0; /* dχ/dJ */
    const double harmonic = (f->along * g + f->across * h) * inverse;
    const double squares = inverse * inverse, ratio = g * h * squares, angle = f->angle * ratio * ratio;
    const double by_angle = 2.0 * f->angle * ratio * squares;
    const double by_g = 2.0 * (f->along * inverse + by_angle * h), by_h = 2.0 * (f->across * inverse + by_angle * g);
    const double by_j = -(harmonic + 4.0 * angle) * inverse * chain;
    c.energy = harmonic + angle;
    c.du_x = by_g * ux + by_j * vy, c.du_y = by_g * uy - by_j * vx;
    c.dv_x = by_h * vx - by_j * uy, c.dv_y = by_h * vy + by_j * ux;
    return c;
}

/* Forces on the four edges of each cell of a row, in x and y, and its smallest Jacobian. */
typedef struct {
    double *sx, *sy, *nx, *ny, *wx, *wy, *ex, *ey, *least;
} CellRow;

MESHONET_INLINE double cell_row(const double *restrict xa, const double *restrict ya, const double *restrict xb,
                                const double *restrict yb, ptrdiff_t cells, const Factors *factors, int regular,
                                const CellRow *row)
{
    double *restrict sx = row->sx, *restrict sy = row->sy, *restrict nx = row->nx, *restrict ny = row->ny;
    double *restrict wx = row->wx, *restrict wy = row->wy, *restrict ex = row->ex, *restrict ey = row->ey;
    double *restrict least = row->least;
    const Factors f = *factors;
    double energy = 0.0;
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
        energy += (a.energy + b.energy) + (c.energy + d.energy);
        const double south = a.jacobian < b.jacobian ? a.jacobian : b.jacobian;
        const double north = c.jacobian < d.jacobian ? c.jacobian : d.jacobian;
        least[j] = south < north ? south : north;
        sx[j] = a.du_x + b.du_x, sy[j] = a.du_y + b.du_y;
        nx[j] = c.du_x + d.du_x, ny[j] = c.du_y + d.du_y;
        wx[j] = a.dv_x + d.dv_x, wy[j] = a.dv_y + d.dv_y;
        ex[j] = b.dv_x + c.dv_x, ey[j] = b.dv_y + c.dv_y;
    }
    return energy;
}

/* An edge force pushes its end node and pulls its start node; one coordinate of one row of cells. */
MESHONET_INLINE void scatter(const double *restrict s, const double *restrict n, const double *restrict w,
                             const double *restrict e, double *restrict ga, double *restrict gb, ptrdiff_t cells)
{
    for (ptrdiff_t j = 0; j < cells; j++)
        ga[j] -= s[j] + w[j], gb[j] += s[j] - e[j];
    for (ptrdiff_t j = 0; j < cells; j++)
        ga[j + 1] += w[j] - n[j], gb[j + 1] += n[j] + e[j];
}

/* Natural logarithm of a positive normal number, to 2 units of the last place, without a branch:
   x = 2^k m with m in [√½, √2), log m = 2 artanh s, s = (m - 1) / (m + 1). */
MESHONET_INLINE double logarithm(double x)
{
    uint64_t bits, power;
    double m, k;
    memcpy(&bits, &x, sizeof bits);
    power = (bits - 0x3fe6a09e667f3bcdULL + 0x3ff0000000000000ULL) >> 52; /* k + 1023 */
    bits -= (power << 52) - 0x3ff0000000000000ULL;
    memcpy(&m, &bits, sizeof m);
    power |= 0x4330000000000000ULL; /* 2^52 + k + 1023 as a double */
    memcpy(&k, &power, sizeof k);
    k -= 4503599627371519.0;
    const double s = (m - 1.0) / (m + 1.0), q = s * s;
    double tail = 1.0 / 19.0;
    tail = tail * q + 1.0 / 17.0, tail = tail * q + 1.0 / 15.0, tail = tail * q + 1.0 / 13.0;
    tail = tail * q + 1.0 / 11.0, tail = tail * q + 1.0 / 9.0, tail = tail * q + 1.0 / 7.0;
    tail = tail * q + 1.0 / 5.0, tail = tail * q + 1.0 / 3.0;
    return k * 0.69314718055994530942 + 2.0 * s * (1.0 + q * tail);
}

/* Half the logarithm of |edge|² and its inverse, for one row of edges; `next` is the offset of an edge's end. */
MESHONET_INLINE void measure_row(const double *restrict x, const double *restrict y, ptrdiff_t next, ptrdiff_t n,
                                 double *restrict length, double *restrict inverse)
{
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < n; j++) {
        const double dx = x[j + next] - x[j], dy = y[j + next] - y[j], square = dx * dx + dy * dy;
        length[j] = 0.5 * logarithm(square);
        inverse[j] = 1.0 / square;
    }
}

/* The edge length term of one family of edges: (rows, n) of them, the end of each `next` beyond its start.
   `length` holds rows * n, `inverse` likewise, `force` n doubles. */
MESHONET_INLINE double family(const double *x, const double *y, ptrdiff_t nj, ptrdiff_t rows, ptrdiff_t n,
                              ptrdiff_t next, double across_i, double across_j, double *gx, double *gy,
                              double *length, double *inverse, double *restrict force)
{
    double energy = 0.0;
    for (ptrdiff_t i = 0; i < rows; i++)
        measure_row(x + i * nj, y + i * nj, next, n, length + i * n, inverse + i * n);
    for (ptrdiff_t i = 0; i < rows; i++) {
        const double *restrict l = length + i * n, *restrict inv = inverse + i * n;
        const double *restrict west = i > 0 ? l - n : l, *restrict east = i < rows - 1 ? l + n : l;
        double sum_i = 0.0, sum_j = 0.0;
        MESHONET_INDEPENDENT
        for (ptrdiff_t j = 0; j < n; j++) {
            const double d = east[j] - l[j];
            sum_i += d * d;
            force[j] = 2.0 * across_i * ((l[j] - west[j]) - d);
        }
        MESHONET_INDEPENDENT
        for (ptrdiff_t j = 0; j < n - 1; j++) {
            const double d = l[j + 1] - l[j];
            sum_j += d * d;
        }
        MESHONET_INDEPENDENT
        for (ptrdiff_t j = 1; j < n - 1; j++)
            force[j] += 2.0 * across_j * (2.0 * l[j] - l[j - 1] - l[j + 1]);
        if (n > 1) {
            force[0] -= 2.0 * across_j * (l[1] - l[0]);
            force[n - 1] += 2.0 * across_j * (l[n - 1] - l[n - 2]);
        }
        energy += across_i * sum_i + across_j * sum_j;
        const double *restrict xi = x + i * nj, *restrict yi = y + i * nj;
        double *restrict gxi = gx + i * nj, *restrict gyi = gy + i * nj;
        MESHONET_INDEPENDENT
        for (ptrdiff_t j = 0; j < n; j++) {
            force[j] *= inv[j];
            gxi[j] -= force[j] * (xi[j + next] - xi[j]);
            gyi[j] -= force[j] * (yi[j + next] - yi[j]);
        }
        for (ptrdiff_t j = 0; j < n; j++) {
            gxi[j + next] += force[j] * (xi[j + next] - xi[j]);
            gyi[j + next] += force[j] * (yi[j + next] - yi[j]);
        }
    }
    return energy;
}

static void clear_rim(double *g, ptrdiff_t ni, ptrdiff_t nj)
{
    memset(g, 0, (size_t)nj * sizeof(double));
    memset(g + (ni - 1) * nj, 0, (size_t)nj * sizeof(double));
    for (ptrdiff_t i = 0; i < ni; i++)
        g[i * nj] = g[i * nj + nj - 1] = 0.0;
}

size_t variational_workspace(ptrdiff_t ni, ptrdiff_t nj)
{
    return (size_t)(2 * ni * nj + 9 * nj);
}

MESHONET_CLONES
double variational_energy(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const Weights *weights,
                          double epsilon, double *gx, double *gy, double *smallest, double *work)
{
    const double corners = 4.0 * (double)(ni - 1) * (double)(nj - 1), rest = (1.0 - weights->shape) / (2.0 * corners);
    const Factors f = {rest * weights->aspect, rest / weights->aspect, weights->shape / corners, epsilon * epsilon};
    double *rows = work + 2 * ni * nj;
    const CellRow r = {rows,          rows + nj,     rows + 2 * nj, rows + 3 * nj, rows + 4 * nj,
                       rows + 5 * nj, rows + 6 * nj, rows + 7 * nj, rows + 8 * nj};
    double energy = 0.0, low = INFINITY;
    memset(gx, 0, (size_t)(ni * nj) * sizeof(double));
    memset(gy, 0, (size_t)(ni * nj) * sizeof(double));
    for (ptrdiff_t i = 0; i < ni - 1; i++) {
        const double *xa = x + i * nj, *ya = y + i * nj;
        if (epsilon > 0.0)
            energy += cell_row(xa, ya, xa + nj, ya + nj, nj - 1, &f, 1, &r);
        else
            energy += cell_row(xa, ya, xa + nj, ya + nj, nj - 1, &f, 0, &r);
        for (ptrdiff_t j = 0; j < nj - 1; j++)
            low = r.least[j] < low ? r.least[j] : low;
        scatter(r.sx, r.nx, r.wx, r.ex, gx + i * nj, gx + (i + 1) * nj, nj - 1);
        scatter(r.sy, r.ny, r.wy, r.ey, gy + i * nj, gy + (i + 1) * nj, nj - 1);
    }
    *smallest = low;
    if (!(epsilon > 0.0) && !(low > 0.0))
        return INFINITY;
    if (weights->smoothness > 0.0) {
        const double ci = (double)((ni - 1) * (ni - 1)), cj = (double)((nj - 1) * (nj - 1));
        const double xi = weights->smoothness / (double)((ni - 1) * nj), eta = weights->smoothness / (double)(ni * (nj - 1));
        double *length = work, *inverse = work + ni * nj;
        energy += family(x, y, nj, ni - 1, nj, nj, xi * ci, xi * cj, gx, gy, length, inverse, rows);
        energy += family(x, y, nj, ni, nj - 1, 1, eta * ci, eta * cj, gx, gy, length, inverse, rows);
    }
    clear_rim(gx, ni, nj);
    clear_rim(gy, ni, nj);
    return isfinite(energy) ? energy : INFINITY;
}
