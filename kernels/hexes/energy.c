/* The functional of include/corner3.h over hexahedra that share nodes:

       E = mean over cells of mean over corners of a S / χ + b (g h q / χ²)^p [+ t (χ + 1/χ) / 2]
         + β N^(2/3) / N sum over pairs of edges of w (Δ log (l / target))²

   Edges of a corner are parts of the lengths that its cell should have, so that layers keep theirs. N is the number
   of cells. Pairs are edges that face each other across a face of a cell, w half of the cells at that face, and edges
   that follow each other through a face between two cells, a fourth for each face that they bound. That is the mean
   square of the gradient of log l, across interfaces as inside of blocks. The term in brackets is for folded meshes:
   with χ > J cells would gain by shrinking to points.

   Blocks are worked on in bricks, small enough for their nodes and forces to stay in cache, whole rows of cells at a
   time. A brick adds up the forces of its own cells, and of its own edges, for which it looks one edge across its sides;
   what bricks share is added by whoever wants it, in the order of bricks.

   Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, ACM Trans. Graph. 40 (2021) 154 (unfolding with volumes). */
#include "energy.h"
#include "cells.h"
#include "energy/corner.h"
#include <string.h>

#define ROW (BRICK_K + 3)
#define LATTICE ((BRICK_I + 3) * (BRICK_J + 3) * ROW)

/* A brick with its nodes at hand: x[c] and force[c] have rows of count[2] + 3. */
typedef struct {
    const Brick *brick;
    const int32_t *node;
    ptrdiff_t plane, row; /* steps along xi and eta in the lattice with nodes beyond */
    double *x[3], *force[3];
    double *length, *pull, *alive, *over; /* of edges of one direction */
} Local;

size_t brick_room(void)
{
    return 10 * LATTICE;
}

static Local at_hand(const HexMesh *mesh, ptrdiff_t number, const double *x, double *room)
{
    Local l = {.brick = mesh->brick + number};
    const int64_t *count = l.brick->count;
    l.node = mesh->node + l.brick->nodes;
    l.row = count[2] + 3, l.plane = l.row * (count[1] + 3);
    const ptrdiff_t all = l.plane * (count[0] + 3);
    for (int c = 0; c < 3; c++)
        l.x[c] = room + c * LATTICE, l.force[c] = room + (3 + c) * LATTICE;
    l.length = room + 6 * LATTICE, l.pull = room + 7 * LATTICE;
    l.alive = room + 8 * LATTICE, l.over = room + 9 * LATTICE;
    for (ptrdiff_t k = 0; k < all; k++) {
        const ptrdiff_t n = 3 * (ptrdiff_t)(l.node[k] < 0 ? 0 : l.node[k]);
        l.x[0][k] = x[n], l.x[1][k] = x[n + 1], l.x[2][k] = x[n + 2];
    }
    for (int c = 0; c < 3; c++)
        memset(l.force[c], 0, (size_t)all * sizeof(double));
    return l;
}

/* Bits of the corners of a row of cells that do not count: without three edges, or of cells of which no node moves.
   Returns how many cells there are of which all count, and in `none` those of which none does. */
static ptrdiff_t corners_left_out(const Local *l, const uint8_t *moves, ptrdiff_t first, uint8_t *skip, ptrdiff_t *none)
{
    ptrdiff_t whole = 0;
    *none = 0;
    for (ptrdiff_t k = 0; k < l->brick->count[2]; k++) {
        int32_t node[8];
        int moving = 0, out = 0;
        for (int c = 0; c < 8; c++) {
            node[c] = l->node[first + (c >> 2) * l->plane + (c >> 1 & 1) * l->row + (c & 1) + k];
            moving |= moves[node[c]];
        }
        for (int c = 0; c < 8; c++)
            if (node[c] == node[c ^ 1] || node[c] == node[c ^ 2] || node[c] == node[c ^ 4])
                out |= 1 << c;
        skip[k] = (uint8_t)(moving ? out : 255);
        whole += skip[k] == 0, *none += skip[k] == 255;
    }
    return whole;
}

