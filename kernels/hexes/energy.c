/* The functional of include/corner3.h over hexahedra in blocks that share nodes:

       E = mean over cells of mean over corners of a S / χ + b (g h q / χ²)^p [+ t (χ + 1/χ) / 2]
         + β N^(2/3) / N sum over pairs of edges of w (Δ log (l / target))²

   Edges of a corner are in units of their target lengths. N is the number of cells. Pairs are opposite edges of a face,
   with w half the number of cells at the face, and consecutive edges, with w a fourth for each face that they bound: the
   last sum is the mean square of the gradient of log l, also across interfaces.

   A block sums the forces of its own cells and edges, and reads one edge across its sides; shared nodes are summed later,
   in the order of blocks. Members of a team work on whole planes: first on even planes of cells, then on odd ones, so
   that no two write to the same plane of nodes.

   Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, ACM Trans. Graph. 40 (2021) 154 (unfolding with volumes). */
#include "energy.h"
#include "cells.h"
#include "clones.h"
#include "energy/corner.h"
#include <math.h>
#include <string.h>

enum { FORCES = 24 }; /* rows of forces on the nodes of a row of cells */

typedef struct {
    const HexMesh *mesh;
    const HexWeights *weights;
    const double *x;
    double *room;
    int stiffness, odd; /* whether forces or the stiffness are wanted, and which planes of cells */
} Task;

static ptrdiff_t row_width(const HexMesh *mesh)
{
    return (mesh->widest + 7) / 8 * 8;
}

size_t hex_room(const HexMesh *mesh)
{
    return (size_t)((FORCES + 2) * row_width(mesh));
}

/* Something done on plane i of a block's places. */
typedef void (*PlaneWork)(const Task *t, const HexBlock *b, ptrdiff_t i);

static void on_planes(const Task *t, PlaneWork work, Member member)
{
    ptrdiff_t all = 0, before = 0;
    for (ptrdiff_t b = 0; b < t->mesh->blocks; b++)
        all += t->mesh->block[b].n[0];
    const Range mine = team_share(all, member);
    for (ptrdiff_t b = 0; b < t->mesh->blocks; b++) {
        const ptrdiff_t n = t->mesh->block[b].n[0];
        for (ptrdiff_t i = mine.first > before ? mine.first - before : 0; i < n && before + i < mine.last; i++)
            work(t, t->mesh->block + b, i);
        before += n;
    }
    team_wait(member);
}

MESHONET_INLINE ptrdiff_t place(const HexBlock *b, ptrdiff_t i, ptrdiff_t j)
{
    return b->places + (i * b->n[1] + j) * b->n[2];
}

/* ---- corners ---- */

MESHONET_CLONES
static void fetch_plane(const Task *t, const HexBlock *b, ptrdiff_t i)
{
    const ptrdiff_t P = t->mesh->places, first = place(b, i, 0), last = place(b, i + 1, 0);
    const int32_t *restrict node = t->mesh->node;
    double *restrict x = t->mesh->x, *restrict y = x + P, *restrict z = y + P;
    for (ptrdiff_t at = first; at < last; at++) {
        const double *from = t->x + 3 * (ptrdiff_t)(node[at] < 0 ? 0 : node[at]);
        x[at] = from[0], y[at] = from[1], z[at] = from[2];
    }
    for (int c = 0; c < (t->stiffness ? 1 : 3); c++)
        memset(t->mesh->g + c * P + first, 0, (size_t)(last - first) * sizeof *x);
}

/* Add forces on the nodes at both ends of cells to a row of nodes. */
MESHONET_INLINE void scatter(const double *restrict low, const double *restrict high, double *restrict g, ptrdiff_t cells)
{
    g[0] += low[0];
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 1; k < cells; k++)
        g[k] += low[k] + high[k - 1];
    g[cells] += high[cells - 1];
}

