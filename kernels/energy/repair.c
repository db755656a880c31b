/* Untangling and smoothing of a patch of a grid by its corners.

   A cell corner with edges u along xi and v along eta has g = |u|², h = |v|², J = u × v, and costs

       (1 - s) (r g + h / r) / (2 χ) + s (g h / χ²)²,        χ = (J + sqrt(J² + ε²)) / 2,

   with r = height / width of the reference cell. The first term is the discrete harmonic (Winslow) functional,
   infinite at folded cells when ε = 0: Ivanenko, Comput. Math. Math. Phys. 28 (1988) 159-165. The second is
   1 / sin⁴ of the corner's angle. ε > 0 makes the cost finite for folded cells and lets them unfold: Garanzha,
   Kaporin, Comput. Math. Math. Phys. 39 (1999) 1426-1440; Garanzha et al., ACM Trans. Graph. 40 (2021) 109.
   ε is measured in areas of the reference cell. The minimiser is Newton's method with the parts of the Hessian
   that are never negative, a banded Cholesky factor and backtracking. */
#include "repair.h"
#include "banded.h"
#include "clones.h"
#include <math.h>
#include <string.h>

/* Cost of one corner; du, dv receive its derivatives by u and v. */
typedef struct {
    double energy, jacobian, du_x, du_y, dv_x, dv_y;
} Corner;

MESHONET_INLINE Corner corner(double ux, double uy, double vx, double vy, double r, double eps2, double shape)
{
    const double g = ux * ux + uy * uy, h = vx * vx + vy * vy, J = ux * vy - uy * vx;
    const double root = sqrt(J * J + eps2);
    /* the same χ in the form that does not cancel */
    const double chi = J > 0.0 ? 0.5 * (J + root) : 0.5 * eps2 / (root - J);
    const double inverse = 1.0 / chi;
    const double harmonic = 0.5 * (1.0 - shape) * (r * g + h / r) * inverse;
    const double q = g * h * inverse * inverse; /* 1 / sin² */
    const double angle = shape * q * q;
    const double by_g = (0.5 * (1.0 - shape) * r + 2.0 * shape * q * h * inverse) * inverse;
    const double by_h = (0.5 * (1.0 - shape) / r + 2.0 * shape * q * g * inverse) * inverse;
    const double by_J = -(harmonic + 4.0 * angle) / root; /* dχ/dJ = χ / root */
    Corner c;
    c.energy = harmonic + angle;
    c.jacobian = J;
    c.du_x = 2.0 * by_g * ux + by_J * vy;
    c.du_y = 2.0 * by_g * uy - by_J * vx;
    c.dv_x = 2.0 * by_h * vx - by_J * uy;
    c.dv_y = 2.0 * by_h * vy + by_J * ux;
    return c;
}

/* Derivatives by the four edges of each cell of a row: south, north (xi edges), west, east (eta edges). */
typedef struct {
    double *sx, *sy, *nx, *ny, *wx, *wy, *ex, *ey;
    double *least; /* smallest corner Jacobian over reference area, of each cell */
} CellRow;

