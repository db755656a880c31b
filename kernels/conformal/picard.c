/* Transforms of many series at once, Picard's step in the strip, and Fourier sums of its solution. Modes and columns
   lie in rows of levels; transforms leave and take modes in bit-reversed order. Cooley & Tukey (1965). */
#include "picard.h"
#include "clones.h"
#include "lanes.h"
#include <math.h>

#define LEVELS PICARD_LEVELS
#define COUNT PICARD_COUNT
#define COLUMNS PICARD_COLUMNS
#define PARTS (LEVELS / LANES)
#define BLOCK 128 /* rows that stay in the first-level cache while they are combined with each other */

static const double TURN = 6.283185307179586476925;

MESHONET_INLINE ptrdiff_t reversed(ptrdiff_t k, ptrdiff_t count)
{
    ptrdiff_t r = 0;
    for (ptrdiff_t bit = 1; bit < count; bit *= 2) r = 2 * r + ((k & bit) != 0);
    return r;
}

/* a, b <- a + u b, a - u b, for LANES series. */
MESHONET_INLINE void pair_up(double *ar, double *ai, double *br, double *bi, const double *unit)
{
    const double wr = unit[0], wi = unit[1];
    const Lanes b = OF(br), c = OF(bi), tr = wr * b - wi * c, ti = wr * c + wi * b, r = OF(ar), i = OF(ai);
    AT(br) = r - tr, AT(bi) = i - ti;
    AT(ar) = r + tr, AT(ai) = i + ti;
}

/* a, b <- a + b, (a - b) / u */
MESHONET_INLINE void pair_down(double *ar, double *ai, double *br, double *bi, const double *unit)
{
    const double wr = unit[0], wi = -unit[1];
    const Lanes tr = AT(ar) - AT(br), ti = AT(ai) - AT(bi);
    AT(ar) += AT(br), AT(ai) += AT(bi);
    AT(br) = wr * tr - wi * ti, AT(bi) = wr * ti + wi * tr;
}

MESHONET_INLINE int wavenumber(int mode) { return mode <= PICARD_MODES ? mode : mode - COUNT; }

/* The row of a transform that holds a mode. */
MESHONET_INLINE int place(int mode) { return (int)reversed(wavenumber(mode) & (COLUMNS - 1), COLUMNS); }

/* Modes, bit-reversed, to columns: the sum of c_k exp(i k theta); or `back` to modes times COLUMNS. LANES levels at a
   time stay in the cache. */
MESHONET_INLINE void transform(PicardField *f, double (*unit)[2], const int back)
{
    for (int l = 0; l < LEVELS; l += LANES)
        for (int size = back ? COLUMNS : 2; 2 <= size && size <= COLUMNS; size = back ? size / 2 : 2 * size)
            for (int j = 0; j < size / 2; j++)
                for (int a = j; a < COLUMNS; a += size) {
                    const int b = a + size / 2;
                    const double *u = unit[j * (COLUMNS / size)];
                    if (back)
                        pair_down(f->re[a] + l, f->im[a] + l, f->re[b] + l, f->im[b] + l, u);
                    else
                        pair_up(f->re[a] + l, f->im[a] + l, f->re[b] + l, f->im[b] + l, u);
                }
}

/* Rows (2 COUNT, LEVELS) times a matrix, two at a time: their sums stay in registers. */
MESHONET_INLINE void product(const PicardRow *rows, const PicardRow *matrix, PicardRow *out)
{
    for (int r = 0; r < 2 * COUNT; r += 2) {
        Lanes a[PARTS], b[PARTS];
        for (int p = 0; p < PARTS; p++) a[p] = b[p] = (Lanes){0};
        for (int m = 0; m < LEVELS; m++)
            for (int p = 0; p < PARTS; p++) {
                const Lanes column = OF(matrix[m] + p * LANES);
                a[p] += rows[r][m] * column;
                b[p] += rows[r + 1][m] * column;
            }
        for (int p = 0; p < PARTS; p++) {
            AT(out[r] + p * LANES) = a[p];
            AT(out[r + 1] + p * LANES) = b[p];
        }
    }
}

/* `f`, in place of modes: factor times (i k)^power times c. */
MESHONET_INLINE void place_modes(PicardField *f, const PicardRow *c, int power)
{
    for (int mode = 0; mode < COUNT; mode++) {
        const double k = wavenumber(mode), factor = power == 2 ? -k * k : power == 1 ? k : 1.0;
        const double *re = c[mode], *im = c[COUNT + mode];
        double *to_re = f->re[place(mode)], *to_im = f->im[place(mode)];
        for (int l = 0; l < LEVELS; l++) {
            to_re[l] = power == 1 ? -factor * im[l] : factor * re[l];
            to_im[l] = power == 1 ? factor * re[l] : factor * im[l];
        }
    }
    for (int l = 0; l < LEVELS; l++) f->re[reversed(COLUMNS / 2, COLUMNS)][l] = f->im[reversed(COLUMNS / 2, COLUMNS)][l] = 0.0;
}