MESHONET_CLONES
static void one_row(const Task *t, const CellRow *row, double *energy, double *least)
{
    const HexWeights *w = t->weights;
    const ptrdiff_t width = row_width(t->mesh);
    double low = INFINITY, *lowest = t->room + FORCES * width;
    if (t->stiffness) {
        if (w->power == SHAPES)
            stiffness_row(row, t->room, width, SHAPES, 0);
        else if (w->epsilon > 0.0)
            stiffness_row(row, t->room, width, 1, 1);
        else
            stiffness_row(row, t->room, width, w->power, 0);
        return;
    }
    if (w->power == SHAPES)
        *energy = cell_row(row, t->room, lowest, width, SHAPES, 0);
    else if (w->epsilon > 0.0)
        *energy = cell_row(row, t->room, lowest, width, 1, 1);
    else if (w->power == 1)
        *energy = cell_row(row, t->room, lowest, width, 1, 0);
    else
        *energy = cell_row(row, t->room, lowest, width, 2, 0);
    for (ptrdiff_t k = 0; k < row->cells; k++)
        low = lowest[k] < low ? lowest[k] : low;
    *least = low;
}

static Factors3 factors_of(const HexWeights *w)
{
    const double one = 0.125 / w->cells, eps2 = w->epsilon * w->epsilon;
    return (Factors3){one * (1.0 - w->shape) / 3.0, one * w->shape, 0.5 * one * w->size, eps2,
                      eps2 > 0.0 ? 1.0 / eps2 : 0.0};
}

/* The cells between planes i and i + 1, if i is odd or even as the task says. */
static void cell_plane(const Task *t, const HexBlock *b, ptrdiff_t i)
{
    const HexMesh *mesh = t->mesh;
    const ptrdiff_t P = mesh->places, n3 = b->n[2], cells = n3 - 3, width = row_width(mesh);
    const int count = t->stiffness ? 1 : 3;
    int64_t *skip = (int64_t *)(t->room + (FORCES + 1) * width);
    CellRow row = {.skip = skip, .nodes = P, .cells = cells, .factors = factors_of(t->weights)};
    if ((i & 1) != t->odd || i < 1 || i > b->n[0] - 3)
        return;
    for (ptrdiff_t j = 1; j < b->n[1] - 2; j++) {
        const ptrdiff_t number = b->rows + (i - 1) * (b->n[1] - 3) + j - 1, at = place(b, i, j) + 1;
        const ptrdiff_t first = b->cells + ((i - 1) * (b->n[1] - 3) + j - 1) * cells;
        mesh->energies[4 * number] = 0.0, mesh->least[number] = INFINITY;
        if (!mesh->busy[number])
            continue;
        for (ptrdiff_t k = 0; k < cells; k++)
            skip[k] = mesh->skip[first + k];
        for (int d = 0; d < 3; d++)
            row.over[d] = mesh->inverse + d * mesh->cells + first;
        const ptrdiff_t to[4] = {at, at + n3, at + b->n[1] * n3, at + (b->n[1] + 1) * n3};
        for (int e = 0; e < 4; e++)
            row.at[e >> 1][e & 1] = mesh->x + to[e];
        one_row(t, &row, mesh->energies + 4 * number, mesh->least + number);
        for (int e = 0; e < 4; e++)
            for (int c = 0; c < count; c++) {
                const double *force = t->room + (2 * count * e + c) * width;
                scatter(force, force + count * width, mesh->g + c * P + to[e], cells);
            }
    }
}

/* ---- pairs of edges ---- */

/* log (l / target) of a row of edges to the place `next` on, and one over l². */
MESHONET_CLONES
static void length_row(const double *x, ptrdiff_t P, ptrdiff_t next, ptrdiff_t n, const float *restrict target,
                       double *restrict length, double *restrict over)
{
    const double *y = x + P, *z = y + P;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n; k++) {
        const double dx = x[k + next] - x[k], dy = y[k + next] - y[k], dz = z[k + next] - z[k];
        length[k] = 0.5 * logarithm(dx * dx + dy * dy + dz * dz + 1e-280, over + k) - (double)target[k];
    }
}

/* Edges from the places of plane i, also those one step beyond a side. */
static void length_plane(const Task *t, const HexBlock *b, ptrdiff_t i)
{
    const HexMesh *mesh = t->mesh;
    const ptrdiff_t P = mesh->places, next[3] = {b->n[1] * b->n[2], b->n[2], 1};
    double *spare = t->room + (FORCES + 1) * row_width(mesh);
    for (int d = 0; d < 3; d++)
        for (ptrdiff_t j = d != 1; j < b->n[1] - 1; j++) {
            const ptrdiff_t at = place(b, i, j) + (d != 2), edges = d * P + at;
            const int beyond = d == 0 ? i == 0 || i == b->n[0] - 2 : d == 1 && (j == 0 || j == b->n[1] - 2);
            if (i > b->n[0] - 2 || (d != 0 && i == 0))
                continue;
            length_row(mesh->x + at, P, next[d], b->n[2] - (d == 2 ? 1 : 2), mesh->target + edges,
                       mesh->lengths + edges, beyond ? spare : mesh->pulls + edges);
            if (d == 2)
                mesh->pulls[edges] = mesh->pulls[edges + b->n[2] - 2] = 0.0;
        }
}

