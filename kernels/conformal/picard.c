/* Modes and columns lie in rows of levels, so that every operation of a transform or product is one on whole
   rows. Transforms leave and take the modes in bit-reversed order, which saves the reordering. */

#include "picard.h"

#include <math.h>

#include "fft.h"

#define LEVELS PICARD_LEVELS
#define COUNT PICARD_COUNT
#define COLUMNS PICARD_COLUMNS
#define PARTS (LEVELS / LANES)

static const double TURN = 6.283185307179586476925;

MESHONET_INLINE int wavenumber(int mode) { return mode <= PICARD_MODES ? mode : mode - COUNT; }

/* The row of a transform that holds a mode. */
MESHONET_INLINE int place(int mode) { return (int)reversed(wavenumber(mode) & (COLUMNS - 1), COLUMNS); }

/* Modes, bit-reversed, to columns: the sum of c_k exp(i k theta). WIDTH levels at a time stay in the cache. */
MESHONET_INLINE void to_columns(PicardField *f, double (*unit)[2])
{
    for (int l = 0; l < LEVELS; l += WIDTH)
        for (int size = 2; size <= COLUMNS; size *= 2)
            for (int j = 0; j < size / 2; j++)
                for (int a = j; a < COLUMNS; a += size) {
                    const int b = a + size / 2;
                    pair_up(f->re[a] + l, f->im[a] + l, f->re[b] + l, f->im[b] + l, unit[j * (COLUMNS / size)]);
                }
}

/* Columns to modes, bit-reversed, times COLUMNS. */
MESHONET_INLINE void to_modes(PicardField *f, double (*unit)[2])
{
    for (int l = 0; l < LEVELS; l += WIDTH)
        for (int size = COLUMNS; size >= 2; size /= 2)
            for (int j = 0; j < size / 2; j++)
                for (int a = j; a < COLUMNS; a += size) {
                    const int b = a + size / 2;
                    pair_down(f->re[a] + l, f->im[a] + l, f->re[b] + l, f->im[b] + l, unit[j * (COLUMNS / size)]);
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
                const Lanes column = LOAD(matrix[m] + p * LANES);
                ADD_PRODUCT(a[p], rows[r][m], column);
                ADD_PRODUCT(b[p], rows[r + 1][m], column);
            }
        for (int p = 0; p < PARTS; p++) {
            STORE(out[r] + p * LANES, a[p]);
            STORE(out[r + 1] + p * LANES, b[p]);
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
    for (int k = 0; k < 5; k++) to_columns(all[k], unit);
    residual(s, height);
    to_modes(&s->residual, unit);
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
    to_columns(&s->t, unit);
    double largest = 0.0, all_squares = 0.0;
    const double *re = s->t.re[0], *im = s->t.im[0];
    for (int l = 0; l < COLUMNS * LEVELS; l++) {
        const double square = re[l] * re[l] + im[l] * im[l];
        largest = square > largest ? square : largest;
        all_squares += square;
    }
    return isfinite(all_squares) ? sqrt(largest) : INFINITY;
}