/* Fill in where the row (i, j) of cells is; returns 0 where none of it counts. */
static int gather_row(const HexMesh *mesh, const Local *l, ptrdiff_t i, ptrdiff_t j, CellRow *r, uint8_t *skip)
{
    const int64_t *count = l->brick->count;
    const ptrdiff_t first = (i + 1) * l->plane + (j + 1) * l->row + 1, cells = count[0] * count[1] * count[2];
    for (int e = 0; e < 4; e++) {
        const ptrdiff_t at = first + (e >> 1) * l->plane + (e & 1) * l->row;
        r->x[e] = l->x[0] + at, r->y[e] = l->x[1] + at, r->z[e] = l->x[2] + at;
    }
    for (int c = 0; c < 3; c++)
        r->inverse[c] = mesh->inverse + l->brick->cells + c * cells + (i * count[1] + j) * count[2];
    r->skip = NULL;
    if (l->brick->ragged) {
        ptrdiff_t none;
        r->skip = corners_left_out(l, mesh->moves, first, skip, &none) == count[2] ? NULL : skip;
        return none < count[2];
    }
    return 1;
}

/* Terms of corners of a whole brick; their smallest Jacobian to `least`. */
MESHONET_CLONES
static double all_cells(const HexMesh *mesh, const Local *l, const Terms *t, double *least)
{
    const int64_t *count = l->brick->count;
    double energy = 0.0, low = INFINITY;
    CellRow r;
    uint8_t skip[BRICK_K];
    for (ptrdiff_t i = 0; i < count[0]; i++)
        for (ptrdiff_t j = 0; j < count[1]; j++) {
            if (!gather_row(mesh, l, i, j, &r, skip))
                continue;
            energy += cells_of_row(&r, count[2], t);
            for (ptrdiff_t k = 0; k < count[2]; k++)
                low = r.least[k] < low ? r.least[k] : low;
            const ptrdiff_t first = (i + 1) * l->plane + (j + 1) * l->row + 1;
            for (int c = 0; c < 8; c++) {
                const ptrdiff_t at = first + (c >> 2) * l->plane + (c >> 1 & 1) * l->row + (c & 1);
                double *restrict fx = l->force[0] + at, *restrict fy = l->force[1] + at, *restrict fz = l->force[2] + at;
                for (ptrdiff_t k = 0; k < count[2]; k++)
                    fx[k] += r.fx[c][k], fy[k] += r.fy[c][k], fz[k] += r.fz[c][k];
            }
        }
    *least = low;
    return energy;
}

/* Edges of one direction: those of a brick and one beyond either end, (many[0], many[1], many[2]) of them. Their
   numbers are those of the nodes that they begin at, in the lattice with nodes beyond. */
typedef struct {
    int along;
    ptrdiff_t many[3], start, step;
    double by;
} Edges;

static Edges edges_along(const Local *l, int along, double by)
{
    Edges e = {.along = along, .by = by};
    const ptrdiff_t steps[3] = {l->plane, l->row, 1};
    for (int c = 0; c < 3; c++) {
        e.many[c] = l->brick->count[c] + (c == along ? 2 : 1);
        e.start += c == along ? 0 : steps[c];
    }
    e.step = steps[along];
    return e;
}

