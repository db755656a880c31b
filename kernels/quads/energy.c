/* The functional of energy/functional.h over quads that share nodes, without the places at the centres of cells:

       E = mean over cells of mean over corners of
               (1-w) (a g + h/a) / (2χ) + w (g h / χ²)²  [+ t (A/χ + χ/A) / 2]
         + N mean over pairs of edges of β (Δ log (l / target))², for consecutive ones + γ max(|Δ log| - limit, 0)²

   N is the number of cells. Pairs are opposite edges of a cell and consecutive ones along a grid line; with targets all
   of one length the last term is that over blocks. The term in brackets, A the area a cell has at first, is for folded
   meshes: with χ > J cells would gain by shrinking to points. There ε is a part of A. A batch of cells at a time: their forces are worked out
   in vectors, then added to the nodes one by one. */
#include "energy.h"
#include "topology.h"
#include "clones.h"
#include "energy/corner.h"
#include "sums.h"
#include <math.h>
#include <string.h>

#define BATCH 64

typedef struct {
    double x[4][BATCH], y[4][BATCH];                                   /* nodes; then the forces on them */
    double along[BATCH], across[BATCH], area[BATCH], least[BATCH];
} Cells;

/* The term in brackets of a corner, and its derivative by J; `size` is t times the weight of the place. */
MESHONET_INLINE double sized(double jacobian, double area, double size, double eps2, double *by_j)
{
    const double root = sqrt(jacobian * jacobian + eps2), chi = 0.5 * (jacobian + root);
    const double part = area / chi, inverse = 1.0 / area;
    *by_j = 0.5 * size * (inverse - part / chi) * 0.5 * (1.0 + jacobian / root);
    return 0.5 * size * (part + chi * inverse);
}

MESHONET_INLINE Corner one_corner(double ux, double uy, double vx, double vy, const Factors *f, double area, double size,
                                  int regular)
{
    Corner c = corner(ux, uy, vx, vy, f, regular);
    if (regular) {
        double by_j;
        c.energy += sized(c.jacobian, area, size, f->eps2, &by_j);
        c.du_x += by_j * vy, c.du_y -= by_j * vx, c.dv_x -= by_j * uy, c.dv_y += by_j * ux;
    }
    return c;
}

MESHONET_INLINE double cell_batch(Cells *b, ptrdiff_t count, double angle, double size, double eps2, int regular)
{
    double energy = 0.0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < count; k++) {
        const double south_x = b->x[1][k] - b->x[0][k], south_y = b->y[1][k] - b->y[0][k];
        const double north_x = b->x[2][k] - b->x[3][k], north_y = b->y[2][k] - b->y[3][k];
        const double west_x = b->x[3][k] - b->x[0][k], west_y = b->y[3][k] - b->y[0][k];
        const double east_x = b->x[2][k] - b->x[1][k], east_y = b->y[2][k] - b->y[1][k];
        const Factors f = {b->along[k], b->across[k], angle, eps2 * b->area[k] * b->area[k]};
        const Corner p = one_corner(south_x, south_y, west_x, west_y, &f, b->area[k], size, regular);
        const Corner q = one_corner(south_x, south_y, east_x, east_y, &f, b->area[k], size, regular);
        const Corner r = one_corner(north_x, north_y, east_x, east_y, &f, b->area[k], size, regular);
        const Corner s = one_corner(north_x, north_y, west_x, west_y, &f, b->area[k], size, regular);
        energy += (p.energy + q.energy) + (r.energy + s.energy);
        const double south = p.jacobian < q.jacobian ? p.jacobian : q.jacobian;
        const double north = r.jacobian < s.jacobian ? r.jacobian : s.jacobian;
        b->least[k] = (south < north ? south : north) / b->area[k];
        const double sx = p.du_x + q.du_x, sy = p.du_y + q.du_y, nx = r.du_x + s.du_x, ny = r.du_y + s.du_y;
        const double wx = p.dv_x + s.dv_x, wy = p.dv_y + s.dv_y, ex = q.dv_x + r.dv_x, ey = q.dv_y + r.dv_y;
        b->x[0][k] = -(sx + wx), b->y[0][k] = -(sy + wy);
        b->x[1][k] = sx - ex, b->y[1][k] = sy - ey;
        b->x[2][k] = nx + ex, b->y[2][k] = ny + ey;
        b->x[3][k] = wx - nx, b->y[3][k] = wy - ny;
    }
    return energy;
}

