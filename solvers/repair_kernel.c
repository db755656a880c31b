/* Untangling and smoothing of a patch of a grid by its corners.

   A cell corner with edges u along xi and v along eta has g = |u|², h = |v|², J = u × v, and costs

       (1 - s) (r g + h / r) / (2 χ) + s g h / χ²,        χ = (J + sqrt(J² + ε²)) / 2,

   with r = height / width of the reference cell. The first term is the discrete harmonic (Winslow) functional,
   infinite at folded cells when ε = 0: Ivanenko, Comput. Math. Math. Phys. 28 (1988) 159-165. The second is
   1 / sin² of the corner's angle. ε > 0 makes the cost finite for folded cells and lets them unfold: Garanzha,
   Kaporin, Comput. Math. Math. Phys. 39 (1999) 1426-1440; Garanzha et al., ACM Trans. Graph. 40 (2021) 109.
   ε is measured in areas of the reference cell. The minimiser is L-BFGS with a diagonal start: Nocedal, Wright,
   Numerical Optimization (2006), algorithm 7.4. */
#include "repair_kernel.h"
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
    const double angle = shape * g * h * inverse * inverse;
    const double by_g = (0.5 * (1.0 - shape) * r + shape * h * inverse) * inverse;
    const double by_h = (0.5 * (1.0 - shape) / r + shape * g * inverse) * inverse;
    const double by_J = -(harmonic + 2.0 * angle) / root; /* dχ/dJ = χ / root */
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

