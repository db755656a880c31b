/* Nodes moved along the lines of a march. Per line: the logarithm of step over law is smoothed along the line, what it
   is at the wall is taken off, fading outwards, and its length is kept; nodes then stand at the new arc lengths, on
   cubic Hermite curves through the marched ones. Eight lines are worked on together. */
#include "lines.h"
#include "clones.h"
#include "elementary.h"
#include "team.h"
#include <math.h>
#include <string.h>

#define WIDE 8 /* lines at a time */
#define FITS 6 /* rounds that fit the length */

typedef double Row[WIDE];
typedef struct {
    Row *x;      /* (3, levels) */
    Row *arc;    /* (levels): of the marched nodes */
    Row *edge;   /* (levels - 1) */
    Row *ratio, *other; /* (levels - 1): logarithm of step over law */
    Row *place;  /* (levels): new arc lengths */
    Row *slope;  /* (3, levels): tangents */
} Room;

#define ROWS 11 /* of a room, for each level */

static Room room_of(double *start, ptrdiff_t levels)
{
    Row *rows = (Row *)start;
    return (Room){rows,
                  rows + 3 * levels,
                  rows + 4 * levels,
                  rows + 5 * levels,
                  rows + 6 * levels,
                  rows + 7 * levels,
                  rows + 8 * levels};
}

#define LANE for (int l = 0; l < WIDE; l++)

/* Positions of lines first .. first + 7, the last one repeated beyond the end, edges and arc lengths. */
MESHONET_INLINE void gather(const Lines *s, const Room *r, ptrdiff_t first)
{
    const ptrdiff_t n = s->nodes, left = n - first < WIDE ? n - first : WIDE;
    for (int d = 0; d < 3; d++)
        for (ptrdiff_t j = 0; j < s->levels; j++) {
            const double *from = s->marched + (3 * j + d) * n + first;
            LANE r->x[d * s->levels + j][l] = from[l < left ? l : left - 1];
        }
    LANE r->arc[0][l] = 0.0;
    for (ptrdiff_t j = 0; j < s->levels - 1; j++)
        LANE {
            double square = 0.0;
            for (int d = 0; d < 3; d++) {
                const double e = r->x[d * s->levels + j + 1][l] - r->x[d * s->levels + j][l];
                square += e * e;
            }
            r->edge[j][l] = sqrt(square);
            r->arc[j + 1][l] = r->arc[j][l] + r->edge[j][l];
            r->ratio[j][l] = log_double(r->edge[j][l] / s->steps[j]);
        }
}

/* The new arc lengths. */
MESHONET_INLINE void place_nodes(const Lines *s, const Room *r)
{
    const ptrdiff_t cells = s->levels - 1;
    Row *ratio = r->ratio, *other = r->other;
    for (ptrdiff_t sweep = 0; sweep < s->sweeps && cells > 2; sweep++) {
        for (ptrdiff_t j = 1; j < cells - 1; j++)
            LANE other[j][l] = 0.25 * (ratio[j - 1][l] + 2.0 * ratio[j][l] + ratio[j + 1][l]);
        LANE other[0][l] = 0.5 * (ratio[0][l] + other[1][l]);
        LANE other[cells - 1][l] = 0.5 * (ratio[cells - 1][l] + other[cells - 2][l]);
        Row *held = ratio;
        ratio = other, other = held;
    }
    Row wall;
    LANE wall[l] = ratio[0][l];
    for (ptrdiff_t j = 0; j < cells; j++)
        LANE ratio[j][l] -= s->fade[j] * wall[l];
    for (int fit = 0; fit <= FITS; fit++) {
        LANE r->place[0][l] = 0.0;
        for (ptrdiff_t j = 0; j < cells; j++)
            LANE r->place[j + 1][l] = r->place[j][l] + s->steps[j] * exp_double(ratio[j][l]);
        Row more;
        LANE more[l] = log_double(r->arc[cells][l] / r->place[cells][l]);
        for (ptrdiff_t j = 0; j < cells && fit < FITS; j++)
            LANE ratio[j][l] += (1.0 - s->fade[j]) * more[l];
    }
    LANE r->place[cells][l] = r->arc[cells][l];
}

MESHONET_INLINE void slopes(const Lines *s, const Room *r)
{
    const ptrdiff_t last = s->levels - 1;
    for (int d = 0; d < 3; d++) {
        Row *x = r->x + d * s->levels, *slope = r->slope + d * s->levels;
        for (ptrdiff_t j = 1; j < last; j++)
            LANE {
                const double a = r->edge[j - 1][l], b = r->edge[j][l];
                slope[j][l] = ((x[j + 1][l] - x[j][l]) * a / b + (x[j][l] - x[j - 1][l]) * b / a) / (a + b);
            }
        LANE slope[0][l] = (x[1][l] - x[0][l]) / r->edge[0][l];
        LANE slope[last][l] = (x[last][l] - x[last - 1][l]) / r->edge[last - 1][l];
    }
}

/* Line `l` at its new places, into the result. */
MESHONET_INLINE void put_line(const Lines *s, const Room *r, int l, ptrdiff_t line)
{
    const ptrdiff_t levels = s->levels;
    double *out = s->lines + line * levels;
    ptrdiff_t k = 0;
    for (ptrdiff_t j = 0; j < levels; j++) {
        const double place = fmin(r->place[j][l], r->arc[levels - 1][l]);
        while (k < levels - 2 && r->arc[k + 1][l] < place)
            k++;
        const double h = r->edge[k][l], u = (place - r->arc[k][l]) / h, v = 1.0 - u;
        for (int d = 0; d < 3; d++) {
            const Row *x = r->x + d * levels, *slope = r->slope + d * levels;
            out[d * s->nodes * levels + j] = x[k][l] + u * u * (3.0 - 2.0 * u) * (x[k + 1][l] - x[k][l]) +
                                             h * u * v * (v * slope[k][l] - u * slope[k + 1][l]);
        }
    }
    double square = 0.0;
    for (int d = 0; d < 3; d++) {
        double *x = out + d * s->nodes * levels;
        x[0] = r->x[d * levels][l], x[levels - 1] = r->x[d * levels + levels - 1][l];
        square += (x[1] - x[0]) * (x[1] - x[0]);
    }
    for (int d = 0; d < 3; d++) {
        double *x = out + d * s->nodes * levels;
        x[1] = x[0] + (x[1] - x[0]) * s->steps[0] / sqrt(square);
    }
}

MESHONET_CLONES
static void eight_lines(const Lines *lines, const Room *room, ptrdiff_t first)
{
    gather(lines, room, first);
    place_nodes(lines, room);
    slopes(lines, room);
    for (int l = 0; l < WIDE && first + l < lines->nodes; l++)
        put_line(lines, room, l, lines->order[first + l]);
}

static void run(void *data, Member member)
{
    const Lines *lines = data;
    const Room room = room_of(team_room(member), lines->levels);
    const Range mine = team_share((lines->nodes + WIDE - 1) / WIDE, member);
    for (ptrdiff_t k = mine.first; k < mine.last; k++)
        eight_lines(lines, &room, k * WIDE);
}

int respace_lines(const Lines *lines, int threads)
{
    return team_run_in_rooms(threads, (size_t)(ROWS * lines->levels * WIDE), run, (void *)lines);
}
