/* Nodes moved along lines so that the logarithms of neighbouring cells differ by at most a limit. Per line: every change
   of the logarithm is clipped, tilted by what makes up for the length; nodes then stand at the new arc lengths, on the
   chords between the old ones. First cells and last nodes stay. Eight lines are worked on together. */
#include "growth.h"
#include "clones.h"
#include "elementary.h"
#include "team.h"
#include <math.h>
#include <stdlib.h>

#define WIDE 8       /* lines at a time */
#define HALVINGS 40  /* of the range that the tilt of a line lies in */
#define PASSES 12    /* chords change a little when nodes move */
#define BLOCK 128    /* cells that are added in eight sums */
#define FARTHEST 700.0 /* logarithm of the longest cell over the first */

typedef double Row[WIDE];
typedef struct {
    Row *x;      /* (3, levels) */
    Row *step;   /* (levels - 1) */
    Row *change; /* (levels - 1): of the logarithm of the step, up to the next one */
    Row *made;   /* (levels - 1): new steps */
} Room;

typedef struct {
    const Growth *growth;
    ptrdiff_t *some; /* (nodes): lines to change */
} Work;

#define LANE for (int l = 0; l < WIDE; l++)

#define ROWS 6 /* of a room, for each level */

static Room room_of(double *start, ptrdiff_t levels)
{
    Row *rows = (Row *)start;
    return (Room){rows, rows + 3 * levels, rows + 4 * levels, rows + 5 * levels};
}

/* Lines `which`, the last one of `left` repeated beyond the end. */
MESHONET_INLINE void gather(const Growth *s, const Room *r, const ptrdiff_t *which, ptrdiff_t left)
{
    for (int d = 0; d < 3; d++)
        LANE {
            const double *from = s->lines + (d * s->nodes + which[l < left ? l : left - 1]) * s->levels;
            for (ptrdiff_t j = 0; j < s->levels; j++)
                r->x[d * s->levels + j][l] = from[j];
        }
}

/* Steps, and the changes of their logarithms; the largest change of each line. */
MESHONET_INLINE void measure(const Growth *s, const Room *r, double *largest)
{
    const ptrdiff_t levels = s->levels, cells = levels - 1;
    LANE largest[l] = 0.0;
    for (ptrdiff_t j = 0; j < cells; j++)
        LANE {
            double square = 0.0;
            for (int d = 0; d < 3; d++) {
                const double e = r->x[d * levels + j + 1][l] - r->x[d * levels + j][l];
                square += e * e;
            }
            r->step[j][l] = sqrt(square);
            r->change[j][l] = log_double(r->step[j][l]);
        }
    for (ptrdiff_t j = 0; j < cells - 1; j++)
        LANE {
            r->change[j][l] = r->change[j + 1][l] - r->change[j][l];
            largest[l] = larger(largest[l], magnitude(r->change[j][l]));
        }
}

/* The sums of n rows, in the order in which NumPy adds: eight sums of every block, blocks by halves. */
static void sum_rows(const Row *rows, ptrdiff_t n, double *sum)
{
    if (n > BLOCK) {
        const ptrdiff_t half = n / 2 - n / 2 % 8;
        Row other;
        sum_rows(rows, half, sum);
        sum_rows(rows + half, n - half, other);
        LANE sum[l] += other[l];
        return;
    }
    ptrdiff_t k = 0;
    LANE sum[l] = 0.0;
    if (n >= 8) {
        Row part[8];
        for (int p = 0; p < 8; p++)
            LANE part[p][l] = rows[p][l];
        for (k = 8; k + 8 <= n; k += 8)
            for (int p = 0; p < 8; p++)
                LANE part[p][l] += rows[k + p][l];
        LANE sum[l] = ((part[0][l] + part[1][l]) + (part[2][l] + part[3][l])) +
                      ((part[4][l] + part[5][l]) + (part[6][l] + part[7][l]));
    }
    for (; k < n; k++)
        LANE sum[l] += rows[k][l];
}

/* The steps whose logarithms change by at most `bound`, tilted. */
MESHONET_INLINE void tilted(const Room *r, ptrdiff_t cells, const double *bound, const double *tilt)
{
    Row away;
    LANE away[l] = 0.0;
    LANE r->made[0][l] = r->step[0][l];
    for (ptrdiff_t j = 0; j < cells - 1; j++)
        LANE {
            away[l] += larger(smaller(r->change[j][l] + tilt[l], bound[l]), -bound[l]);
            r->made[j + 1][l] = r->step[0][l] * exp_double(larger(smaller(away[l], FARTHEST), -FARTHEST));
        }
}