MESHONET_CLONES
static double all_cells(const QuadMesh *mesh, const double *restrict x, double *restrict g, double *smallest)
{
    const double one = 0.25 / (double)mesh->cells, rest = 0.5 * one * (1.0 - mesh->shape), angle = one * mesh->shape;
    const double eps2 = mesh->epsilon * mesh->epsilon;
    double energy = 0.0, low = INFINITY;
    Cells b;
    for (ptrdiff_t first = 0; first < mesh->cells; first += BATCH) {
        const ptrdiff_t count = mesh->cells - first < BATCH ? mesh->cells - first : BATCH;
        const ptrdiff_t *restrict quad = mesh->quads + 4 * first;
        const double *restrict aspect = mesh->aspect + 2 * first;
        for (ptrdiff_t k = 0; k < count; k++) {
            for (int c = 0; c < 4; c++)
                b.x[c][k] = x[2 * quad[4 * k + c]], b.y[c][k] = x[2 * quad[4 * k + c] + 1];
            b.along[k] = rest * aspect[2 * k], b.across[k] = rest * aspect[2 * k + 1];
            b.area[k] = mesh->area[first + k];
        }
        if (eps2 > 0.0)
            energy += cell_batch(&b, count, angle, one * mesh->size, eps2, 1);
        else
            energy += cell_batch(&b, count, angle, 0.0, 0.0, 0);
        for (ptrdiff_t k = 0; k < count; k++)
            low = b.least[k] < low ? b.least[k] : low;
        if (!(eps2 > 0.0) && !(low > 0.0))
            break;
        for (ptrdiff_t k = 0; k < count; k++)
            for (int c = 0; c < 4; c++)
                g[2 * quad[4 * k + c]] += b.x[c][k], g[2 * quad[4 * k + c] + 1] += b.y[c][k];
    }
    *smallest = low;
    return energy;
}

/* Take away from the energy what some corners give away of their angle terms. */
static double ease(const QuadMesh *mesh, const double *x, double *g)
{
    const double angle = 0.25 * mesh->shape / (double)mesh->cells;
    double energy = 0.0;
    for (ptrdiff_t k = 0; k < mesh->eased_count; k++) {
        const ptrdiff_t p = 2 * mesh->eased[3 * k], u = 2 * mesh->eased[3 * k + 1], v = 2 * mesh->eased[3 * k + 2];
        const Factors f = {0.0, 0.0, angle * mesh->ease[k], 0.0};
        const Corner c = corner(x[u] - x[p], x[u + 1] - x[p + 1], x[v] - x[p], x[v + 1] - x[p + 1], &f, 0);
        energy += c.energy;
        g[u] -= c.du_x, g[u + 1] -= c.du_y, g[v] -= c.dv_x, g[v + 1] -= c.dv_y;
        g[p] += c.du_x + c.dv_x, g[p + 1] += c.du_y + c.dv_y;
    }
    return energy;
}

/* The logarithms of the lengths of a batch of edges, and the first factors of their forces. */
MESHONET_INLINE void batch_lengths(const QuadMesh *mesh, const double *restrict x, ptrdiff_t first, ptrdiff_t count)
{
    const ptrdiff_t *restrict edge = mesh->edge + 2 * first;
    double *restrict length = mesh->length + first, *restrict force = mesh->force + first;
    const double *restrict target = mesh->target + first;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < count; k++) {
        const ptrdiff_t a = 2 * edge[2 * k], b = 2 * edge[2 * k + 1];
        const double dx = x[b] - x[a], dy = x[b + 1] - x[a + 1];
        length[k] = 0.5 * logarithm(dx * dx + dy * dy + 1e-300, force + k) - target[k];
    }
}

static ptrdiff_t in_batch(const QuadMesh *mesh, ptrdiff_t first)
{
    return mesh->edges - first < BATCH ? mesh->edges - first : BATCH;
}

size_t quad_batches(const QuadMesh *mesh)
{
    return (size_t)((mesh->edges + BATCH - 1) / BATCH);
}

