/* Wall nodes as unknowns: nodes on their curves, in order, and edges that do not cut bends off. Angles alone are better
   the more of a tip is left out. */
#include "walls.h"
#include <math.h>
#include <string.h>

#define LEAST 1e-9 /* of a loop's length: the least distance between its nodes */

static int slides(const Walls *walls, const WallLoop *loop)
{
    for (ptrdiff_t k = loop->first_node; k < loop->last_node; k++)
        if (walls->unknown[k] >= 0)
            return 1;
    return 0;
}

void walls_place(const Walls *walls, double *x, int first_time)
{
    for (ptrdiff_t l = 0; l < walls->loops; l++) {
        const WallLoop *loop = walls->loop + l;
        if (!first_time && !slides(walls, loop))
            continue;
        const ptrdiff_t first = loop->first_node, count = loop->last_node - first, n = loop->lengths.n;
        const double length = loop->lengths.table[n * loop->lengths.pieces];
        ptrdiff_t *interval = walls->interval + first;
        double *place = walls->place + first, *point = walls->point + 2 * first, *slope = walls->tangent + 2 * first;
        curve_locate(&loop->lengths, walls->arc + first, count, interval, place);
        curve_points(loop->cubic, n, interval, place, count, loop->end, point);
        curve_slopes(loop->cubic, n, interval, place, count, slope);
        for (ptrdiff_t k = 0; k < count; k++) {
            const double speed = sqrt(slope[2 * k] * slope[2 * k] + slope[2 * k + 1] * slope[2 * k + 1]);
            const double *turned = loop->turned + interval[k], bend = turned[1] - turned[0];
            const double laps = floor(walls->arc[first + k] / length);
            slope[2 * k] /= speed, slope[2 * k + 1] /= speed;
            walls->turned[first + k] = turned[0] + place[k] * bend + laps * loop->turned[n];
            walls->turning[first + k] = bend / speed;
            if (walls->unknown[first + k] >= 0) {
                double *to = x + 2 * walls->node[first + k];
                to[0] = point[2 * k], to[1] = point[2 * k + 1];
            }
        }
    }
}

double walls_energy(const Walls *walls, double weight, double allowed)
{
    double energy = 0.0;
    memset(walls->force, 0, (size_t)walls->nodes * sizeof(double));
    for (ptrdiff_t l = 0; l < walls->loops; l++) {
        const WallLoop *loop = walls->loop + l;
        const ptrdiff_t n = loop->lengths.n;
        const double length = loop->lengths.table[n * loop->lengths.pieces];
        for (ptrdiff_t k = loop->first_edge; k < loop->last_edge; k++) {
            const ptrdiff_t a = walls->edge[2 * k], b = walls->edge[2 * k + 1];
            if (!(walls->arc[b] - walls->arc[a] + walls->round[k] > LEAST * length))
                return INFINITY;
            const double laps = rint(walls->round[k] / length);
            const double over = walls->turned[b] - walls->turned[a] + laps * loop->turned[n] - allowed;
            if (!(over > 0.0))
                continue;
            const double square = over * over, force = weight * over * (2.0 + 6.0 * square * square);
            energy += weight * square * (1.0 + square * square);
            walls->force[a] -= force * walls->turning[a];
            walls->force[b] += force * walls->turning[b];
        }
    }
    return energy;
}
