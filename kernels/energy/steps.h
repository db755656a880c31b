/* Minimisation of any function by L-BFGS: steps along directions that follow from earlier steps and a preconditioner. */
#pragma once
#include <stddef.h>

enum { GOES_ON, SETTLED, STUCK };
#define PAIRS 14 /* steps that are remembered */

/* A descent under way, over n unknowns that `problem` holds. */
typedef struct {
    ptrdiff_t n;
    int threads; /* that work on the table, with the same result for any number */
    double *gradient, *fresh;                    /* (n,) here, and where a step was tried */
    float *direction, *steepest, *turned, *table; /* (n,); the table has 2 PAIRS rows */
    double sy[PAIRS][PAIRS], yz[PAIRS][PAIRS];
    double products[2 * PAIRS]; /* of the rows of the table with the gradient */
    int order[PAIRS], count, idle;
    double value, smallest; /* here; the smallest Jacobian */
    double reach, farthest; /* the largest move in a first step, in any step */
    double still, gain;     /* moves and parts of the value below which a step counts as standing still */
    void *problem;
    /* Value at `factor` directions from here (with 0: here), its gradient in `fresh`; infinite where none may be. */
    double (*attempt)(void *problem, double factor, double *smallest);
    void (*keep)(void *problem); /* what was tried last is here now */
    void (*precondition)(void *problem, const double *gradient, float *result);
    double (*largest_move)(void *problem); /* of a whole direction */
} Steps;

/* Floats that a descent needs, and their places in it. */
size_t steps_floats(ptrdiff_t n);
void steps_place(Steps *s, ptrdiff_t n, double *gradient, double *fresh, float *floats);

/* Value and gradient; then one iteration at a time. */
void steps_start(Steps *s);
int steps_take(Steps *s);

/* Forget what is remembered, after the preconditioner has changed. */
void steps_forget(Steps *s);

/* The factor to the minimum of the parabola through both values and the slope, .1 to .5. */
double shorter(double rise, double slope);
