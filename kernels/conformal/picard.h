/* One step of Picard's iteration in the strip; see strip.py. */
#ifndef MESHONET_PICARD_H
#define MESHONET_PICARD_H

#define PICARD_MODES 63
#define PICARD_COUNT (2 * PICARD_MODES + 1)
#define PICARD_LEVELS 40
#define PICARD_COLUMNS 128

typedef double PicardRow[PICARD_LEVELS];

/* Real and imaginary parts, a row of levels for each mode or column. */
typedef struct { PicardRow re[PICARD_COLUMNS], im[PICARD_COLUMNS]; } PicardField;

/* Matrices are transposed: a row of levels times one of them. The eigenvectors have zeros for the two walls. */
typedef struct {
    const PicardRow *d1, *d2, *inverse, *vectors;
    const double *eigenvalues, *smooth; /* (PICARD_LEVELS,), (PICARD_COUNT,) */
} PicardMatrices;

typedef struct { PicardField t, tt, e, te, ee, residual; PicardRow flat[2][2 * PICARD_COUNT]; } PicardScratch;

/* c: real parts of the modes k = 0 .. MODES, -MODES .. -1, then imaginary ones; its walls stay as they are.
   Returns the largest change of a column's value. */
double picard_step(PicardRow *c, double height, const PicardMatrices *m, PicardScratch *s);

#endif