/* Row of cells i: returns its energy, lowers *smallest. */
MESHONET_INLINE double cell_row(const Patch *p, ptrdiff_t i, double epsilon, const CellRow *f, double *smallest)
{
    const ptrdiff_t nj = p->nj;
    const double *restrict xa = p->x + i * nj, *restrict xb = xa + nj;
    const double *restrict ya = p->y + i * nj, *restrict yb = ya + nj;
    const double *restrict height = p->height;
    const double width = p->width[i], shape = p->shape;
    double *restrict sx = f->sx, *restrict sy = f->sy, *restrict nx = f->nx, *restrict ny = f->ny;
    double *restrict wx = f->wx, *restrict wy = f->wy, *restrict ex = f->ex, *restrict ey = f->ey;
    double *restrict least = f->least;
    double energy = 0.0, low = *smallest;
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < nj - 1; j++) {
        const double area = width * height[j], r = height[j] / width, eps2 = epsilon * epsilon * area * area;
        const double south_x = xb[j] - xa[j], south_y = yb[j] - ya[j];
        const double north_x = xb[j + 1] - xa[j + 1], north_y = yb[j + 1] - ya[j + 1];
        const double west_x = xa[j + 1] - xa[j], west_y = ya[j + 1] - ya[j];
        const double east_x = xb[j + 1] - xb[j], east_y = yb[j + 1] - yb[j];
        const Corner a = corner(south_x, south_y, west_x, west_y, r, eps2, shape);
        const Corner b = corner(south_x, south_y, east_x, east_y, r, eps2, shape);
        const Corner c = corner(north_x, north_y, east_x, east_y, r, eps2, shape);
        const Corner d = corner(north_x, north_y, west_x, west_y, r, eps2, shape);
        energy += (a.energy + b.energy) + (c.energy + d.energy);
        const double south = a.jacobian < b.jacobian ? a.jacobian : b.jacobian;
        const double north = c.jacobian < d.jacobian ? c.jacobian : d.jacobian;
        least[j] = (south < north ? south : north) / area;
        sx[j] = a.du_x + b.du_x, sy[j] = a.du_y + b.du_y;
        nx[j] = c.du_x + d.du_x, ny[j] = c.du_y + d.du_y;
        wx[j] = a.dv_x + d.dv_x, wy[j] = a.dv_y + d.dv_y;
        ex[j] = b.dv_x + c.dv_x, ey[j] = b.dv_y + c.dv_y;
    }
    for (ptrdiff_t j = 0; j < nj - 1; j++)
        low = least[j] < low ? least[j] : low;
    *smallest = low;
    return energy;
}

/* An edge force pushes its end node and pulls its start node. One coordinate of one row of cells. */
MESHONET_INLINE void scatter(const double *restrict s, const double *restrict n, const double *restrict w,
                             const double *restrict e, double *restrict ga, double *restrict gb, ptrdiff_t cells)
{
    for (ptrdiff_t j = 0; j < cells; j++)
        ga[j] -= s[j] + w[j], gb[j] += s[j] - e[j];
    for (ptrdiff_t j = 0; j < cells; j++)
        ga[j + 1] += w[j] - n[j], gb[j + 1] += n[j] + e[j];
}

/* Zero at the rim; the two copies of a periodic row are one unknown, held in row 0. */
static void constrain(const Patch *p, double *g)
{
    const ptrdiff_t ni = p->ni, nj = p->nj;
    for (ptrdiff_t j = 0; j < nj; j++) {
        if (p->periodic)
            g[j] += g[(ni - 1) * nj + j];
        else
            g[j] = 0.0;
        g[(ni - 1) * nj + j] = 0.0;
    }
    for (ptrdiff_t i = 0; i < ni; i++)
        g[i * nj] = g[i * nj + nj - 1] = 0.0;
}

/* ---- the order of the unknowns: node by node along the shorter direction, x and y of a node side by side ---- */

typedef struct {
    ptrdiff_t first_i, rows, columns; /* free nodes: rows first_i .. first_i + rows - 1, columns 1 .. columns */
    int along_i;                      /* neighbours in i are neighbours in the order */
    ptrdiff_t count, band;            /* unknowns; entries left of the diagonal */
} Order;

static Order order_of(ptrdiff_t ni, ptrdiff_t nj, int periodic)
{
    Order o;
    o.first_i = periodic ? 0 : 1;
    o.rows = periodic ? ni - 1 : ni - 2;
    o.columns = nj - 2;
    o.along_i = periodic || o.rows < o.columns;
    o.count = 2 * o.rows * o.columns;
    const ptrdiff_t line = o.along_i ? o.rows : o.columns;
    o.band = periodic ? 4 * line - 1 : 2 * (line + 1) + 1; /* the seam couples both ends of neighbouring lines */
    if (o.band > o.count - 1)
        o.band = o.count - 1;
    return o;
}

