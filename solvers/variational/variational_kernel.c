/* Descent of the variational functional: L-BFGS with the preconditioner of spectral.h and coarse_space.h.

   Steps s and preconditioned changes z = P y of the gradient are the rows of one table, read once for the products
   with the gradient and once for the new direction; the two-loop recursion runs on the small tables of the products
   s·y and y·z. Rows are in single precision: they steer the descent, they are not its result.

   Nocedal and Wright, Numerical Optimization (2006), algorithm 7.4; the form in products: Chen, Wang and Zhou,
   NIPS 27 (2014). */
#include "variational_kernel.h"
#include "coarse_space.h"
#include "functional.h"
#include "spectral.h"

#define TRIES 25   /* lengths of a step that are tried */
#define IDLE 2     /* small changes in a row that count as standing still; one may come from a short step */
#define GAIN 1e-4  /* part of the value that such a change wins at the most */
#define CHUNK 2048 /* values of every row of the table that are read together */

size_t variational_workspace(ptrdiff_t ni, ptrdiff_t nj)
{
    return (size_t)(2 * ni * nj + 9 * nj);
}

MESHONET_CLONES
double variational_energy(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const Weights *weights,
                          double *gx, double *gy, double *smallest, double *work)
{
    const double cells = (double)(ni - 1) * (double)(nj - 1), eps = weights->epsilon;
    const double one = 1.0 / (12.0 * cells), two = 8.0 * one, rest = 0.5 * (1.0 - weights->shape);
    const double along = rest * weights->aspect, across = rest / weights->aspect;
    const Factors at_corner = {one * along, one * across, one * weights->shape, eps * eps};
    const Factors at_centre = {two * along, two * across, two * weights->shape, 16.0 * eps * eps};
    double *rows = work + 2 * ni * nj;
    const CellRow r = {rows,          rows + nj,     rows + 2 * nj, rows + 3 * nj, rows + 4 * nj,
                       rows + 5 * nj, rows + 6 * nj, rows + 7 * nj, rows + 8 * nj};
    double energy = 0.0, low = INFINITY;
    memset(gx, 0, (size_t)(ni * nj) * sizeof(double));
    memset(gy, 0, (size_t)(ni * nj) * sizeof(double));
    for (ptrdiff_t i = 0; i < ni - 1; i++) {
        const double *xa = x + i * nj, *ya = y + i * nj;
        if (eps > 0.0)
            energy += cell_row(xa, ya, xa + nj, ya + nj, nj - 1, &at_corner, &at_centre, 1, &r);
        else
            energy += cell_row(xa, ya, xa + nj, ya + nj, nj - 1, &at_corner, &at_centre, 0, &r);
        for (ptrdiff_t j = 0; j < nj - 1; j++)
            low = r.least[j] < low ? r.least[j] : low;
        scatter(r.sx, r.nx, r.wx, r.ex, gx + i * nj, gx + (i + 1) * nj, nj - 1);
        scatter(r.sy, r.ny, r.wy, r.ey, gy + i * nj, gy + (i + 1) * nj, nj - 1);
    }
    *smallest = low;
    if (!(eps > 0.0) && !(low > 0.0))
        return INFINITY;
    if (weights->smoothness > 0.0) {
        const double by_i = weights->smoothness / cells * (double)((ni - 1) * (ni - 1));
        const double by_j = weights->smoothness / cells * (double)((nj - 1) * (nj - 1));
        double *length = work, *inverse = work + ni * nj;
        const int p = weights->periodic;
        energy += family(x, y, nj, ni - 1, nj, nj, p, by_i, by_j, gx, gy, length, inverse, rows);
        energy += family(x, y, nj, ni, nj - 1, 1, p, by_i, by_j, gx, gy, length, inverse, rows);
    }
    if (weights->relief && !(eps > 0.0))
        energy -= relieve(x, y, ni, nj, weights, one * weights->shape, gx, gy);
    clear_rim(gx, ni, nj, weights->periodic);
    clear_rim(gy, ni, nj, weights->periodic);
    return isfinite(energy) ? energy : INFINITY;
}

/* The column of H for coordinate c of unknown (i, j), from its row down: what the move has changed of the gradient at
   the nodes that share terms with it. */