/* The difference of two edges, 0 if one of them does not exist (NaN). */
MESHONET_INLINE double apart(double a, double b)
{
    const double difference = a - b;
    return difference == difference ? difference : 0.0;
}

/* Weights of the pairs of a row of edges with their neighbours along xi, eta and zeta, and the parts of their energies
   that this row adds. */
typedef struct {
    double by[3], before[3], after[3];
} Pairs;

/* Multiply `pull` of a row of n edges by the derivatives by log l; return the sum of their energies. */
MESHONET_CLONES
static double pull_row(const double *l, const ptrdiff_t *next, const Pairs *p, const double *restrict part, ptrdiff_t n,
                       double *restrict pull)
{
    const double *west = l - next[0], *east = l + next[0], *south = l - next[1], *north = l + next[1];
    double energy = 0.0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n; k++) {
        const double b1 = part[k] * p->by[0], b2 = part[k] * p->by[1], b3 = p->by[2];
        const double w = apart(l[k], west[k]), e = apart(l[k], east[k]), s = apart(l[k], south[k]);
        const double h = apart(l[k], north[k]), d = apart(l[k], l[k - 1]), u = apart(l[k], l[k + 1]);
        energy += b1 * (p->before[0] * w * w + p->after[0] * e * e) + b2 * (p->before[1] * s * s + p->after[1] * h * h) +
                  b3 * u * u;
        pull[k] *= 2.0 * (b1 * (w + e) + b2 * (s + h) + b3 * (d + u));
    }
    const double first = apart(l[0], l[-1]), last = apart(l[n - 1], l[n]);
    return energy + 0.5 * p->by[2] * (first * first - last * last);
}

/* Half for lines along a side of a block. */
MESHONET_INLINE double part_of(ptrdiff_t at, ptrdiff_t n)
{
    return at == 1 || at == n - 2 ? 0.5 : 1.0;
}

static double pair_weight(const HexWeights *w)
{
    return w->smoothness / cbrt(w->cells);
}

static void pull_plane(const Task *t, const HexBlock *b, ptrdiff_t i)
{
    const HexMesh *mesh = t->mesh;
    const ptrdiff_t n3 = b->n[2], next[2] = {b->n[1] * n3, n3};
    const double weight = pair_weight(t->weights);
    double *part = t->room;
    for (int d = 0; d < 3; d++) {
        for (ptrdiff_t k = 0; k < n3; k++)
            part[k] = d < 2 ? part_of(k + 1, n3) : 1.0;
        for (ptrdiff_t j = 1; j < b->n[1] - 1 - (d == 1) && i > 0 && i < b->n[0] - 1 - (d == 0); j++) {
            const ptrdiff_t at = d * mesh->places + place(b, i, j) + 1, place_of[2] = {i, j};
            const double on_i = d == 0 ? 1.0 : part_of(i, b->n[0]), on_j = d == 1 ? 1.0 : part_of(j, b->n[1]);
            Pairs pairs = {.by = {d == 1 ? 1.0 : on_j, d == 0 ? 1.0 : on_i, d == 0 ? on_j : d == 1 ? on_i : on_i * on_j}};
            for (int e = 0; e < 3; e++)
                pairs.by[e] *= weight;
            for (int e = 0; e < 2; e++) {
                pairs.before[e] = e == d && place_of[e] == 1 ? 0.5 : 0.0;
                pairs.after[e] = e == d && place_of[e] == b->n[e] - 3 ? 0.5 : 1.0;
            }
            const ptrdiff_t row = b->rows + (i - 1) * (b->n[1] - 2) + j - 1;
            mesh->energies[4 * row + 1 + d] =
                pull_row(mesh->lengths + at, next, &pairs, part, n3 - 2 - (d == 2), mesh->pulls + at);
        }
    }
}