/* First unknown of node (i, j), or -1 when it is fixed. */
MESHONET_INLINE ptrdiff_t unknown(const Patch *p, const Order *o, ptrdiff_t i, ptrdiff_t j)
{
    const ptrdiff_t row = (p->periodic && i == p->ni - 1 ? 0 : i) - o->first_i, column = j - 1;
    if (row < 0 || row >= o->rows || column < 0 || column >= o->columns)
        return -1;
    return 2 * (o->along_i ? column * o->rows + row : row * o->columns + column);
}

size_t repair_workspace(ptrdiff_t ni, ptrdiff_t nj, int periodic)
{
    const Order o = order_of(ni, nj, periodic);
    return (size_t)(o.count * (o.band + 2) + 2 * ni * nj + 9 * nj);
}

MESHONET_CLONES
double repair_energy(const Patch *p, double epsilon, double *gx, double *gy, double *smallest, double *work)
{
    const ptrdiff_t ni = p->ni, nj = p->nj;
    const CellRow f = {work,          work + nj,     work + 2 * nj, work + 3 * nj,
                          work + 4 * nj, work + 5 * nj, work + 6 * nj, work + 7 * nj,
                       work + 8 * nj};
    double energy = 0.0;
    *smallest = INFINITY;
    memset(gx, 0, (size_t)(ni * nj) * sizeof(double));
    memset(gy, 0, (size_t)(ni * nj) * sizeof(double));
    for (ptrdiff_t i = 0; i < ni - 1; i++) {
        energy += cell_row(p, i, epsilon, &f, smallest);
        scatter(f.sx, f.nx, f.wx, f.ex, gx + i * nj, gx + (i + 1) * nj, nj - 1);
        scatter(f.sy, f.ny, f.wy, f.ey, gy + i * nj, gy + (i + 1) * nj, nj - 1);
    }
    constrain(p, gx);
    constrain(p, gy);
    if (epsilon == 0.0 && !(*smallest > 0.0))
        return INFINITY;
    return isfinite(energy) ? energy : INFINITY;
}

/* ---- Hessian ---- */

/* Second derivatives of a corner's cost by z = (u_x, u_y, v_x, v_y), less the parts that can be negative.
   With f = (r g + h / r) / 2 the harmonic part keeps
       ∇²f / χ - χ' (∇f ∇Jᵀ + ∇J ∇fᵀ) / χ² + 2 f χ'² ∇J ∇Jᵀ / χ³,
   which is not negative since ∇f ∇fᵀ <= 2 f ∇²f; the angle part a = (g h / χ²)² keeps
       a (w wᵀ + 4 χ'² ∇J ∇Jᵀ / χ² + 4 u⊥ u⊥ᵀ / g² + 4 v⊥ v⊥ᵀ / h²),    w = ∇a / a. */
