#include <string.h>

#include "geometry/tally.h"
#include "row.h"
#include "team.h"

/* Volumes of a row of cells: the integral of the Jacobian of the trilinear map. With its centre's derivatives a, b, c,
   the bilinear ones d (of j and k), e (k, i), f (i, j), it is 8 [abc] + 8/3 ([afe] + [fbd] + [edc]). */
MESHONET_CLONES
static void row_volumes(const SolidLines *lines, ptrdiff_t cells, double *restrict volumes)
{
    const SolidLines own = *lines;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < cells; k++) {
        const SolidEdges s = solid_edges(&own, k);
        const Vector a = plus(plus(s.u[0][0], s.u[0][1]), plus(s.u[1][0], s.u[1][1]));
        const Vector b = plus(plus(s.v[0][0], s.v[0][1]), plus(s.v[1][0], s.v[1][1]));
        const Vector c = plus(plus(s.w[0][0], s.w[0][1]), plus(s.w[1][0], s.w[1][1]));
        const Vector d = minus(plus(s.v[0][1], s.v[1][1]), plus(s.v[0][0], s.v[1][0]));
        const Vector e = minus(plus(s.u[0][1], s.u[1][1]), plus(s.u[0][0], s.u[1][0]));
        const Vector f = minus(plus(s.u[1][0], s.u[1][1]), plus(s.u[0][0], s.u[0][1]));
        /* 1/8 of each of these is the derivative by a coordinate that runs from -1 to 1 */
        const double sides = triple(a, f, e) + triple(f, b, d) + triple(e, d, c);
        volumes[k] = magnitude(triple(a, b, c) + sides * (1.0 / 3.0)) * (1.0 / 64.0);
    }
}

typedef struct {
    const SolidNodes *nodes;
    double *volumes;
} Volumes;

static void volumes_of_rows(void *data, Member member)
{
    const Volumes *to = data;
    const SolidNodes *nodes = to->nodes;
    const ptrdiff_t nj = nodes->nj - 1;
    const Range mine = team_share((nodes->ni - 1) * nj, member);
    for (ptrdiff_t row = mine.first; row < mine.last; row++) {
        const ptrdiff_t i = row / nj, j = row % nj;
        const SolidLines lines = solid_lines(nodes, i, j);
        row_volumes(&lines, nodes->nk - 1, to->volumes + ((i + 1) * (nodes->nj + 1) + j + 1) * (nodes->nk + 1) + 1);
    }
}

void solids_volumes(const SolidNodes *nodes, int threads, double *volumes)
{
    Volumes to = {nodes, volumes};
    team_run(threads, volumes_of_rows, &to);
}

static ptrdiff_t chunks_of_plane(const SolidNodes *nodes) { return (nodes->nj - 1 + SOLID_ROWS - 1) / SOLID_ROWS; }

ptrdiff_t solids_chunks(const SolidNodes *nodes) { return (nodes->ni - 1) * chunks_of_plane(nodes); }

/* Scratch of one thread: inverse lengths at the lines of both ends of a row in j, and its metrics. */
typedef struct {
    SolidLengths lengths;
    double *metrics;
} Scratch;

static Scratch scratch_in(double *room, ptrdiff_t nk)
{
    Scratch scratch = {.metrics = room + 8 * nk};
    for (int a = 0; a < 2; a++) {
        scratch.lengths.u[a] = room + a * nk;
        scratch.lengths.v[a] = room + (2 + a) * nk;
        for (int b = 0; b < 2; b++)
            scratch.lengths.w[a][b] = room + (4 + 2 * a + b) * nk;
    }
    return scratch;
}

/* Inverse lengths of the edges of a row at j + b that are along i and k. */
static void lengths_at(const SolidLines *lines, int b, ptrdiff_t nk, SolidLengths *to)
{
    solid_inverse_lengths(lines->at[0][b], lines->at[1][b], nk, to->u[b]);
    for (int a = 0; a < 2; a++) {
        const double *const *line = lines->at[a][b];
        const double *const next[3] = {line[0] + 1, line[1] + 1, line[2] + 1};
        solid_inverse_lengths(line, next, nk - 1, to->w[a][b]);
    }
}

