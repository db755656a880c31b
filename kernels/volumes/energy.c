/* The functional of variational grids in space, with u, v, w edges over the mean length of their direction:

       E = mean over the corners of cells of (1-w) S / (3 χ) + w (|u|² |v|² |w|² / χ²)^p          (corner3.h)
         + β Σ over the three families of edges of the mean of the squares of (n_e - 1) Δ_e log l, e all three directions.

   By rows of cells; a row's forces go to four rows of nodes. A plane of nodes gets those of the cells before it first
   and then, as one sum, those of the cells behind: whoever computes them. */
#include "energy.h"
#include "cell_row.h"
#include "energy/corner.h"
#include "team.h"
#include <string.h>

enum { FORCES = 24, KEPT = 6 }; /* rows of forces; planes of nodes that each member keeps */

typedef struct {
    const Functional3 *f;
    const double *x;
    double *g, *room;
    double *energies, *least; /* a row of cells, or of edges, each */
    double *lengths, *pulls;  /* three families of edges: (3, n1, n2, n3) */
    int stiffness;
} Task;

static ptrdiff_t row_width(const Functional3 *f)
{
    return (f->n3 + 7) / 8 * 8;
}

static size_t member_room(const Functional3 *f)
{
    return (size_t)((FORCES + 1) * row_width(f) + KEPT * f->n2 * f->n3);
}

size_t volume_energy_room(const Functional3 *f)
{
    const size_t nodes = (size_t)(f->n1 * f->n2 * f->n3), rows = (size_t)(f->n1 * f->n2);
    return 6 * nodes + 5 * rows + (size_t)f->threads * member_room(f);
}

/* Add forces on the nodes at both ends of cells along zeta to a row of nodes. */
MESHONET_INLINE void scatter(const double *restrict low, const double *restrict high, double *restrict g, ptrdiff_t cells)
{
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 1; k < cells; k++)
        g[k] += low[k] + high[k - 1];
}

MESHONET_CLONES
static void one_row(const Task *t, const CellRow3 *row, double *room, double *energy, double *least)
{
    const Functional3 *f = t->f;
    const ptrdiff_t width = row_width(f);
    double low = INFINITY, *lowest = room + FORCES * width;
    if (t->stiffness) {
        if (f->power == SHAPES)
            stiffness_row3(row, room, width, SHAPES, 0);
        else if (f->epsilon > 0.0)
            stiffness_row3(row, room, width, 1, 1);
        else if (f->power == 1)
            stiffness_row3(row, room, width, 1, 0);
        else
            stiffness_row3(row, room, width, 2, 0);
        return;
    }
    if (f->power == SHAPES)
        *energy = cell_row3(row, room, lowest, width, SHAPES, 0);
    else if (f->epsilon > 0.0)
        *energy = cell_row3(row, room, lowest, width, 1, 1);
    else if (f->power == 1)
        *energy = cell_row3(row, room, lowest, width, 1, 0);
    else
        *energy = cell_row3(row, room, lowest, width, 2, 0);
    for (ptrdiff_t k = 0; k < row->cells; k++)
        low = lowest[k] < low ? lowest[k] : low;
    *least = low;
}

/* Forces of the cells between planes i and i + 1 of nodes: `ahead` on the first, `behind` on the second, of which
   coordinates lie `apart`. */
