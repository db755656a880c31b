/* Picard's iteration in the strip (strip.py) and samples of Fourier sums at equal steps (nufft.py). */
#pragma once
#include <stddef.h>

#define PICARD_MODES 63 /* these three as in solvers/conformal/strip.py */
#define PICARD_COUNT (2 * PICARD_MODES + 1)
#define PICARD_LEVELS 40
#define PICARD_COLUMNS 128

typedef double PicardRow[PICARD_LEVELS];

/* Real and imaginary parts, a row of levels for each mode or column. */
typedef struct { PicardRow re[PICARD_COLUMNS], im[PICARD_COLUMNS]; } PicardField;

/* Matrices are transposed, a row of levels times one of them: first and second derivative, the inverse of the
   eigenvectors of the latter, and these, with zeros for the two walls. */
typedef struct {
    const PicardRow *d1, *d2, *inverse, *vectors;
    const double *eigenvalues, *smooth; /* (PICARD_LEVELS,), (PICARD_COUNT,) */
} PicardMatrices;

typedef struct { PicardField t, tt, e, te, ee, residual; PicardRow flat[2][2 * PICARD_COUNT]; } PicardScratch;

/* c: real parts of the modes k = 0 .. MODES, -MODES .. -1, then imaginary ones; its walls stay as they are.
   Returns the largest change of a column's value. */
double picard_step(PicardRow *c, double height, const PicardMatrices *m, PicardScratch *s);

/* `columns` (count, 2, width), zeroed, real parts before imaginary ones, from `modes` (m, 2 highest + 1) in
   complex pairs, k = 0 .. highest, -highest .. -1, each times gain[|k|]; highest < count / 2, m <= width, a
   multiple of LANES. `unit` (count / 2, 2) holds exp(2 pi i j / count). */
void fourier_columns(const double *modes, ptrdiff_t m, ptrdiff_t highest, const double *gain, const double *unit,
                   double *columns, ptrdiff_t count, ptrdiff_t width);