/* What was at j + 1 is at j in the next row. */
static void lengths_moved(SolidLengths *lengths)
{
    SolidLengths old = *lengths;
    for (int b = 0; b < 2; b++) {
        lengths->u[b] = old.u[1 - b];
        lengths->w[0][b] = old.w[0][1 - b];
        lengths->w[1][b] = old.w[1][1 - b];
    }
}

static void lengths_along_j(const SolidLines *lines, ptrdiff_t nk, SolidLengths *to)
{
    for (int a = 0; a < 2; a++)
        solid_inverse_lengths(lines->at[a][0], lines->at[a][1], nk, to->v[a]);
}

static void measured_row(const SolidNodes *nodes, const SolidLines *lines, const SolidLengths *lengths,
                         const double *volumes, ptrdiff_t i, ptrdiff_t j, ptrdiff_t stride, double *out)
{
    const ptrdiff_t line = nodes->nk + 1, beside[2] = {(nodes->nj + 1) * line, line};
    const double *own = volumes + (i + 1) * beside[0] + (j + 1) * beside[1] + 1;
    solid_row(lines, lengths, own, beside, nodes->nk - 1, stride, out);
}

/* Take the metrics of row (i, j) into what is known of its chunk. */
static void take_row(const SolidRun *run, ptrdiff_t chunk, int fresh, ptrdiff_t i, ptrdiff_t j, double *rows)
{
    const ptrdiff_t cells = run->nodes.nk - 1;
    for (ptrdiff_t metric = 0; metric < SOLID_METRICS; metric++) {
        const double *row = rows + metric * cells;
        double low, high, sum, *summary = run->summary + 3 * (chunk * SOLID_METRICS + metric);
        int64_t *where = run->where + 6 * (chunk * SOLID_METRICS + metric);
        values_reduce(row, cells, &low, &high, &sum);
        if (fresh || low < summary[0])
            summary[0] = low, where[0] = i, where[1] = j, where[2] = value_place(row, cells, low);
        if (fresh || high > summary[2])
            summary[2] = high, where[3] = i, where[4] = j, where[5] = value_place(row, cells, high);
        summary[1] = fresh ? sum : summary[1] + sum;
        if (metric >= run->keep && metric < run->keep + run->n_kept) {
            const ptrdiff_t at = ((metric - run->keep) * (run->nodes.ni - 1) + i) * (run->nodes.nj - 1) + j;
            memcpy(run->kept + at * cells, row, (size_t)cells * sizeof(double));
        }
    }
}

static void run_chunk(const SolidRun *run, ptrdiff_t chunk, Scratch *scratch)
{
    const SolidNodes *nodes = &run->nodes;
    const ptrdiff_t a_plane = chunks_of_plane(nodes), i = chunk / a_plane, first = chunk % a_plane * SOLID_ROWS;
    const ptrdiff_t last = first + SOLID_ROWS < nodes->nj - 1 ? first + SOLID_ROWS : nodes->nj - 1;
    for (ptrdiff_t j = first; j < last; j++) {
        const SolidLines lines = solid_lines(nodes, i, j);
        if (j == first)
            lengths_at(&lines, 0, nodes->nk, &scratch->lengths);
        else
            lengths_moved(&scratch->lengths);
        lengths_at(&lines, 1, nodes->nk, &scratch->lengths);
        lengths_along_j(&lines, nodes->nk, &scratch->lengths);
        measured_row(nodes, &lines, &scratch->lengths, run->volumes, i, j, nodes->nk - 1, scratch->metrics);
        take_row(run, chunk, j == first, i, j, scratch->metrics);
    }
}

static void run_chunks(void *data, Member member)
{
    const SolidRun *run = data;
    Scratch scratch = scratch_in(team_room(member), run->nodes.nk);
    const Range mine = team_share(solids_chunks(&run->nodes), member);
    for (ptrdiff_t chunk = mine.first; chunk < mine.last; chunk++)
        run_chunk(run, chunk, &scratch);
}

int solids_run(const SolidRun *run, int threads)
{
    return team_run_in_rooms(threads, (8 + SOLID_METRICS) * (size_t)run->nodes.nk, run_chunks, (void *)run) == 0;
}
