/* Solution of the linear system of a step by several threads; the result does not depend on their number. */
#pragma once
#include "step.h"
#include "team.h"

#define CHUNK 256 /* nodes that are added up together */
#define SUMS 6 /* of a round, in each chunk */

typedef struct {
    Step step;
    ptrdiff_t red_chunks, chunks;
    double tolerance;   /* of the residual, relative to the right side */
    int most;           /* iterations */
    double *p, *s;      /* (3, rows) directions */
    double *r, *r0, *v, *t; /* (3, nodes) */
    double *sums;       /* (SUMS, chunks) */
} Solver;

/* The nodes of a chunk: those of both kinds are not mixed. */
static inline Range chunk_range(const Solver *solver, ptrdiff_t chunk)
{
    const ptrdiff_t red = solver->step.graph->red, from = chunk - solver->red_chunks;
    const ptrdiff_t first = from < 0 ? chunk * CHUNK : red + from * CHUNK, end = from < 0 ? red : solver->step.graph->nodes;
    return (Range){first, first + CHUNK < end ? first + CHUNK : end};
}

/* For each of the Range `chunks`: its `range` of nodes. */
#define EACH(solver, chunk, chunks, range)                                     \
    for (ptrdiff_t chunk = (chunks).first; chunk < (chunks).last; chunk++)     \
        for (Range range = chunk_range(solver, chunk); range.first >= 0; range.first = -1)

/* Solve for step.change from what it holds. Returns the iterations, negative where they diverged. */
int solve_step(Solver *solver, Member member);