/* New steps of the same firsts and sums. On lines too long for the limit, all changes are the tilt. */
MESHONET_INLINE void limit(const Growth *s, const Room *r)
{
    const ptrdiff_t cells = s->levels - 1;
    Row length, sum, bound, low, high, tilt;
    sum_rows(r->step, cells, length);
    LANE {
        const int beyond = r->step[0][l] * s->longest / s->first < length[l];
        bound[l] = beyond ? INFINITY : s->used;
        sum[l] = beyond ? 0.0 : 1.0;
        low[l] = -2.0 * s->used, high[l] = 2.0 * s->used;
    }
    for (ptrdiff_t j = 0; j < cells - 1; j++)
        LANE r->change[j][l] *= sum[l];
    for (int k = 0; k < HALVINGS; k++) {
        LANE tilt[l] = 0.5 * (low[l] + high[l]);
        tilted(r, cells, bound, tilt);
        sum_rows(r->made, cells, sum);
        LANE {
            const int shorter = sum[l] < length[l];
            low[l] = shorter ? tilt[l] : low[l];
            high[l] = shorter ? high[l] : tilt[l];
        }
    }
    LANE tilt[l] = 0.5 * (low[l] + high[l]);
    tilted(r, cells, bound, tilt);
}

/* Line `l` with its inner nodes moved to the new arc lengths: into the result, and back into the room. */
MESHONET_INLINE void move_line(const Growth *s, const Room *r, int l, ptrdiff_t line)
{
    const ptrdiff_t levels = s->levels, cells = levels - 1;
    double before = r->step[0][l], after = r->made[0][l]; /* arc lengths of node k + 1, and of the one that moves */
    ptrdiff_t k = 0;
    for (ptrdiff_t j = 2; j < levels - 1; j++) {
        after += r->made[j - 1][l];
        while (k + 1 < cells && before + r->step[k + 1][l] <= after)
            before += r->step[++k][l];
        for (int d = 0; d < 3; d++) {
            const Row *x = r->x + d * levels + 1; /* from the end of the first cell on */
            double *out = s->lines + (d * s->nodes + line) * levels + j;
            if (k == cells - 1 || before == after)
                *out = x[k][l];
            else
                *out = (x[k + 1][l] - x[k][l]) / ((before + r->step[k + 1][l]) - before) * (after - before) + x[k][l];
        }
    }
    for (int d = 0; d < 3; d++) {
        const double *out = s->lines + (d * s->nodes + line) * levels;
        for (ptrdiff_t j = 2; j < levels - 1; j++)
            r->x[d * levels + j][l] = out[j];
    }
}

/* How many of eight lines from `first` on grow by more than the limit, into `some`. */
MESHONET_CLONES
static ptrdiff_t find_eight(const Growth *s, const Room *r, ptrdiff_t first, ptrdiff_t last, ptrdiff_t *some)
{
    ptrdiff_t which[WIDE], found = 0;
    const ptrdiff_t left = last - first < WIDE ? last - first : WIDE;
    Row largest;
    LANE which[l] = first + l;
    gather(s, r, which, left);
    measure(s, r, largest);
    for (int l = 0; l < left; l++)
        if (largest[l] > s->most)
            some[found++] = first + l;
    return found;
}

MESHONET_CLONES
static void limit_eight(const Growth *s, const Room *r, const ptrdiff_t *which, ptrdiff_t left)
{
    gather(s, r, which, left);
    for (int pass = 0; pass < PASSES; pass++) {
        Row largest;
        int uneven = 0;
        measure(s, r, largest);
        LANE uneven |= largest[l] > s->most;
        if (!uneven)
            return;
        limit(s, r);
        for (int l = 0; l < WIDE && l < left; l++)
            if (largest[l] > s->most)
                move_line(s, r, l, which[l]);
        for (ptrdiff_t j = 0; j < 3 * s->levels; j++)
            for (ptrdiff_t l = left; l < WIDE; l++)
                r->x[j][l] = r->x[j][left - 1]; /* what repeats the last line follows it */
    }
}

static void run(void *data, Member member)
{
    const Work *work = data;
    const Growth *s = work->growth;
    const Room room = room_of(team_room(member), s->levels);
    ptrdiff_t found = 0;
    const Range mine = team_share(s->nodes, member);
    ptrdiff_t *some = work->some + mine.first;
    for (ptrdiff_t k = mine.first; k < mine.last; k += WIDE)
        found += find_eight(s, &room, k, mine.last, some + found);
    for (ptrdiff_t k = 0; k < found; k += WIDE)
        limit_eight(s, &room, some + k, found - k < WIDE ? found - k : WIDE);
}

int limit_line_growth(const Growth *growth, int threads)
{
    Work work = {growth, malloc((size_t)growth->nodes * sizeof(ptrdiff_t))};
    const size_t each = (size_t)(ROWS * growth->levels * WIDE);
    const int failed = work.some == NULL ? -1 : team_run_in_rooms(threads, each, run, &work);
    free(work.some);
    return failed;
}