MESHONET_CLONES
static void cell_plane(const Task *t, ptrdiff_t i, double *ahead, double *behind, ptrdiff_t apart, double *room)
{
    const Functional3 *f = t->f;
    const ptrdiff_t n2 = f->n2, n3 = f->n3, nodes = f->n1 * n2 * n3, width = row_width(f);
    const double one = 1.0 / (8.0 * (double)(f->n1 - 1) * (double)(n2 - 1) * (double)(n3 - 1));
    const double eps2 = f->epsilon * f->epsilon;
    const int count = t->stiffness ? 1 : 3;
    CellRow3 row = {.nodes = nodes, .cells = n3 - 1, .over = {f->over[0], f->over[1], f->over[2]}};
    row.factors = (Factors3){one * (1.0 - f->shape) / 3.0, one * f->shape, eps2, eps2 > 0.0 ? 1.0 / eps2 : 0.0};
    for (int c = 0; c < count; c++) {
        memset(ahead + c * n2 * n3, 0, (size_t)(n2 * n3) * sizeof *ahead);
        memset(behind + c * apart, 0, (size_t)(n2 * n3) * sizeof *behind);
    }
    for (ptrdiff_t j = 0; j < n2 - 1; j++) {
        const double *at = t->x + (i * n2 + j) * n3;
        row.at[0][0] = at, row.at[0][1] = at + n3, row.at[1][0] = at + n2 * n3, row.at[1][1] = row.at[1][0] + n3;
        one_row(t, &row, room, t->energies + i * n2 + j, t->least + i * n2 + j);
        for (int c = 0; c < count; c++)
            for (int dj = 0; dj < 2; dj++) {
                const double *force = room + (2 * count * dj + c) * width;
                const ptrdiff_t to = (j + dj) * n3, next = count * width, far = 4 * count * width;
                scatter(force, force + next, ahead + c * n2 * n3 + to, n3 - 1);
                scatter(force + far, force + far + next, behind + c * apart + to, n3 - 1);
            }
    }
}

MESHONET_CLONES
static void add_plane(double *restrict to, const double *restrict from, ptrdiff_t n)
{
    for (ptrdiff_t k = 0; k < n; k++)
        to[k] += from[k];
}

/* The cells of a member's planes; `room` keeps what those put on the first plane of nodes, which the member before
   has a part in. */
static void corner_terms(const Task *t, Member member, double *room)
{
    const Functional3 *f = t->f;
    const ptrdiff_t face = f->n2 * f->n3, nodes = f->n1 * face;
    double *first_part = room + (FORCES + 1) * row_width(f), *ahead = first_part + 3 * face;
    ptrdiff_t first, last;
    team_share(f->n1 - 1, member, &first, &last);
    for (ptrdiff_t i = first; i < last; i++) {
        cell_plane(t, i, i == first ? first_part : ahead, t->g + (i + 1) * face, nodes, room);
        for (ptrdiff_t c = 0; c < (t->stiffness ? 1 : 3) && i > first; c++)
            add_plane(t->g + c * nodes + i * face, ahead + c * face, face);
    }
    team_wait(member);
    for (ptrdiff_t c = 0; c < (t->stiffness ? 1 : 3) && first > 0 && last > first; c++)
        add_plane(t->g + c * nodes + first * face, first_part + c * face, face);
}

/* log l of the edges that begin at a row of nodes, to the node `next` doubles on. */
MESHONET_CLONES
static void length_row(const double *x, ptrdiff_t nodes, ptrdiff_t next, ptrdiff_t n, double *restrict length)
{
    const double *y = x + nodes, *z = y + nodes;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n; k++) {
        const double dx = x[k + next] - x[k], dy = y[k + next] - y[k], dz = z[k + next] - z[k];
        double inverse;
        length[k] = 0.5 * logarithm(dx * dx + dy * dy + dz * dz, &inverse);
    }
}

/* Derivative of the edge length term by log l for a row of n edges, neighbours at `before` and `behind` (or the row
   itself at the rim), and the sum of the term. */
MESHONET_CLONES
static double pull_row(const double *l, const double *const *beside, const double *by, ptrdiff_t n, double *restrict pull)
{
    const double *restrict west = beside[0], *restrict east = beside[1], *south = beside[2], *north = beside[3];
    const double b1 = by[0], b2 = by[1], b3 = by[2];
    double sum = 0.0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n; k++) {
        const double e = l[k] - east[k], d = l[k] - north[k];
        sum += b1 * e * e + b2 * d * d;
        pull[k] = 2.0 * (b1 * ((l[k] - west[k]) + e) + b2 * ((l[k] - south[k]) + d));
    }
    for (ptrdiff_t k = 0; k < n - 1; k++) {
        const double d = l[k + 1] - l[k];
        sum += b3 * d * d;
    }
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 1; k < n - 1; k++)
        pull[k] += 2.0 * b3 * (2.0 * l[k] - l[k - 1] - l[k + 1]);
    if (n > 1) {
        pull[0] -= 2.0 * b3 * (l[1] - l[0]);
        pull[n - 1] += 2.0 * b3 * (l[n - 1] - l[n - 2]);
    }
    return sum;
}