/* Logarithms of lengths over targets, reciprocal squares of lengths; `alive` is 0 without a length or a node. */
MESHONET_CLONES
static void edge_lengths(const Local *l, const Edges *e, const float *restrict target)
{
    const double *restrict x = l->x[0], *restrict y = l->x[1], *restrict z = l->x[2];
    double *restrict length = l->length, *restrict over = l->over, *restrict alive = l->alive;
    const ptrdiff_t step = e->step, many = e->many[2];
    for (ptrdiff_t i = 0; i < e->many[0]; i++)
        for (ptrdiff_t j = 0; j < e->many[1]; j++, target += many) {
            const ptrdiff_t first = e->start + i * l->plane + j * l->row;
            const int32_t *restrict node = l->node + first;
            MESHONET_INDEPENDENT
            for (ptrdiff_t k = 0; k < many; k++) {
                const ptrdiff_t at = first + k;
                const double dx = x[at + step] - x[at], dy = y[at + step] - y[at], dz = z[at + step] - z[at];
                const int there = node[k] >= 0 && node[k + step] >= 0 && node[k] != node[k + step];
                const double square = dx * dx + dy * dy + dz * dz;
                length[at] = 0.5 * logarithm(square + 1e-280, over + at) - (double)target[k];
                alive[at] = there ? 1.0 : 0.0;
            }
        }
}

/* Pairs of edges `first` + k and `second` + k, of `weight` times `by_row` each; returns the sum of their energies. */
MESHONET_INLINE double pairs_of_rows(const Local *l, ptrdiff_t first, ptrdiff_t second, ptrdiff_t count, double weight,
                                     const double *restrict by_row)
{
    const double *restrict one = l->length + first, *restrict two = l->length + second;
    const double *restrict here = l->alive + first, *restrict there = l->alive + second;
    double *restrict pull = l->pull + first, *restrict other = l->pull + second, energy = 0.0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < count; k++) {
        const double difference = one[k] - two[k], force = weight * by_row[k] * here[k] * there[k] * difference;
        energy += force * difference;
        pull[k] += 2.0 * force;
        other[k] -= 2.0 * force;
    }
    return energy;
}

/* The same within a row: edges k and k + 1. */
MESHONET_INLINE double pairs_in_row(const Local *l, ptrdiff_t first, ptrdiff_t count, double weight)
{
    const double *restrict length = l->length + first, *restrict alive = l->alive + first;
    double *restrict pull = l->pull + first, energy = 0.0, force[ROW];
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < count; k++) {
        const double difference = length[k] - length[k + 1];
        force[k] = weight * alive[k] * alive[k + 1] * difference;
        energy += force[k] * difference;
    }
    for (ptrdiff_t k = 0; k < count; k++)
        pull[k] += 2.0 * force[k];
    for (ptrdiff_t k = 0; k < count; k++)
        pull[k + 1] -= 2.0 * force[k];
    return energy;
}

/* Half for lines along a side of the brick: another one, or nobody, has the rest. */
MESHONET_INLINE double part(ptrdiff_t k, ptrdiff_t many)
{
    return k == 0 || k == many - 1 ? 0.5 : 1.0;
}

/* Pairs along zeta in the row (i, j). Beyond either end, half of the energy is the neighbour's. */
MESHONET_INLINE double pairs_along_zeta(const Local *l, const Edges *e, ptrdiff_t i, ptrdiff_t j)
{
    const ptrdiff_t first = e->start + i * l->plane + j * l->row, count = e->many[2] - 1;
    const double on_i = part(i, e->many[0]), on_j = part(j, e->many[1]);
    if (e->along != 2)
        return pairs_in_row(l, first, count, e->by * (e->along == 0 ? on_j : on_i));
    const double weight = e->by * on_i * on_j;
    double energy = pairs_in_row(l, first, count, weight);
    for (int end = 0; end < 2; end++) {
        const ptrdiff_t k = first + (end ? count - 1 : 0);
        const double difference = l->length[k] - l->length[k + 1];
        energy -= 0.5 * weight * l->alive[k] * l->alive[k + 1] * difference * difference;
    }
    return energy;
}

