/* What steps.c needs of the functional over quads: moves, values and a preconditioner. */
#include "descent.h"
#include "clones.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FLOOR 0.02     /* of the mean square of lengths: shorter edges are as stiff as these */
#define SHIFT 1e-9     /* of the mean diagonal, added to it */
#define MANY 100000 /* unknowns from which on inner and wall nodes do not know of each other: a fourth of the work */
#define STIFFNESS 3.0  /* of an edge, over its length squared and the number of cells */

/* Row k's share of the moves of a node, (2,) or for free nodes a row of the unit matrix. */
typedef struct {
    ptrdiff_t first;
    int count;
    double along[2][2];
} Moves;

static Moves moves_of(const QuadDescent *d, ptrdiff_t node)
{
    Moves m = {d->unknown[node], 0, {{0.0}}};
    if (m.first < 0)
        return m;
    if (d->stiffness.sides == 2) {
        m.first /= 2, m.count = 1, m.along[0][0] = 1.0;
    } else if (d->wall[node] >= 0) {
        const double *tangent = d->walls.tangent + 2 * d->wall[node];
        m.count = 1, m.along[0][0] = tangent[0], m.along[0][1] = tangent[1];
    } else {
        m.count = 2, m.along[0][0] = m.along[1][1] = 1.0;
    }
    return m;
}

/* Entries of the matrix: the diagonal, then those between the rows of the ends of each edge; with `rows` where they
   are, with `values` what is added where. */
static ptrdiff_t assemble(const QuadDescent *d, ptrdiff_t *rows, ptrdiff_t *columns, double *values,
                          const ptrdiff_t *slot, const double *stiff)
{
    const ptrdiff_t n = d->stiffness.pattern.n;
    ptrdiff_t entry = n;
    if (rows)
        for (ptrdiff_t k = 0; k < n; k++)
            rows[k] = columns[k] = k;
    for (ptrdiff_t e = 0; e < d->mesh.edges; e++) {
        const Moves a = moves_of(d, d->mesh.edge[2 * e]), b = moves_of(d, d->mesh.edge[2 * e + 1]);
        for (int i = 0; values && i < a.count; i++)
            values[slot[a.first + i]] += stiff[e];
        for (int i = 0; values && i < b.count; i++)
            values[slot[b.first + i]] += stiff[e];
        for (int i = 0; i < a.count; i++)
            for (int j = 0; j < b.count; j++) {
                if (a.count == 2 && b.count == 2 ? i != j : n > MANY && a.count != b.count)
                    continue;
                if (rows)
                    rows[entry] = a.first + i, columns[entry] = b.first + j;
                if (values)
                    values[slot[entry]] -=
                        stiff[e] * (a.along[i][0] * b.along[j][0] + a.along[i][1] * b.along[j][1]);
                entry++;
            }
    }
    return entry;
}

static int analyse(QuadDescent *d)
{
    Stiffness *s = &d->stiffness;
    s->sides = d->steps.n == 2 * d->free_count ? 2 : 1;
    const ptrdiff_t n = d->steps.n / s->sides, most = n + 2 * d->mesh.edges;
    ptrdiff_t *rows = malloc(2 * (size_t)(most + 1) * sizeof *rows);
    s->slot = malloc((size_t)(most + 1) * sizeof *s->slot);
    s->pattern.order = malloc(2 * (size_t)(n + 1) * sizeof(int));
    s->pattern.start = malloc(2 * (size_t)(n + 1) * sizeof(ptrdiff_t));
    s->pattern.row = malloc((size_t)(most + 1) * sizeof(int));
    int failed = !rows || !s->slot || !s->pattern.order || !s->pattern.start || !s->pattern.row;
    if (!failed) {
        s->pattern.parent = s->pattern.order + n + 1, s->pattern.fill = s->pattern.start + n + 1;
        s->pattern.n = (int)n;
        s->entries = assemble(d, rows, rows + most, NULL, NULL, NULL);
        failed = sparse_analyse((int)n, s->entries, rows, rows + most, 1, &s->pattern, s->slot) < 0;
    }
    if (!failed) {
        const size_t distinct = (size_t)s->pattern.start[n], fill = (size_t)s->pattern.fill[n];
        s->values = malloc((distinct + fill + (1 + 2 * (size_t)s->sides) * (size_t)n + 1) * sizeof(double));
        s->lower_row = malloc((fill + 1) * sizeof(int));
        failed = !s->values || !s->lower_row;
        if (!failed) {
            s->lower = s->values + distinct, s->pivots = s->lower + fill;
            s->right = s->pivots + n, s->scratch = s->right + s->sides * n;
        }
    }
    free(rows);
    if (failed)
        quad_descent_free(d);
    return failed ? -1 : 0;
}