MESHONET_INLINE void corner_hessian(const double z[4], double r, double eps2, double shape, double hessian[4][4])
{
    const double g = z[0] * z[0] + z[1] * z[1], h = z[2] * z[2] + z[3] * z[3], J = z[0] * z[3] - z[1] * z[2];
    const double root = sqrt(J * J + eps2), chi = J > 0.0 ? 0.5 * (J + root) : 0.5 * eps2 / (root - J);
    const double slope = 1.0 / root; /* χ' / χ */
    const double f = 0.5 * (r * g + h / r), q = g * h / (chi * chi);
    const double harmonic = (1.0 - shape) / chi, angle = shape * q * q;
    const double both = slope * slope * (2.0 * f * harmonic + 4.0 * angle), cross = harmonic * slope;
    const double by_f[4] = {r * z[0], r * z[1], z[2] / r, z[3] / r}, by_J[4] = {z[3], -z[2], -z[1], z[0]};
    const double w[4] = {4.0 * (z[0] / g - slope * by_J[0]), 4.0 * (z[1] / g - slope * by_J[1]),
                         4.0 * (z[2] / h - slope * by_J[2]), 4.0 * (z[3] / h - slope * by_J[3])};
    for (int k = 0; k < 4; k++)
        for (int m = 0; m < 4; m++)
            hessian[k][m] = both * by_J[k] * by_J[m] + angle * w[k] * w[m] - cross * (by_f[k] * by_J[m] + by_J[k] * by_f[m]);
    const double ug = 4.0 * angle / (g * g), vh = 4.0 * angle / (h * h);
    hessian[0][0] += harmonic * r + ug * z[1] * z[1];
    hessian[1][1] += harmonic * r + ug * z[0] * z[0];
    hessian[0][1] -= ug * z[0] * z[1], hessian[1][0] -= ug * z[0] * z[1];
    hessian[2][2] += harmonic / r + vh * z[3] * z[3];
    hessian[3][3] += harmonic / r + vh * z[2] * z[2];
    hessian[2][3] -= vh * z[2] * z[3], hessian[3][2] -= vh * z[2] * z[3];
}

/* Add a corner: node c, its neighbours a along u and b along v, given by their first unknowns. `flip` is -1 when
   one of u = ±(a - c), v = ±(b - c) runs towards c. */
MESHONET_INLINE void add_corner(const Banded *matrix, double h[4][4], double flip, ptrdiff_t a, ptrdiff_t b, ptrdiff_t c)
{
    for (int k = 0; k < 2; k++)
        for (int m = 2; m < 4; m++)
            h[k][m] *= flip, h[m][k] *= flip;
    double ca[2][2], cb[2][2]; /* by c and a, by c and b: c moves both edges backwards */
    for (int k = 0; k < 2; k++)
        for (int m = 0; m < 2; m++)
            ca[k][m] = -h[k][m] - h[k + 2][m], cb[k][m] = -h[k][m + 2] - h[k + 2][m + 2];
    add_block(matrix, a, a, h[0][0], h[0][1], h[1][0], h[1][1]);
    add_block(matrix, b, b, h[2][2], h[2][3], h[3][2], h[3][3]);
    add_block(matrix, a, b, h[0][2], h[0][3], h[1][2], h[1][3]);
    add_block(matrix, c, a, ca[0][0], ca[0][1], ca[1][0], ca[1][1]);
    add_block(matrix, c, b, cb[0][0], cb[0][1], cb[1][0], cb[1][1]);
    add_block(matrix, c, c, -ca[0][0] - cb[0][0], -ca[0][1] - cb[0][1], -ca[1][0] - cb[1][0], -ca[1][1] - cb[1][1]);
}

MESHONET_CLONES
static void hessian_of(const Patch *p, const Order *o, double epsilon, const Banded *matrix)
{
    memset(matrix->values, 0, (size_t)(matrix->count * (matrix->band + 1)) * sizeof(double));
    for (ptrdiff_t i = 0; i < p->ni - 1; i++)
        for (ptrdiff_t j = 0; j < p->nj - 1; j++) {
            const double area = p->width[i] * p->height[j], r = p->height[j] / p->width[i];
            const double eps2 = epsilon * epsilon * area * area;
            const double *x = p->x + i * p->nj + j, *y = p->y + i * p->nj + j;
            const ptrdiff_t n[2][2] = {{unknown(p, o, i, j), unknown(p, o, i, j + 1)},
                                       {unknown(p, o, i + 1, j), unknown(p, o, i + 1, j + 1)}};
            for (int di = 0; di < 2; di++)
                for (int dj = 0; dj < 2; dj++) { /* the corner at node (i + di, j + dj) */
                    const ptrdiff_t along = di * p->nj;
                    const double z[4] = {x[p->nj + dj] - x[dj], y[p->nj + dj] - y[dj], x[along + 1] - x[along],
                                         y[along + 1] - y[along]};
                    double full[4][4];
                    corner_hessian(z, r, eps2, p->shape, full);
                    add_corner(matrix, full, di == dj ? 1.0 : -1.0, n[1 - di][dj], n[di][1 - dj], n[di][dj]);
                }
        }
}