/* Pairs from the row (i, j) to the next along xi or eta; `which` is that direction. */
MESHONET_INLINE double pairs_across(const Local *l, const Edges *e, ptrdiff_t i, ptrdiff_t j, int which,
                                    const double *whole, const double *ends)
{
    const ptrdiff_t at = which == 0 ? i : j;
    if (at + 1 >= e->many[which])
        return 0.0;
    const ptrdiff_t first = e->start + i * l->plane + j * l->row;
    const ptrdiff_t second = first + (which == 0 ? l->plane : l->row);
    const double on_other = which == 0 ? part(j, e->many[1]) : part(i, e->many[0]);
    if (e->along == which) { /* one after the other */
        const int beyond = at == 0 || at + 2 == e->many[which];
        return (beyond ? 0.5 : 1.0) * pairs_of_rows(l, first, second, e->many[2], e->by * on_other, ends);
    }
    if (e->along == 2)
        return pairs_of_rows(l, first + 1, second + 1, e->many[2] - 2, e->by * on_other, whole);
    return pairs_of_rows(l, first, second, e->many[2], e->by, ends);
}

/* All pairs of edges along one direction. */
MESHONET_CLONES
static double all_pairs(const Local *l, const Edges *e)
{
    double whole[ROW], ends[ROW], energy = 0.0;
    for (ptrdiff_t k = 0; k < ROW; k++)
        whole[k] = 1.0, ends[k] = part(k, e->many[2]);
    for (ptrdiff_t i = 0; i < e->many[0]; i++)
        for (ptrdiff_t j = 0; j < e->many[1]; j++)
            memset(l->pull + e->start + i * l->plane + j * l->row, 0, (size_t)e->many[2] * sizeof(double));
    for (ptrdiff_t i = 0; i < e->many[0]; i++)
        for (ptrdiff_t j = 0; j < e->many[1]; j++) {
            const int beyond_i = e->along == 0 && (i == 0 || i + 1 == e->many[0]);
            const int beyond_j = e->along == 1 && (j == 0 || j + 1 == e->many[1]);
            if (!beyond_i && !beyond_j)
                energy += pairs_along_zeta(l, e, i, j);
            if (!beyond_j)
                energy += pairs_across(l, e, i, j, 0, whole, ends);
            if (!beyond_i)
                energy += pairs_across(l, e, i, j, 1, whole, ends);
        }
    return energy;
}

/* Forces of the brick's own edges on the nodes at their ends. */
MESHONET_CLONES
static void add_pulls(const Local *l, const Edges *e)
{
    const int along = e->along;
    const ptrdiff_t from = along == 2, count = e->many[2] - (along == 2 ? 2 : 0), step = e->step;
    for (ptrdiff_t i = along == 0; i < e->many[0] - (along == 0); i++)
        for (ptrdiff_t j = along == 1; j < e->many[1] - (along == 1); j++) {
            const ptrdiff_t at = e->start + i * l->plane + j * l->row + from;
            const double *restrict pull = l->pull + at, *restrict over = l->over + at;
            for (int c = 0; c < 3; c++) {
                const double *restrict x = l->x[c] + at;
                double *restrict force = l->force[c] + at, pulled[ROW];
                for (ptrdiff_t k = 0; k < count; k++)
                    pulled[k] = pull[k] * over[k] * (x[k + step] - x[k]);
                for (ptrdiff_t k = 0; k < count; k++)
                    force[k] -= pulled[k];
                for (ptrdiff_t k = 0; k < count; k++)
                    force[k + step] += pulled[k];
            }
        }
}

static void hand_over(const HexMesh *mesh, const Local *l)
{
    const int64_t *count = l->brick->count;
    double *to = mesh->force + l->brick->forces;
    for (ptrdiff_t i = 0; i <= count[0]; i++)
        for (ptrdiff_t j = 0; j <= count[1]; j++) {
            const ptrdiff_t at = (i + 1) * l->plane + (j + 1) * l->row + 1;
            for (ptrdiff_t k = 0; k <= count[2]; k++, to += 3)
                to[0] = l->force[0][at + k], to[1] = l->force[1][at + k], to[2] = l->force[2][at + k];
        }
}