/* The pulls of one family of edges, those along direction d, of planes first to last of nodes. */
static void pull_planes(const Task *t, int d, ptrdiff_t first, ptrdiff_t last)
{
    const Functional3 *f = t->f;
    const ptrdiff_t n[3] = {f->n1, f->n2, f->n3}, face = f->n2 * f->n3, nodes = f->n1 * face;
    const ptrdiff_t m1 = n[0] - (d == 0), m2 = n[1] - (d == 1), m3 = n[2] - (d == 2);
    const double weight = f->smoothness / ((double)m1 * (double)m2 * (double)m3);
    double by[3];
    for (int e = 0; e < 3; e++)
        by[e] = weight * (double)(n[e] - 1) * (double)(n[e] - 1);
    for (ptrdiff_t i = first; i < last && i < m1; i++)
        for (ptrdiff_t j = 0; j < m2; j++) {
            const double *l = t->lengths + d * nodes + i * face + j * f->n3;
            const double *beside[4] = {i > 0 ? l - face : l, i < m1 - 1 ? l + face : l, j > 0 ? l - f->n3 : l,
                                       j < m2 - 1 ? l + f->n3 : l};
            t->energies[(d + 1) * f->n1 * f->n2 + i * f->n2 + j] =
                pull_row(l, beside, by, m3, t->pulls + d * nodes + i * face + j * f->n3);
        }
}

/* Edges pull at the inner nodes of a row, by their pull over l² times the edge. */
MESHONET_CLONES
static void gather_row(const double *x, const double *pulls, ptrdiff_t nodes, const ptrdiff_t *next, ptrdiff_t n,
                       double *restrict g)
{
    const double *y = x + nodes, *z = y + nodes;
    double *restrict gy = g + nodes, *restrict gz = gy + nodes;
    for (int d = 0; d < 3; d++) {
        const ptrdiff_t s = next[d];
        const double *p = pulls + d * nodes;
        MESHONET_INDEPENDENT
        for (ptrdiff_t k = 1; k < n - 1; k++) {
            const double ax = x[k] - x[k - s], ay = y[k] - y[k - s], az = z[k] - z[k - s];
            const double bx = x[k + s] - x[k], by = y[k + s] - y[k], bz = z[k + s] - z[k];
            const double aa = ax * ax + ay * ay + az * az, bb = bx * bx + by * by + bz * bz, both = 1.0 / (aa * bb);
            const double a = p[k - s] * bb * both, b = p[k] * aa * both;
            g[k] += a * ax - b * bx, gy[k] += a * ay - b * by, gz[k] += a * az - b * bz;
        }
    }
}

static void length_terms(const Task *t, Member member)
{
    const Functional3 *f = t->f;
    const ptrdiff_t face = f->n2 * f->n3, nodes = f->n1 * face, next[3] = {face, f->n3, 1};
    ptrdiff_t first, last;
    team_share(f->n1, member, &first, &last);
    for (ptrdiff_t i = first; i < last; i++)
        for (ptrdiff_t j = 0; j < f->n2; j++) {
            const ptrdiff_t at = i * face + j * f->n3;
            if (i < f->n1 - 1)
                length_row(t->x + at, nodes, face, f->n3, t->lengths + at);
            if (j < f->n2 - 1)
                length_row(t->x + at, nodes, f->n3, f->n3, t->lengths + nodes + at);
            length_row(t->x + at, nodes, 1, f->n3 - 1, t->lengths + 2 * nodes + at);
        }
    team_wait(member);
    for (int d = 0; d < 3; d++)
        pull_planes(t, d, first, last);
    team_wait(member);
    for (ptrdiff_t i = first > 1 ? first : 1; i < last && i < f->n1 - 1; i++)
        for (ptrdiff_t j = 1; j < f->n2 - 1; j++)
            gather_row(t->x + i * face + j * f->n3, t->pulls + i * face + j * f->n3, nodes, next, f->n3,
                       t->g + i * face + j * f->n3);
}