MESHONET_INLINE void set_column(const Space *space, ptrdiff_t i, ptrdiff_t j, int c, const double *g,
                                const double *moved, double step)
{
    const ptrdiff_t mj = space->mj, width = space->width, nj = mj + 2, nodes = (space->mi + 2) * nj;
    const ptrdiff_t column = 2 * (i * mj + j) + c;
    for (ptrdiff_t p = i; p < space->mi && p <= i + 2; p++) {
        const ptrdiff_t reach = 2 - (p - i);
        for (ptrdiff_t q = j > reach ? j - reach : 0; q < mj && q <= j + reach; q++)
            for (int r = 0; r < 2; r++) {
                const ptrdiff_t row = 2 * (p * mj + q) + r, at = r * nodes + (p + 1) * nj + q + 1;
                if (row >= column && row - column <= width)
                    space->band[row * (width + 1) + width + column - row] = (moved[at] - g[at]) / step;
            }
    }
}

MESHONET_CLONES
int space_factor(const Space *space, double *z, const Weights *weights, double *room)
{
    const ptrdiff_t mi = space->mi, mj = space->mj, width = space->width, nj = mj + 2, nodes = (mi + 2) * nj;
    double *g = room, *moved = room + 2 * nodes, *work = room + 4 * nodes, low;
    const double *far = z + (mi + 1) * nj + mj + 1;
    const double step = STEP * hypot((far[0] - z[0]) / (double)(mi + 1), (far[nodes] - z[nodes]) / (double)(mj + 1));
    memset(space->band, 0, (size_t)(2 * mi * mj * (width + 1)) * sizeof(double));
    variational_energy(z, z + nodes, mi + 2, nj, weights, g, g + nodes, &low, work);
    for (int colour = 0; colour < 2 * COLOURS; colour++) {
        const int c = colour % 2;
        for (int back = 0; back < 2; back++) {
            for (ptrdiff_t i = 0; i < mi; i++)
                for (ptrdiff_t j = 0; j < mj; j++)
                    if (COLOUR(i, j) == colour / 2)
                        z[c * nodes + (i + 1) * nj + j + 1] += back ? -step : step;
            if (!back)
                variational_energy(z, z + nodes, mi + 2, nj, weights, moved, moved + nodes, &low, work);
        }
        for (ptrdiff_t i = 0; i < mi; i++)
            for (ptrdiff_t j = 0; j < mj; j++)
                if (COLOUR(i, j) == colour / 2)
                    set_column(space, i, j, c, g, moved, step);
    }
    return factorise(space->band, 2 * mi * mj, width);
}

void descent_sizes(const Descent *d, size_t *doubles, size_t *floats)
{
    const Spectrum *s = &d->spectrum;
    const ptrdiff_t nodes = values_of(&s->eta), modes = modes_of(&s->eta);
    const size_t free_nodes = (size_t)(s->mi * s->mj), widest = (size_t)(nodes > modes ? nodes : modes);
    *doubles = 4 * (size_t)(d->ni * d->nj) + variational_workspace(d->ni, d->nj) + 4 * free_nodes;
    *floats = (8 + 4 * PAIRS) * free_nodes + 6 * (size_t)s->mi * widest + PANEL * DEPTH + (size_t)(ROWS * s->mj);
}

void descent_place(Descent *d, double *doubles, float *floats)
{
    const ptrdiff_t nodes = d->ni * d->nj, n = 2 * d->spectrum.mi * d->spectrum.mj;
    d->full = doubles, d->work = d->full + 4 * nodes;
    d->gradient = d->work + variational_workspace(d->ni, d->nj), d->fresh = d->gradient + n;
    d->frame = floats, d->direction = d->frame + n, d->steepest = d->direction + n, d->turned = d->steepest + n;
    d->table = d->turned + n, d->transform = d->table + 2 * PAIRS * n;
}

/* Value at the planes `at`, and the gradient of the free nodes in `gradient`. */
static double evaluate(Descent *d, const double *at, double *gradient, double *smallest)
{
    const ptrdiff_t nodes = d->ni * d->nj, mi = d->spectrum.mi, mj = d->spectrum.mj;
    double *g = d->full + 2 * nodes;
    const double value =
        variational_energy(at, at + nodes, d->ni, d->nj, &d->weights, g, g + nodes, smallest, d->work);
    for (int c = 0; c < 2; c++)
        for (ptrdiff_t i = 0; i < mi; i++)
            memcpy(gradient + (c * mi + i) * mj, g + c * nodes + (d->first + i) * d->nj + 1, (size_t)mj * sizeof *g);
    return value;
}

/* Row i of the gradient in the frames of its nodes, as rows x and y. */
MESHONET_INLINE void into_frame(const Descent *d, const double *restrict gradient, ptrdiff_t i, float *restrict x,
                                float *restrict y)
{
    const ptrdiff_t mj = d->spectrum.mj, n = d->spectrum.mi * mj, k = i * mj;
    const float *restrict fx = d->frame + k, *restrict fy = fx + n;
    const double *restrict gx = gradient + k, *restrict gy = gx + n;
    for (ptrdiff_t j = 0; j < mj; j++) {
        const float px = (float)gx[j], py = (float)gy[j];
        x[j] = fx[j] * px + fy[j] * py, y[j] = fx[j] * py - fy[j] * px;
    }
}