static double pair_weight(const HexWeights *weights)
{
    return weights->smoothness / cbrt(weights->cells);
}

static Terms terms_of(const HexWeights *w)
{
    const double place = 0.125 / w->cells, eps2 = w->epsilon * w->epsilon;
    return (Terms){{place * (1.0 - w->shape) / 3.0, place * w->shape, eps2, eps2 > 0.0 ? 1.0 / eps2 : 0.0},
                   0.5 * place * w->size, eps2 > 0.0 ? 1 : 2, eps2 > 0.0};
}

void brick_energy(const HexMesh *mesh, ptrdiff_t number, const HexWeights *weights, const double *x, double *room)
{
    const Local l = at_hand(mesh, number, x, room);
    const Terms terms = terms_of(weights);
    double energy = all_cells(mesh, &l, &terms, mesh->least + number);
    mesh->energy[number] = INFINITY;
    if (!terms.regular && !(mesh->least[number] > 0.0))
        return;
    const float *target = mesh->target + l.brick->targets;
    for (int along = 0; along < 3 && weights->smoothness > 0.0; along++) {
        const Edges e = edges_along(&l, along, pair_weight(weights));
        edge_lengths(&l, &e, target);
        energy += all_pairs(&l, &e);
        add_pulls(&l, &e);
        target += e.many[0] * e.many[1] * e.many[2];
    }
    hand_over(mesh, &l);
    mesh->energy[number] = energy;
}

/* What pairs of edges add: about the six that there are of an inner edge, at both of its ends. */
static void add_pair_stiffness(const Local *l, const Edges *e)
{
    const int along = e->along;
    const ptrdiff_t from = along == 2, count = e->many[2] - (along == 2 ? 2 : 0);
    for (ptrdiff_t i = along == 0; i < e->many[0] - (along == 0); i++)
        for (ptrdiff_t j = along == 1; j < e->many[1] - (along == 1); j++)
            for (ptrdiff_t k = from; k < from + count; k++) {
                const ptrdiff_t at = e->start + i * l->plane + j * l->row + k;
                const double on = (along == 0 ? 1.0 : part(i, e->many[0])) * (along == 1 ? 1.0 : part(j, e->many[1])) *
                                  (along == 2 ? 1.0 : part(k, e->many[2]));
                const double stiff = on * 4.0 * e->by * l->alive[at] * l->over[at];
                l->force[0][at] += stiff, l->force[0][at + e->step] += stiff;
            }
}

void brick_stiffness(const HexMesh *mesh, ptrdiff_t number, const HexWeights *weights, const double *x, double *room)
{
    const Local l = at_hand(mesh, number, x, room);
    const Terms terms = terms_of(weights);
    const int64_t *count = l.brick->count;
    CellRow r;
    uint8_t skip[BRICK_K];
    for (ptrdiff_t i = 0; i < count[0]; i++)
        for (ptrdiff_t j = 0; j < count[1]; j++) {
            if (!gather_row(mesh, &l, i, j, &r, skip))
                continue;
            stiffness_of_row(&r, count[2], &terms);
            for (int c = 0; c < 8; c++)
                for (ptrdiff_t k = 0; k < count[2]; k++)
                    l.force[0][(i + 1) * l.plane + (j + 1) * l.row + 1 + (c >> 2) * l.plane + (c >> 1 & 1) * l.row +
                               (c & 1) + k] += r.fx[c][k];
        }
    const float *target = mesh->target + l.brick->targets;
    for (int along = 0; along < 3 && weights->smoothness > 0.0; along++) {
        const Edges e = edges_along(&l, along, pair_weight(weights));
        edge_lengths(&l, &e, target);
        add_pair_stiffness(&l, &e);
        target += e.many[0] * e.many[1] * e.many[2];
    }
    hand_over(mesh, &l);
}