static void share(void *data, Member member)
{
    const Task *t = data;
    const size_t nodes = (size_t)(t->f->n1 * t->f->n2 * t->f->n3), rows = (size_t)(t->f->n1 * t->f->n2);
    corner_terms(t, member, t->room + 6 * nodes + 5 * rows + (size_t)member.rank * member_room(t->f));
    if (!t->stiffness && t->f->smoothness > 0.0) {
        team_wait(member);
        length_terms(t, member);
    }
}

static Task task_of(const Functional3 *f, const double *x, double *g, double *room)
{
    const size_t nodes = (size_t)(f->n1 * f->n2 * f->n3);
    return (Task){.f = f, .x = x, .g = g, .room = room, .lengths = room, .pulls = room + 3 * nodes,
                  .energies = room + 6 * nodes, .least = room + 6 * nodes + 4 * (size_t)(f->n1 * f->n2)};
}

double volume_energy(const Functional3 *f, const double *x, double *g, double *smallest, double *room)
{
    Task t = task_of(f, x, g, room);
    const ptrdiff_t rows = f->n1 * f->n2;
    double energy = 0.0, low = INFINITY;
    memset(t.energies, 0, 4 * (size_t)rows * sizeof *t.energies);
    team_run(f->threads, share, &t);
    for (ptrdiff_t r = 0; r < 4 * rows; r++)
        energy += t.energies[r];
    for (ptrdiff_t i = 0; i < f->n1 - 1; i++)
        for (ptrdiff_t j = 0; j < f->n2 - 1; j++)
            low = t.least[i * f->n2 + j] < low ? t.least[i * f->n2 + j] : low;
    *smallest = low;
    return (f->epsilon > 0.0 || low > 0.0) && isfinite(energy) ? energy : INFINITY;
}

void volume_stiffness(const Functional3 *f, const double *x, double *h, double *room)
{
    Task t = task_of(f, x, h, room);
    t.stiffness = 1;
    team_run(f->threads, share, &t);
}

typedef struct {
    const Functional3 *f;
    const double *x;
    double *least;
} Jacobians;

MESHONET_CLONES
static void jacobian_row(const double *at, ptrdiff_t nodes, ptrdiff_t face, ptrdiff_t n3, double scale,
                         double *restrict least)
{
    for (ptrdiff_t k = 0; k < n3 - 1; k++)
        least[k] = INFINITY;
    for (int di = 0; di < 2; di++)
        for (int dj = 0; dj < 2; dj++)
            for (int dk = 0; dk < 2; dk++) {
                const double *u = at + dj * n3 + dk, *v = at + di * face + dk, *w = at + di * face + dj * n3;
                MESHONET_INDEPENDENT
                for (ptrdiff_t k = 0; k < n3 - 1; k++) {
                    const Vector normal = cross(edge3(u + k, u + k + face, nodes, scale),
                                                  edge3(v + k, v + k + n3, nodes, 1.0));
                    const double jacobian = dot(normal, edge3(w + k, w + k + 1, nodes, 1.0));
                    least[k] = lower(least[k], jacobian);
                }
            }
}

static void jacobian_share(void *data, Member member)
{
    const Jacobians *t = data;
    const Functional3 *f = t->f;
    const ptrdiff_t face = f->n2 * f->n3, nodes = f->n1 * face;
    const double scale = f->over[0] * f->over[1] * f->over[2];
    ptrdiff_t first, last;
    team_share(f->n1 - 1, member, &first, &last);
    for (ptrdiff_t i = first; i < last; i++)
        for (ptrdiff_t j = 0; j < f->n2 - 1; j++)
            jacobian_row(t->x + i * face + j * f->n3, nodes, face, f->n3, scale,
                         t->least + (i * (f->n2 - 1) + j) * (f->n3 - 1));
}

void volume_jacobians(const Functional3 *f, const double *x, double *least)
{
    Jacobians t = {f, x, least};
    team_run(f->threads, jacobian_share, &t);
}