static int make_stiffness(QuadDescent *d)
{
    Stiffness *s = &d->stiffness;
    const ptrdiff_t edges = d->mesh.edges;
    double *stiff = d->mesh.length, mean = 0.0;
    if (!s->slot && analyse(d) < 0)
        return -1;
    const ptrdiff_t n = s->pattern.n;
    for (ptrdiff_t e = 0; e < edges; e++) {
        const ptrdiff_t a = 2 * d->mesh.edge[2 * e], b = 2 * d->mesh.edge[2 * e + 1];
        const double dx = d->x[b] - d->x[a], dy = d->x[b + 1] - d->x[a + 1];
        stiff[e] = dx * dx + dy * dy;
        mean += stiff[e] / (double)edges;
    }
    for (ptrdiff_t e = 0; e < edges; e++)
        stiff[e] = STIFFNESS / ((double)d->mesh.cells * (stiff[e] > FLOOR * mean ? stiff[e] : FLOOR * mean));
    memset(s->values, 0, (size_t)s->pattern.start[n] * sizeof(double));
    assemble(d, NULL, NULL, s->values, s->slot, stiff);
    double diagonal = 0.0;
    for (ptrdiff_t k = 0; k < n; k++)
        diagonal += s->values[s->slot[k]] / (double)n;
    for (ptrdiff_t k = 0; k < n; k++)
        s->values[s->slot[k]] += SHIFT * diagonal;
    const ptrdiff_t bad = sparse_factor(&s->pattern, s->values, s->lower_row, s->lower, s->pivots);
    return bad < 0 ? -1 : bad > 0;
}

void quad_descent_free(QuadDescent *d)
{
    Stiffness *s = &d->stiffness;
    free(s->slot), free(s->pattern.order), free(s->pattern.start), free(s->pattern.row);
    free(s->values), free(s->lower_row);
    memset(s, 0, sizeof *s);
}

size_t quad_descent_doubles(const QuadDescent *d, ptrdiff_t unknowns)
{
    return (size_t)(2 * d->mesh.nodes + 5 * unknowns + 2 * d->mesh.edges + 9 * d->walls.nodes) +
           quad_batches(&d->mesh) / sizeof(double) + 1;
}

void quad_descent_place(QuadDescent *d, ptrdiff_t unknowns, double *doubles, float *floats)
{
    Walls *w = &d->walls;
    const ptrdiff_t n = d->mesh.nodes, count = w->nodes;
    d->g = doubles, d->here = d->g + 2 * n, d->there = d->here + unknowns;
    d->inverse_size = d->there + unknowns;
    steps_place(&d->steps, unknowns, d->inverse_size + unknowns, d->inverse_size + 2 * unknowns, floats);
    d->mesh.length = d->inverse_size + 3 * unknowns, d->mesh.force = d->mesh.length + d->mesh.edges;
    w->tangent = d->mesh.force + d->mesh.edges, w->turned = w->tangent + 2 * count;
    w->turning = w->turned + count, w->force = w->turning + count, w->place = w->force + count;
    w->point = w->place + count;
    d->mesh.rests = (unsigned char *)(w->point + 2 * count);
}

/* Nodes from unknowns. */
static void set_nodes(QuadDescent *d, const double *at, int first_time)
{
    for (ptrdiff_t k = 0; k < d->free_count; k++)
        d->x[2 * d->free[k]] = at[2 * k], d->x[2 * d->free[k] + 1] = at[2 * k + 1];
    for (ptrdiff_t k = 0; k < d->walls.nodes; k++)
        if (d->walls.unknown[k] >= 0)
            d->walls.arc[k] = at[d->walls.unknown[k]];
    walls_place(&d->walls, d->x, first_time);
    for (ptrdiff_t k = 0; k < d->tied_count; k++)
        for (int c = 0; c < 2; c++)
            d->x[2 * d->tied[2 * k] + c] = d->x[2 * d->tied[2 * k + 1] + c] + d->shift[2 * k + c];
}

static void get_unknowns(const QuadDescent *d, double *to)
{
    for (ptrdiff_t k = 0; k < d->free_count; k++)
        to[2 * k] = d->x[2 * d->free[k]], to[2 * k + 1] = d->x[2 * d->free[k] + 1];
    for (ptrdiff_t k = 0; k < d->walls.nodes; k++)
        if (d->walls.unknown[k] >= 0)
            to[d->walls.unknown[k]] = d->walls.arc[k];
}