MESHONET_CLONES
void quad_rest(const QuadMesh *mesh, const double *x, const ptrdiff_t *unknown)
{
    for (ptrdiff_t first = 0; first < mesh->edges; first += BATCH) {
        int rests = 1;
        for (ptrdiff_t k = first; k < first + in_batch(mesh, first) && rests; k++) {
            rests = unknown[mesh->edge[2 * k]] < 0 && unknown[mesh->edge[2 * k + 1]] < 0;
            for (int i = 0; i < NEXT_EDGES; i++)
                rests = rests && mesh->line[NEXT_EDGES * k + i] == k;
        }
        mesh->rests[first / BATCH] = (unsigned char)rests;
        if (rests)
            batch_lengths(mesh, x, first, in_batch(mesh, first));
    }
}

MESHONET_CLONES
static double all_pairs(const QuadMesh *mesh, const double *restrict x, double *restrict g)
{
    const ptrdiff_t *restrict edge = mesh->edge, *restrict line = mesh->line, n = mesh->edges;
    double *restrict length = mesh->length, *restrict force = mesh->force;
    const double cells = (double)mesh->cells, pairs = (double)mesh->pairs, limit = mesh->limit;
    const double by = mesh->smoothness * cells / pairs, steep = mesh->steep * cells / pairs;
    double energy = 0.0, excess = 0.0;
    for (ptrdiff_t first = 0; first < n; first += BATCH)
        if (!mesh->rests[first / BATCH])
            batch_lengths(mesh, x, first, in_batch(mesh, first));
    for (ptrdiff_t first = 0; first < n; first += BATCH) {
        if (mesh->rests[first / BATCH])
            continue;
        const ptrdiff_t count = in_batch(mesh, first);
        double squares[BATCH], excesses[BATCH];
        MESHONET_INDEPENDENT
        for (ptrdiff_t l = 0; l < count; l++) {
            const ptrdiff_t k = first + l;
            double sum = 0.0, square = 0.0, beyond = 0.0, over = 0.0;
            for (int i = 0; i < 4; i++) {
                const double d = length[k] - length[line[4 * k + i]];
                sum += d, square += d * d;
            }
            for (int i = FIRST_BEHIND; i < 4; i++) {
                const double d = length[k] - length[line[4 * k + i]];
                const double more = d > limit ? d - limit : d < -limit ? d + limit : 0.0;
                beyond += more, over += more * more;
            }
            force[k] *= 2.0 * (by * sum + steep * beyond);
            squares[l] = square, excesses[l] = over;
        }
        energy += sum_of(squares, count), excess += sum_of(excesses, count);
    }
    for (ptrdiff_t k = 0; k < mesh->crossed_count && steep > 0.0; k++)
        for (int i = 0; i < 2; i++) {
            const ptrdiff_t own = mesh->crossed[2 * k + i], a = 2 * edge[2 * own], b = 2 * edge[2 * own + 1];
            const double d = length[own] - length[mesh->crossed[2 * k + 1 - i]];
            const double more = d > limit ? d - limit : d < -limit ? d + limit : 0.0;
            const double dx = x[b] - x[a], dy = x[b + 1] - x[a + 1], by_x = 2.0 * steep * more / (dx * dx + dy * dy + 1e-300);
            excess += more * more;
            g[a] -= by_x * dx, g[a + 1] -= by_x * dy, g[b] += by_x * dx, g[b + 1] += by_x * dy;
        }
    for (ptrdiff_t first = 0; first < n; first += BATCH)
        for (ptrdiff_t k = first; !mesh->rests[first / BATCH] && k < first + in_batch(mesh, first); k++) {
            const ptrdiff_t a = 2 * edge[2 * k], b = 2 * edge[2 * k + 1];
            const double fx = force[k] * (x[b] - x[a]), fy = force[k] * (x[b + 1] - x[a + 1]);
            g[a] -= fx, g[a + 1] -= fy, g[b] += fx, g[b + 1] += fy;
        }
    return 0.5 * (by * energy + steep * excess);
}

double quad_energy(const QuadMesh *mesh, const double *x, double *g, double *smallest)
{
    memset(g, 0, 2 * (size_t)mesh->nodes * sizeof *g);
    double energy = all_cells(mesh, x, g, smallest);
    if (!(mesh->epsilon > 0.0)) {
        if (!(*smallest > 0.0))
            return INFINITY;
        energy -= ease(mesh, x, g);
    }
    if (mesh->pairs > 0)
        energy += all_pairs(mesh, x, g);
    return isfinite(energy) ? energy : INFINITY;
}