/* Row i of the result from rows x and y. */
MESHONET_INLINE void out_of_frame(const Descent *d, const float *restrict x, const float *restrict y, ptrdiff_t i,
                                  float *restrict result)
{
    const ptrdiff_t mj = d->spectrum.mj, n = d->spectrum.mi * mj, k = i * mj;
    const float *restrict fx = d->frame + k, *restrict fy = fx + n;
    float *restrict rx = result + k, *restrict ry = rx + n;
    for (ptrdiff_t j = 0; j < mj; j++)
        rx[j] = fx[j] * x[j] - fy[j] * y[j], ry[j] = fx[j] * y[j] + fy[j] * x[j];
}

/* result = P gradient. Rows i and mi - 1 - i are folded together. */
MESHONET_CLONES
void descent_precondition(Descent *d, const double *restrict gradient, float *restrict result)
{
    const Spectrum *s = &d->spectrum;
    const ptrdiff_t mi = s->mi, mj = s->mj, width = values_of(&s->eta), modes = modes_of(&s->eta);
    float *w = d->transform, *packed = w + 6 * mi * (width > modes ? width : modes);
    float *a[2] = {packed, packed + mj}, *b[2] = {packed + 2 * mj, packed + 3 * mj};
    for (ptrdiff_t i = 0; i < s->xi.even.nodes; i++) {
        const ptrdiff_t other = mi - 1 - i;
        into_frame(d, gradient, i, a[0], a[1]);
        if (other > i)
            into_frame(d, gradient, other, b[0], b[1]);
        for (int c = 0; c < 2; c++) {
            float *rows = w + c * mi * width;
            if (other > i) {
                mix(a[c], b[c], mj);
                fold(b[c], &s->eta, rows + (s->xi.even.nodes + i) * width);
            }
            fold(a[c], &s->eta, rows + i * width);
        }
    }
    divide(s, w, w + 2 * mi * (width > modes ? width : modes), packed);
    for (ptrdiff_t i = 0; i < s->xi.even.nodes; i++) {
        const ptrdiff_t other = mi - 1 - i;
        for (int c = 0; c < 2; c++) {
            const float *rows = w + c * mi * width;
            unfold(rows + i * width, &s->eta, a[c]);
            if (other > i) {
                unfold(rows + (s->xi.even.nodes + i) * width, &s->eta, b[c]);
                mix(a[c], b[c], mj);
            }
        }
        out_of_frame(d, a[0], a[1], i, result);
        if (other > i)
            out_of_frame(d, b[0], b[1], other, result);
    }
    const Space *space = &d->space;
    if (space->mi == 0)
        return;
    for (int c = 0; c < 2; c++)
        space_restrict(space, gradient + c * mi * mj, mi, mj, c, packed, space->unknowns);
    solve_band(space->band, 2 * space->mi * space->mj, space->width, space->unknowns);
    for (int c = 0; c < 2; c++)
        from_space(space, space->unknowns, mi, mj, c, result + c * mi * mj);
}

/* The step along xi at each free node, from both directions: (p + q) / 2 with p = √a x_ξ and q = -i x_η / √a by centred
   differences, or the longer of the two where they oppose each other, in folded places. */
MESHONET_CLONES
static void set_frame(Descent *d)
{
    const ptrdiff_t nj = d->nj, nodes = d->ni * nj, mi = d->spectrum.mi, mj = d->spectrum.mj, n = mi * mj;
    const double *x = d->z, *y = d->z + nodes;
    const double along = 0.5 * sqrt(d->weights.aspect), across = 0.5 / sqrt(d->weights.aspect);
    for (ptrdiff_t i = 0; i < mi; i++) {
        const ptrdiff_t at = d->first + i, west = at > 0 ? at - 1 : d->ni - 2;
        for (ptrdiff_t j = 1; j <= mj; j++) {
            const ptrdiff_t k = at * nj + j, w = west * nj + j, e = (at + 1) * nj + j;
            const double px = along * (x[e] - x[w]), py = along * (y[e] - y[w]);
            const double qx = across * (y[k + 1] - y[k - 1]), qy = -across * (x[k + 1] - x[k - 1]);
            const double p = px * px + py * py, q = qx * qx + qy * qy;
            double cx = 0.5 * (px + qx), cy = 0.5 * (py + qy);
            if (cx * cx + cy * cy < 0.05 * (p + q))
                cx = p > q ? px : qx, cy = p > q ? py : qy;
            d->frame[i * mj + j - 1] = (float)cx, d->frame[n + i * mj + j - 1] = (float)cy;
        }
    }
}