/* The functional at the nodes, and its gradient by the unknowns. */
static double value_at_nodes(QuadDescent *d, double *gradient, double *smallest)
{
    const Walls *w = &d->walls;
    const double bends = walls_energy(w, d->bent, d->allowed);
    if (!isfinite(bends))
        return INFINITY;
    const double energy = quad_energy(&d->mesh, d->x, d->g, smallest);
    if (!isfinite(energy))
        return INFINITY;
    for (ptrdiff_t k = 0; k < d->tied_count; k++)
        for (int c = 0; c < 2; c++)
            d->g[2 * d->tied[2 * k + 1] + c] += d->g[2 * d->tied[2 * k] + c];
    for (ptrdiff_t k = 0; k < d->free_count; k++)
        gradient[2 * k] = d->g[2 * d->free[k]], gradient[2 * k + 1] = d->g[2 * d->free[k] + 1];
    for (ptrdiff_t k = 0; k < w->nodes; k++)
        if (w->unknown[k] >= 0) {
            const double *g = d->g + 2 * w->node[k], *t = w->tangent + 2 * k;
            gradient[w->unknown[k]] = g[0] * t[0] + g[1] * t[1] + w->force[k];
        }
    return energy + bends;
}

MESHONET_CLONES
static double attempt(void *problem, double factor, double *smallest)
{
    QuadDescent *d = problem;
    const float *restrict direction = d->steps.direction;
    for (ptrdiff_t k = 0; k < d->steps.n; k++)
        d->there[k] = d->here[k] + (factor > 0.0 ? factor * (double)direction[k] : 0.0);
    set_nodes(d, d->there, 0);
    return value_at_nodes(d, d->steps.fresh, smallest);
}

static void keep(void *problem)
{
    QuadDescent *d = problem;
    memcpy(d->here, d->there, (size_t)d->steps.n * sizeof *d->here);
}

static void precondition(void *problem, const double *gradient, float *result)
{
    QuadDescent *d = problem;
    Stiffness *s = &d->stiffness;
    const ptrdiff_t n = d->steps.n;
    if (n == 0)
        return;
    memcpy(s->right, gradient, (size_t)n * sizeof *gradient);
    sparse_solve(&s->pattern, s->lower_row, s->lower, s->pivots, s->sides, s->right, s->scratch);
    for (ptrdiff_t k = 0; k < n; k++)
        result[k] = (float)s->right[k];
}

static double largest_move(void *problem)
{
    const QuadDescent *d = problem;
    double most = 0.0;
    for (ptrdiff_t k = 0; k < d->steps.n; k++) {
        const double move = fabs((double)d->steps.direction[k]) * d->inverse_size[k];
        most = move > most ? move : most;
    }
    return most;
}

/* The mean length of the edges at each node, of which moves are parts. */
static void set_sizes(QuadDescent *d)
{
    const ptrdiff_t nodes = d->mesh.nodes;
    double *sum = d->g, *count = d->g + nodes;
    memset(d->g, 0, 2 * (size_t)nodes * sizeof *d->g);
    for (ptrdiff_t e = 0; e < d->mesh.edges; e++) {
        const ptrdiff_t a = d->mesh.edge[2 * e], b = d->mesh.edge[2 * e + 1];
        const double dx = d->x[2 * b] - d->x[2 * a], dy = d->x[2 * b + 1] - d->x[2 * a + 1], l = sqrt(dx * dx + dy * dy);
        sum[a] += l, sum[b] += l, count[a] += 1.0, count[b] += 1.0;
    }
    for (ptrdiff_t v = 0; v < nodes; v++) {
        const double inverse = count[v] / (sum[v] > 0.0 ? sum[v] : 1.0);
        if (d->unknown[v] >= 0)
            for (int i = 0; i < (d->wall[v] >= 0 ? 1 : 2); i++)
                d->inverse_size[d->unknown[v] + i] = inverse;
    }
}

int quad_descent_start(QuadDescent *d, int renew)
{
    Steps *s = &d->steps;
    s->problem = d, s->attempt = attempt, s->keep = keep, s->precondition = precondition;
    s->largest_move = largest_move;
    set_sizes(d);
    get_unknowns(d, d->here);
    set_nodes(d, d->here, 1);
    const int failed = s->n > 0 && (renew || !d->stiffness.values) ? make_stiffness(d) : 0;
    if (!failed) {
        quad_rest(&d->mesh, d->x, d->unknown); /* after the preconditioner, which uses the same room */
        steps_start(s);
    }
    return failed;
}

void quad_descent_end(QuadDescent *d)
{
    set_nodes(d, d->here, 0);
}
