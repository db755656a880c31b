/* One step of a march over a surface: sizes of the level, then the linear system of its displacement. */
#pragma once
#include "graph.h"

typedef struct {
    double explicit_smoothing, implicit_smoothing; /* eps_e and eps_i */
    double outer;                                  /* factor of eps_e within the level */
    double theta;                                  /* the new level's flux weighs 1 + theta */
    double far;                                    /* how far the march is: (height / half the size)^.15, at most 1 */
    double sharp;                                  /* cosine between normals beyond which an edge is averaged */
    int first;                                     /* no smoothing from the wall itself */
} StepRule;

typedef struct {
    const Graph *graph;
    double *x;              /* (3, rows), rows = nodes + ghosts: the level */
    double *change;         /* (3, rows): displacement to the next level */
    double *area, *reach;   /* (nodes): of the cells around a node, mean distance of its neighbours */
    double *height;         /* (nodes): of the step at each node */
    double *along, *before; /* (2, nodes): lengths of opposite edges together, on this level and the one before */
    double *right;          /* (3, nodes): right side */
    /* the row is diagonal dr + flux (dr_xi, dr_eta) - tie (sum of neighbours' dr): solved to a thousandth, it is kept in
       single precision, since the time goes into reading it */
    float *flux;           /* (18, nodes): two matrices, row by row, for differences along xi and eta */
    float *diagonal, *tie; /* (nodes) */
    const int *near;       /* (4, nodes): that of the graph */
} Step;

/* Areas, lengths and reach of nodes first .. last - 1, their ghosts filled; the least reach. */
double step_sizes(const Step *step, ptrdiff_t first, ptrdiff_t last);
/* The rows of nodes first .. last - 1, from the heights of the step. */
void step_rows(const Step *step, const StepRule *rule, ptrdiff_t first, ptrdiff_t last);
/* out = weight (mean of neighbours' values) + (1 - weight) values, for nodes first .. last - 1; their sum. */
double step_smooth(const Step *step, const double *values, double *out, double weight, ptrdiff_t first,
                   ptrdiff_t last);