/* ---- Newton's method ---- */

/* Move the free nodes by `factor` times the step d; returns the largest move in shorter reference lengths. */
static double move(const Patch *p, const Order *o, const double *d, double factor)
{
    double most = 0.0;
    for (ptrdiff_t i = o->first_i; i < o->first_i + o->rows; i++)
        for (ptrdiff_t j = 1; j <= o->columns; j++) {
            const ptrdiff_t k = unknown(p, o, i, j), at = i * p->nj + j;
            const double length = p->width[i] < p->height[j] ? p->width[i] : p->height[j];
            p->x[at] += factor * d[k];
            p->y[at] += factor * d[k + 1];
            most = fmax(most, fabs(factor) * hypot(d[k], d[k + 1]) / length);
        }
    if (p->periodic) {
        memcpy(p->x + (p->ni - 1) * p->nj, p->x, (size_t)p->nj * sizeof(double));
        memcpy(p->y + (p->ni - 1) * p->nj, p->y, (size_t)p->nj * sizeof(double));
    }
    return most;
}

/* d = -gradient, in the order of the unknowns. */
static void descent(const Patch *p, const Order *o, const double *gx, const double *gy, double *d)
{
    for (ptrdiff_t i = o->first_i; i < o->first_i + o->rows; i++)
        for (ptrdiff_t j = 1; j <= o->columns; j++) {
            const ptrdiff_t k = unknown(p, o, i, j), at = i * p->nj + j;
            d[k] = -gx[at], d[k + 1] = -gy[at];
        }
}

/* Derivative of the energy along d. */
static double slope_along(const Patch *p, const Order *o, const double *gx, const double *gy, const double *d)
{
    double slope = 0.0;
    for (ptrdiff_t i = o->first_i; i < o->first_i + o->rows; i++)
        for (ptrdiff_t j = 1; j <= o->columns; j++) {
            const ptrdiff_t k = unknown(p, o, i, j), at = i * p->nj + j;
            slope += gx[at] * d[k] + gy[at] * d[k + 1];
        }
    return slope;
}

int repair_minimise(const Patch *p, double epsilon, int most, double still, double until_valid, double *energy,
                    double *smallest, double *work)
{
    enum { HALVINGS = 40 };
    const Order o = order_of(p->ni, p->nj, p->periodic);
    const Banded hessian = {work, o.count, o.band};
    double *d = work + o.count * (o.band + 1), *gx = d + o.count, *gy = gx + p->ni * p->nj, *rows = gy + p->ni * p->nj;
    int done = 0;
    *energy = repair_energy(p, epsilon, gx, gy, smallest, rows);
    while (done < most && isfinite(*energy) && !(until_valid > 0.0 && *smallest > until_valid)) {
        const double before = *energy;
        descent(p, &o, gx, gy, d);
        hessian_of(p, &o, epsilon, &hessian);
        banded_solve(&hessian, d);
        const double slope = slope_along(p, &o, gx, gy, d);
        if (!(slope < 0.0))
            break;
        double factor = 1.0, moved = move(p, &o, d, factor);
        *energy = repair_energy(p, epsilon, gx, gy, smallest, rows);
        int halvings = 0;
        for (; halvings < HALVINGS && !(*energy <= before + 1e-4 * factor * slope); halvings++) {
            factor *= 0.5;
            moved = move(p, &o, d, -factor);
            *energy = repair_energy(p, epsilon, gx, gy, smallest, rows);
        }
        done++;
        if (halvings == HALVINGS || moved < still)
            break;
    }
    return done;
}