size_t repair_workspace(ptrdiff_t ni, ptrdiff_t nj)
{
    return (size_t)(2 * ni * nj) * (2 * REPAIR_PAIRS + 5) + (size_t)(9 * nj);
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

/* ---- L-BFGS over z = (x, y), 2 ni nj values of which the fixed ones never move ---- */

MESHONET_CLONES
double repair_dot(const double *restrict a, const double *restrict b, ptrdiff_t n)
{
    double sum = 0.0;
    for (ptrdiff_t k = 0; k < n; k++)
        sum += a[k] * b[k];
    return sum;
}

MESHONET_CLONES
void repair_add(double *restrict a, double factor, const double *restrict b, ptrdiff_t n)
{
    for (ptrdiff_t k = 0; k < n; k++)
        a[k] += factor * b[k];
}

typedef struct {
    double *step, *change; /* REPAIR_PAIRS rows of n: s = z' - z, y = g' - g */
    double rho[REPAIR_PAIRS];
    int count, newest;
} Memory;

/* d = -H g by the two-loop recursion; `diagonal` starts the inverse Hessian. */
static void direction(const Memory *m, const double *g, const double *diagonal, double *d, ptrdiff_t n)
{
    double alpha[REPAIR_PAIRS], gamma = 1.0;
    memcpy(d, g, (size_t)n * sizeof(double));
    for (int k = 0; k < m->count; k++) {
        const int q = (m->newest - k + REPAIR_PAIRS) % REPAIR_PAIRS;
        alpha[q] = m->rho[q] * repair_dot(m->step + q * n, d, n);
        repair_add(d, -alpha[q], m->change + q * n, n);
    }
    if (m->count > 0) {
        const double *y = m->change + m->newest * n;
        double yhy = 0.0;
        for (ptrdiff_t k = 0; k < n; k++)
            yhy += y[k] * y[k] * diagonal[k];
        gamma = 1.0 / (m->rho[m->newest] * yhy);
    }
    for (ptrdiff_t k = 0; k < n; k++)
        d[k] *= gamma * diagonal[k];
    for (int k = m->count - 1; k >= 0; k--) {
        const int q = (m->newest - k + REPAIR_PAIRS) % REPAIR_PAIRS;
        const double beta = m->rho[q] * repair_dot(m->change + q * n, d, n);
        repair_add(d, alpha[q] - beta, m->step + q * n, n);
    }
    for (ptrdiff_t k = 0; k < n; k++)
        d[k] = -d[k];
}

/* Inverse of the diagonal of the harmonic functional's Hessian on reference cells: 1 / Σ (r + 1/r) / area. */
static void start_diagonal(const Patch *p, double *diagonal)
{
    const ptrdiff_t ni = p->ni, nj = p->nj;
    for (ptrdiff_t i = 0; i < ni; i++)
        for (ptrdiff_t j = 0; j < nj; j++) {
            double sum = 0.0;
            for (ptrdiff_t a = i - 1; a <= i; a++)
                for (ptrdiff_t b = j - 1; b <= j; b++) {
                    if ((!p->periodic && (a < 0 || a >= ni - 1)) || b < 0 || b >= nj - 1)
                        continue;
                    const double w = p->width[(a + ni - 1) % (ni - 1)], h = p->height[b];
                    sum += 2.0 * (1.0 / (w * w) + 1.0 / (h * h));
                }
            diagonal[i * nj + j] = diagonal[ni * nj + i * nj + j] = 1.0 / sum;
        }
}

/* Largest move of a node under `factor` times d, in shortest reference lengths of its cell. */
static double largest_move(const Patch *p, const double *d, double factor)
{
    double most = 0.0;
    for (ptrdiff_t i = 0; i < p->ni - 1; i++)
        for (ptrdiff_t j = 1; j < p->nj - 1; j++) {
            const double length = p->width[i] < p->height[j] ? p->width[i] : p->height[j];
            const double dx = d[i * p->nj + j], dy = d[(p->ni + i) * p->nj + j];
            const double move = factor * factor * (dx * dx + dy * dy) / (length * length);
            most = move > most ? move : most;
        }
    return sqrt(most);
}

static void set_nodes(const Patch *p, const double *z, double factor, const double *d)
{
    const ptrdiff_t size = p->ni * p->nj;
    for (ptrdiff_t k = 0; k < size; k++) {
        p->x[k] = z[k] + factor * d[k];
        p->y[k] = z[size + k] + factor * d[size + k];
    }
    if (p->periodic) {
        memcpy(p->x + size - p->nj, p->x, (size_t)p->nj * sizeof(double));
        memcpy(p->y + size - p->nj, p->y, (size_t)p->nj * sizeof(double));
    }
}

/* Keep the pair (s, y) when the curvature along it is positive. */
static void remember(Memory *m, const double *s, const double *y, ptrdiff_t n)
{
    const double sy = repair_dot(s, y, n);
    if (!(sy > 1e-12 * sqrt(repair_dot(s, s, n) * repair_dot(y, y, n))))
        return;
    m->newest = (m->newest + 1) % REPAIR_PAIRS;
    memcpy(m->step + m->newest * n, s, (size_t)n * sizeof(double));
    memcpy(m->change + m->newest * n, y, (size_t)n * sizeof(double));
    m->rho[m->newest] = 1.0 / sy;
    m->count = m->count < REPAIR_PAIRS ? m->count + 1 : REPAIR_PAIRS;
}

int repair_minimise(const Patch *p, double epsilon, int most, double still, double until_valid, double *energy,
                    double *smallest, double *work)
{
    const ptrdiff_t size = p->ni * p->nj, n = 2 * size;
    double *z = work, *g = z + n, *d = g + n, *g_new = d + n, *diagonal = g_new + n;
    double *pairs = diagonal + n, *rows = pairs + 2 * REPAIR_PAIRS * n;
    Memory memory = {pairs, pairs + REPAIR_PAIRS * n, {0}, 0, 0};
    int done = 0;
    start_diagonal(p, diagonal);
    memcpy(z, p->x, (size_t)size * sizeof(double));
    memcpy(z + size, p->y, (size_t)size * sizeof(double));
    *energy = repair_energy(p, epsilon, g, g + size, smallest, rows);
    while (done < most && isfinite(*energy) && !(until_valid > 0.0 && *smallest > until_valid)) {
        direction(&memory, g, diagonal, d, n);
        double slope = repair_dot(g, d, n);
        if (!(slope < 0.0)) {
            memory.count = 0;
            direction(&memory, g, diagonal, d, n);
            slope = repair_dot(g, d, n);
        }
        const double reach = largest_move(p, d, 1.0);
        double factor = reach > 1.0 ? 1.0 / reach : 1.0, low = 0.0, trial = INFINITY;
        int tries = 0;
        for (; tries < 30; tries++) {
            set_nodes(p, z, factor, d);
            trial = repair_energy(p, epsilon, g_new, g_new + size, &low, rows);
            if (trial <= *energy + 1e-4 * factor * slope)
                break;
            /* minimum of the parabola through both values and the slope, within bounds */
            const double bend = trial - *energy - factor * slope;
            const double best = isfinite(bend) && bend > 0.0 ? -0.5 * factor * factor * slope / bend : 0.0;
            factor = best > 0.5 * factor ? 0.5 * factor : best < 0.1 * factor ? 0.1 * factor : best;
        }
        if (tries == 30) {
            set_nodes(p, z, 0.0, d);
            if (memory.count == 0)
                break;
            memory.count = 0;
            continue;
        }
        done++;
        for (ptrdiff_t k = 0; k < n; k++)
            d[k] *= factor, g[k] = g_new[k] - g[k];
        remember(&memory, d, g, n);
        repair_add(z, 1.0, d, n);
        memcpy(g, g_new, (size_t)n * sizeof(double));
        *energy = trial, *smallest = low;
        if (largest_move(p, d, 1.0) < still)
            break;
    }
    return done;
}