void descent_start(Descent *d)
{
    set_frame(d);
    d->count = d->idle = 0;
    d->value = evaluate(d, d->z, d->gradient, &d->smallest);
    descent_precondition(d, d->gradient, d->steepest);
}

/* Products of every row of the table (2 count, n) with v. */
MESHONET_CLONES
void descent_products(const float *table, int rows, const double *v, ptrdiff_t n, double *products)
{
    for (int r = 0; r < rows; r++)
        products[r] = 0.0;
    for (ptrdiff_t start = 0; start < n; start += CHUNK) {
        const ptrdiff_t stop = start + CHUNK < n ? start + CHUNK : n;
        for (int r = 0; r < rows; r++) {
            const float *restrict row = table + r * n;
            double sum = 0.0;
            for (ptrdiff_t k = start; k < stop; k++)
                sum += (double)row[k] * v[k];
            products[r] += sum;
        }
    }
}

/* direction = Σ share[r] row r - scale steepest. */
MESHONET_CLONES
void descent_combine(const float *table, int rows, const float *share, const float *restrict steepest, float scale,
                     ptrdiff_t n, float *restrict direction)
{
    for (ptrdiff_t start = 0; start < n; start += CHUNK) {
        const ptrdiff_t stop = start + CHUNK < n ? start + CHUNK : n;
        for (ptrdiff_t k = start; k < stop; k++)
            direction[k] = -scale * steepest[k];
        for (int r = 0; r < rows; r++) {
            const float *restrict row = table + r * n, factor = share[r];
            for (ptrdiff_t k = start; k < stop; k++)
                direction[k] += factor * row[k];
        }
    }
}

/* The direction -H g from the gradient and P g, and its slope. */
static double choose_direction(Descent *d)
{
    const ptrdiff_t n = 2 * d->spectrum.mi * d->spectrum.mj;
    const int count = d->count, *order = d->order;
    const double *products = d->products;
    double alpha[PAIRS], rest[PAIRS], scale = 1.0, slope;
    float share[2 * PAIRS];
    if (count > 0)
        scale = d->sy[order[count - 1]][order[count - 1]] / d->yz[order[count - 1]][order[count - 1]];
    for (int k = count - 1; k >= 0; k--) {
        double sum = products[2 * order[k]];
        for (int l = k + 1; l < count; l++)
            sum -= d->sy[order[k]][order[l]] * alpha[l];
        alpha[k] = sum / d->sy[order[k]][order[k]];
    }
    for (int k = 0; k < count; k++) {
        double sum = products[2 * order[k] + 1];
        for (int l = 0; l < count; l++)
            sum -= d->yz[order[k]][order[l]] * alpha[l];
        sum *= scale;
        for (int l = 0; l < k; l++)
            sum += rest[l] * d->sy[order[l]][order[k]];
        rest[k] = alpha[k] - sum / d->sy[order[k]][order[k]];
    }
    for (int k = 0; k < count; k++)
        share[2 * order[k]] = (float)-rest[k], share[2 * order[k] + 1] = (float)(scale * alpha[k]);
    descent_combine(d->table, 2 * count, share, d->steepest, (float)scale, n, d->direction);
    descent_products(d->direction, 1, d->gradient, n, &slope);
    return slope;
}

/* The largest move of `direction`, in cells. */
MESHONET_CLONES
double descent_largest(const Descent *d)
{
    const ptrdiff_t n = d->spectrum.mi * d->spectrum.mj;
    const float *restrict fx = d->frame, *restrict fy = d->frame + n;
    const float *restrict dx = d->direction, *restrict dy = d->direction + n;
    float most = 0.0f;
    for (ptrdiff_t k = 0; k < n; k++) {
        const float move = (dx[k] * dx[k] + dy[k] * dy[k]) / (fx[k] * fx[k] + fy[k] * fy[k] + 1e-36f);
        most = move > most ? move : most;
    }
    return sqrt((double)most);
}