/* Add the forces of edges, their pull over l² times the edge, to the nodes of a row. */
MESHONET_CLONES
static void gather_row(const double *x, const double *pulls, ptrdiff_t P, const ptrdiff_t *next, ptrdiff_t n,
                       double *restrict g)
{
    const double *y = x + P, *z = y + P;
    double *restrict gy = g + P, *restrict gz = gy + P;
    for (int d = 0; d < 3; d++) {
        const ptrdiff_t s = next[d];
        const double *p = pulls + d * P;
        MESHONET_INDEPENDENT
        for (ptrdiff_t k = 0; k < n; k++) {
            const double a = p[k - s], b = p[k];
            g[k] += a * (x[k] - x[k - s]) - b * (x[k + s] - x[k]);
            gy[k] += a * (y[k] - y[k - s]) - b * (y[k + s] - y[k]);
            gz[k] += a * (z[k] - z[k - s]) - b * (z[k + s] - z[k]);
        }
    }
}

static void gather_plane(const Task *t, const HexBlock *b, ptrdiff_t i)
{
    const ptrdiff_t P = t->mesh->places, next[3] = {b->n[1] * b->n[2], b->n[2], 1};
    for (ptrdiff_t j = 1; j < b->n[1] - 1 && i > 0 && i < b->n[0] - 1; j++) {
        const ptrdiff_t at = place(b, i, j) + 1;
        gather_row(t->mesh->x + at, t->mesh->pulls + at, P, next, b->n[2] - 2, t->mesh->g + at);
    }
}

/* Add the stiffness of pairs of edges, about six for each inner edge, at both of its ends. */
static void stiff_plane(const Task *t, const HexBlock *b, ptrdiff_t i)
{
    const ptrdiff_t P = t->mesh->places, next[3] = {b->n[1] * b->n[2], b->n[2], 1};
    const double by = 4.0 * pair_weight(t->weights);
    for (ptrdiff_t j = 1; j < b->n[1] - 1 && i > 0 && i < b->n[0] - 1; j++)
        for (ptrdiff_t k = 1; k < b->n[2] - 1; k++) {
            const ptrdiff_t at = place(b, i, j) + k;
            const double part[3] = {part_of(i, b->n[0]), part_of(j, b->n[1]), part_of(k, b->n[2])};
            for (int d = 0; d < 3; d++) {
                const double *over = t->mesh->pulls + d * P + at, on = part[(d + 1) % 3] * part[(d + 2) % 3];
                const float *target = t->mesh->target + d * P + at;
                t->mesh->g[at] += on * by * ((target[0] == target[0] ? over[0] : 0.0) +
                                             (target[-next[d]] == target[-next[d]] ? over[-next[d]] : 0.0));
            }
        }
}

/* ---- all of it ---- */

static void corners(Task *t, Member member)
{
    on_planes(t, fetch_plane, member);
    for (t->odd = 0; t->odd < 2; t->odd++)
        on_planes(t, cell_plane, member);
}

void hex_energy(const HexMesh *mesh, const HexWeights *weights, const double *x, double *room, Member member)
{
    Task t = {mesh, weights, x, room, 0, 0};
    corners(&t, member);
    if (weights->smoothness > 0.0) {
        on_planes(&t, length_plane, member);
        on_planes(&t, pull_plane, member);
        on_planes(&t, gather_plane, member);
    }
}

void hex_stiffness(const HexMesh *mesh, const HexWeights *weights, const double *x, int pairs, double *room,
                   Member member)
{
    Task t = {mesh, weights, x, room, 1, 0};
    corners(&t, member);
    if (pairs && weights->smoothness > 0.0) {
        on_planes(&t, length_plane, member);
        on_planes(&t, stiff_plane, member);
    }
}

double hex_sum(const HexMesh *mesh, const HexWeights *weights, double *smallest)
{
    double energy = 0.0, low = INFINITY;
    for (ptrdiff_t b = 0; b < mesh->blocks; b++) {
        const HexBlock *block = mesh->block + b;
        const ptrdiff_t rows = (block->n[0] - 2) * (block->n[1] - 2);
        for (ptrdiff_t row = block->rows; row < block->rows + rows; row++) {
            const double *part = mesh->energies + 4 * row;
            energy += part[0] + (weights->smoothness > 0.0 ? part[1] + part[2] + part[3] : 0.0);
            low = mesh->least[row] < low ? mesh->least[row] : low;
        }
    }
    *smallest = low;
    return (weights->epsilon > 0.0 || low > 0.0) && isfinite(energy) ? energy : INFINITY;
}