/* Winslow's residual over half the mean of what multiplies the update; see strip.py. */
MESHONET_INLINE void residual(PicardScratch *s, double height)
{
    const double *tr = s->t.re[0], *ti = s->t.im[0], *er = s->e.re[0], *ei = s->e.im[0], *ttr = s->tt.re[0];
    const double *tti = s->tt.im[0], *ter = s->te.re[0], *tei = s->te.im[0], *eer = s->ee.re[0], *eei = s->ee.im[0];
    double *restrict rr = s->residual.re[0], *restrict ri = s->residual.im[0];
    MESHONET_INDEPENDENT
    for (int l = 0; l < COLUMNS * LEVELS; l++) {
        const double wi = ti[l] + 1.0, alpha = er[l] * er[l] + ei[l] * ei[l], gamma = tr[l] * tr[l] + wi * wi;
        const double beta = tr[l] * er[l] + wi * ei[l], scale = 2.0 / (alpha / (height * height) + gamma);
        rr[l] = (alpha * ttr[l] - 2.0 * beta * ter[l] + gamma * eer[l]) * scale;
        ri[l] = (alpha * tti[l] - 2.0 * beta * tei[l] + gamma * eei[l]) * scale;
    }
}

/* Modes of the residual, in eigenvectors, to those of the update. */
MESHONET_INLINE void divide(PicardRow *values, const PicardMatrices *m, double height)
{
    for (int mode = 0; mode < COUNT; mode++) {
        const double kT = wavenumber(mode) * height, smooth = m->smooth[mode] / COLUMNS;
        for (int l = 0; l < LEVELS; l++) {
            const double factor = smooth / (m->eigenvalues[l] - kT * kT);
            values[mode][l] *= factor;
            values[COUNT + mode][l] *= factor;
        }
    }
}

MESHONET_CLONES
double picard_step(PicardRow *c, double height, const PicardMatrices *m, PicardScratch *s)
{
    double unit[COLUMNS / 2][2];
    for (int j = 0; j < COLUMNS / 2; j++) unit[j][0] = cos(TURN * j / COLUMNS), unit[j][1] = sin(TURN * j / COLUMNS);
    PicardRow *one = s->flat[0], *two = s->flat[1];
    place_modes(&s->t, c, 1);
    place_modes(&s->tt, c, 2);
    product(c, m->d1, one);
    place_modes(&s->e, one, 0);
    place_modes(&s->te, one, 1);
    product(c, m->d2, one);
    place_modes(&s->ee, one, 0);
    PicardField *all[] = {&s->t, &s->tt, &s->e, &s->te, &s->ee};
    for (int k = 0; k < 5; k++) transform(all[k], unit, 0);
    residual(s, height);
    transform(&s->residual, unit, 1);
    for (int mode = 0; mode < COUNT; mode++)
        for (int l = 0; l < LEVELS; l++) {
            one[mode][l] = s->residual.re[place(mode)][l];
            one[COUNT + mode][l] = s->residual.im[place(mode)][l];
        }
    product(one, m->inverse, two);
    divide(two, m, height);
    product(two, m->vectors, one);
    for (int r = 0; r < 2 * COUNT; r++)
        for (int l = 0; l < LEVELS; l++) c[r][l] -= one[r][l];
    place_modes(&s->t, one, 0);
    transform(&s->t, unit, 0);
    double largest = 0.0, all_squares = 0.0;
    const double *re = s->t.re[0], *im = s->t.im[0];
    for (int l = 0; l < COLUMNS * LEVELS; l++) {
        const double square = re[l] * re[l] + im[l] * im[l];
        largest = square > largest ? square : largest;
        all_squares += square;
    }
    return isfinite(all_squares) ? sqrt(largest) : INFINITY;
}

/* Transforms of `size` rows from those of their halves. */
MESHONET_INLINE void combine(double *rows, ptrdiff_t size, const double *unit, ptrdiff_t step, ptrdiff_t width)
{
    const ptrdiff_t half = size / 2, apart = 2 * width;
    for (ptrdiff_t j = 0; j < half; j++) {
        double *a = rows + j * apart, *b = a + half * apart;
        pair_up(a, a + width, b, b + width, unit + 2 * j * step);
    }
}

MESHONET_CLONES
void fourier_columns(const double *modes, ptrdiff_t m, ptrdiff_t highest, const double *gain, const double *unit,
                   double *columns, ptrdiff_t count, ptrdiff_t width)
{
    for (ptrdiff_t k = -highest; k <= highest; k++) {
        const double factor = gain[k < 0 ? -k : k];
        const double *from = modes + 2 * (k < 0 ? 2 * highest + 1 + k : k);
        double *row = columns + reversed(k & (count - 1), count) * 2 * width;
        for (ptrdiff_t l = 0; l < m; l++, from += 2 * (2 * highest + 1))
            row[l] = factor * from[0], row[width + l] = factor * from[1];
    }
    for (ptrdiff_t l = 0; l < width; l += LANES) {
        const ptrdiff_t block = count < BLOCK ? count : BLOCK;
        for (ptrdiff_t a = 0; a < count; a += block)
            for (ptrdiff_t size = 2; size <= block; size *= 2)
                for (ptrdiff_t b = a; b < a + block; b += size)
                    combine(columns + b * 2 * width + l, size, unit, count / size, width);
        for (ptrdiff_t size = 2 * block; size <= count; size *= 2)
            for (ptrdiff_t b = 0; b < count; b += size)
                combine(columns + b * 2 * width + l, size, unit, count / size, width);
    }
}