/* Planes of z moved by `factor` directions. */
MESHONET_CLONES
static void move(const Descent *d, double factor, double *restrict to)
{
    const ptrdiff_t nj = d->nj, nodes = d->ni * nj, mi = d->spectrum.mi, mj = d->spectrum.mj;
    memcpy(to, d->z, 2 * (size_t)nodes * sizeof *to);
    for (int c = 0; c < 2; c++) {
        for (ptrdiff_t i = 0; i < mi; i++) {
            const float *restrict step = d->direction + (c * mi + i) * mj;
            double *restrict row = to + c * nodes + (d->first + i) * nj + 1;
            for (ptrdiff_t j = 0; j < mj; j++)
                row[j] += factor * (double)step[j];
        }
        if (d->weights.periodic)
            memcpy(to + c * nodes + (d->ni - 1) * nj, to + c * nodes, (size_t)nj * sizeof *to);
    }
}

/* The factor to the minimum of the parabola through both values and the slope, .1 to .5. */
static double shorter(double rise, double slope)
{
    if (!isfinite(rise))
        return 0.5;
    const double factor = -0.5 * slope / (rise - slope);
    return factor < 0.1 ? 0.1 : factor > 0.5 ? 0.5 : factor;
}

/* Add the step, whose slope was `slope`, the gradient's change y and P y, unless the functional bends down along the
   step; then the products of all rows with the new gradient. Those with y are the changes of these. */
MESHONET_CLONES
static void remember(Descent *d, double factor, double slope)
{
    const ptrdiff_t n = 2 * d->spectrum.mi * d->spectrum.mj;
    const double *restrict old = d->gradient, *restrict fresh = d->fresh;
    double before[2 * PAIRS], steps = 0.0, changes = 0.0, curvature = 0.0, turned = 0.0;
    const float *restrict step = d->direction;
    for (ptrdiff_t k = 0; k < n; k++) {
        const double s = (double)step[k], y = fresh[k] - old[k];
        steps += s * s, changes += y * y, curvature += s * y;
        turned += old[k] * (double)(d->turned[k] - d->steepest[k]);
    }
    const int bends = curvature > 1e-12 * sqrt(steps * changes);
    int slot = d->count;
    memcpy(before, d->products, sizeof before);
    if (bends) {
        if (d->count == PAIRS) {
            slot = d->order[0];
            memmove(d->order, d->order + 1, (PAIRS - 1) * sizeof *d->order);
            d->count--;
        }
        d->order[d->count++] = slot;
        float *restrict s = d->table + 2 * slot * n, *restrict z = s + n;
        for (ptrdiff_t k = 0; k < n; k++)
            s[k] = (float)factor * step[k], z[k] = d->turned[k] - d->steepest[k];
        before[2 * slot] = factor * slope, before[2 * slot + 1] = turned;
    }
    descent_products(d->table, 2 * d->count, fresh, n, d->products);
    for (int k = 0; bends && k < d->count; k++) {
        const int other = d->order[k];
        d->sy[slot][other] = 0.0;
        d->sy[other][slot] = d->products[2 * other] - before[2 * other];
        d->yz[slot][other] = d->yz[other][slot] = d->products[2 * other + 1] - before[2 * other + 1];
    }
}

int descent_step(Descent *d)
{
    const ptrdiff_t nodes = d->ni * d->nj, n = 2 * d->spectrum.mi * d->spectrum.mj;
    double slope = choose_direction(d);
    if (!(slope < 0.0) && d->count > 0) {
        d->count = 0;
        slope = choose_direction(d);
    }
    if (!(slope < 0.0))
        return STUCK;
    const double largest = descent_largest(d);
    double factor = d->count == 0 && largest > d->reach ? d->reach / largest : 1.0, value = 0.0, low = 0.0;
    int tries = 0;
    for (; tries < TRIES; tries++) {
        move(d, factor, d->full);
        value = evaluate(d, d->full, d->fresh, &low);
        if (value <= d->value + 1e-4 * factor * slope)
            break;
        factor *= shorter(value - d->value, factor * slope);
    }
    if (tries == TRIES) { /* what is remembered misleads, or nothing helps */
        const int state = d->count > 0 ? GOES_ON : STUCK;
        d->count = 0;
        return state;
    }
    const double gain = d->value - value;
    memcpy(d->z, d->full, 2 * (size_t)nodes * sizeof *d->z);
    d->value = value, d->smallest = low;
    descent_precondition(d, d->fresh, d->turned);
    remember(d, factor, slope);
    memcpy(d->gradient, d->fresh, (size_t)n * sizeof *d->gradient);
    memcpy(d->steepest, d->turned, (size_t)n * sizeof *d->steepest);
    /* small steps that still gain, or that were cut short, say nothing of the distance to the minimum */
    const int small = factor * largest < d->still && (factor > 0.4 || largest < d->still);
    d->idle = small && gain < GAIN * value ? d->idle + 1 : 0;
    return d->idle == IDLE ? SETTLED : GOES_ON;
}
