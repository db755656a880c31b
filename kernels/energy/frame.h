/* The preconditioner of a minimisation: P as in spectral.h in the frame of each node, the step along xi, plus
   S H⁻¹ Sᵀ for smooth displacements, with S splines from the inner nodes of a coarse grid and H the Hessian there
   (hessian.h). */
#pragma once
#include "hessian.h"
#include "spectral.h"
#include "team.h"

/* Rows of nodes whose part in Sᵀ gradient is summed at a time. */
#define BLOCK_ROWS (20 * ROWS)

MESHONET_INLINE ptrdiff_t space_blocks(ptrdiff_t mi) { return (mi + BLOCK_ROWS - 1) / BLOCK_ROWS; }

/* Sᵀ gradient, a block of rows of (mi, mj) to (SPACE, SPACE); `values` holds ROWS mj floats. */
MESHONET_CLONES
static void restrict_block(const Space *s, const double *restrict gradient, ptrdiff_t mi, ptrdiff_t mj, ptrdiff_t block,
                           float *restrict values, float *restrict found)
{
    const ptrdiff_t end = (block + 1) * BLOCK_ROWS < mi ? (block + 1) * BLOCK_ROWS : mi;
    Lanes total[SPACE][SPACE / LANES];
    memset(total, 0, sizeof total);
    for (ptrdiff_t i = block * BLOCK_ROWS; i < end; i += ROWS) {
        const ptrdiff_t rows = end - i < ROWS ? end - i : ROWS;
        Lanes sum[ROWS][SPACE / LANES];
        memset(sum, 0, sizeof sum);
        for (ptrdiff_t k = 0; k < rows * mj; k++)
            values[k] = (float)gradient[i * mj + k];
        memset(values + rows * mj, 0, (size_t)((ROWS - rows) * mj) * sizeof *values);
        for (ptrdiff_t j = 0; j < mj; j++) {
            const Lanes *line = (const Lanes *)(s->across + j * SPACE);
            for (int r = 0; r < ROWS; r++)
                for (int v = 0; v < SPACE / LANES; v++)
                    sum[r][v] += values[r * mj + j] * line[v];
        }
        for (ptrdiff_t r = 0; r < rows; r++)
            for (int l = 0; l < SPACE; l++)
                for (int v = 0; v < SPACE / LANES; v++)
                    total[l][v] += s->along[(i + r) * SPACE + l] * sum[r][v];
    }
    memcpy(found, total, sizeof total);
}

/* The sums of all blocks to the unknowns of coordinate c. */
static void restrict_sum(const Space *s, const float *blocks, ptrdiff_t count, int c, float *unknowns)
{
    for (ptrdiff_t l = 0; l < s->band.mi; l++)
        for (ptrdiff_t k = 0; k < s->band.mj; k++) {
            float total = 0.0f;
            for (ptrdiff_t b = 0; b < count; b++)
                total += blocks[(b * SPACE + l) * SPACE + k];
            unknowns[2 * (l * s->band.mj + k) + c] = (float)s->unit * total;
        }
}

/* result += S unknowns of coordinate c, in rows `first` to before `last`. */
MESHONET_INLINE void from_space(const Space *s, const float *restrict unknowns, ptrdiff_t first, ptrdiff_t last,
                                ptrdiff_t mj, int c, float *restrict result)
{
    float total[SPACE][SPACE];
    memset(total, 0, sizeof total);
    for (ptrdiff_t l = 0; l < s->band.mi; l++)
        for (ptrdiff_t k = 0; k < s->band.mj; k++)
            total[l][k] = unknowns[2 * (l * s->band.mj + k) + c];
    for (ptrdiff_t i = first; i < last; i++) {
        const float *restrict along = s->along + i * SPACE;
        float *restrict row = result + i * mj, v[SPACE];
        for (int k = 0; k < SPACE; k += LANES) {
            Lanes sum = {0.0f};
            for (int l = 0; l < SPACE; l++)
                sum += along[l] * *(const Lanes *)(total[l] + k);
            *(Lanes *)(v + k) = sum;
        }
        for (int k = 0; k < SPACE; k += 4) {
            const float *restrict a = s->across_t + k * mj, *restrict b = a + mj;
            const float *restrict e = b + mj, *restrict f = e + mj;
            for (ptrdiff_t j = 0; j < mj; j++)
                row[j] += (v[k] * a[j] + v[k + 1] * b[j]) + (v[k + 2] * e[j] + v[k + 3] * f[j]);
        }
    }
}

/* Row i of the gradient in the frames of its nodes, as rows x and y. */
MESHONET_INLINE void into_frame(const Descent *d, const double *restrict gradient, ptrdiff_t i, float *restrict x,
                                float *restrict y)
{
    const ptrdiff_t mj = d->spectrum.mj, n = d->spectrum.mi * mj, k = i * mj;
    const float *restrict fx = d->frame + k, *restrict fy = fx + n;
    const double *restrict gx = gradient + k, *restrict gy = gx + n;
    for (ptrdiff_t j = 0; j < mj; j++) {
        const float px = (float)gx[j], py = (float)gy[j];
        x[j] = fx[j] * px + fy[j] * py, y[j] = fx[j] * py - fy[j] * px;
    }
}

/* Row i of the result from rows x and y. */
MESHONET_INLINE void out_of_frame(const Descent *d, const float *restrict x, const float *restrict y, ptrdiff_t i,
                                  float *restrict result)
{
    const ptrdiff_t mj = d->spectrum.mj, n = d->spectrum.mi * mj, k = i * mj;
    const float *restrict fx = d->frame + k, *restrict fy = fx + n;
    float *restrict rx = result + k, *restrict ry = rx + n;
    for (ptrdiff_t j = 0; j < mj; j++)
        rx[j] = fx[j] * x[j] - fy[j] * y[j], ry[j] = fx[j] * y[j] + fy[j] * x[j];
}

/* Floats that a member of the team needs: four rows, a panel, rows of a product. */
MESHONET_INLINE ptrdiff_t member_floats(const Spectrum *s)
{
    return PANEL * DEPTH + ROWS * s->mj;
}

/* P gradient, by a team. */
typedef struct {
    const Descent *d;
    const double *gradient;
    float *result, *w, *spare, *blocks, *room;
} Preconditioning;

/* Turn the gradient into frames and fold it: rows i and mi - 1 - i, `first` to before `last`, together. */
MESHONET_CLONES
static void fold_rows(const Preconditioning *p, ptrdiff_t first, ptrdiff_t last, float *packed)
{
    const Descent *d = p->d;
    const Spectrum *s = &d->spectrum;
    const ptrdiff_t mi = s->mi, mj = s->mj, width = values_of(&s->eta);
    float *a[2] = {packed, packed + mj}, *b[2] = {packed + 2 * mj, packed + 3 * mj};
    for (ptrdiff_t i = first; i < last; i++) {
        const ptrdiff_t other = mi - 1 - i;
        into_frame(d, p->gradient, i, a[0], a[1]);
        if (other > i)
            into_frame(d, p->gradient, other, b[0], b[1]);
        for (int c = 0; c < 2; c++) {
            float *rows = p->w + c * mi * width;
            if (other > i) {
                mix(a[c], b[c], mj);
                fold(b[c], &s->eta, rows + (s->xi.even.nodes + i) * width);
            }
            fold(a[c], &s->eta, rows + i * width);
        }
    }
}

/* The way back. */
MESHONET_CLONES
static void unfold_rows(const Preconditioning *p, ptrdiff_t first, ptrdiff_t last, float *packed)
{
    const Descent *d = p->d;
    const Spectrum *s = &d->spectrum;
    const ptrdiff_t mi = s->mi, mj = s->mj, width = values_of(&s->eta);
    float *a[2] = {packed, packed + mj}, *b[2] = {packed + 2 * mj, packed + 3 * mj};
    for (ptrdiff_t i = first; i < last; i++) {
        const ptrdiff_t other = mi - 1 - i;
        for (int c = 0; c < 2; c++) {
            const float *rows = p->w + c * mi * width;
            unfold(rows + i * width, &s->eta, a[c]);
            if (other > i) {
                unfold(rows + (s->xi.even.nodes + i) * width, &s->eta, b[c]);
                mix(a[c], b[c], mj);
            }
        }
        out_of_frame(d, a[0], a[1], i, p->result);
        if (other > i)
            out_of_frame(d, b[0], b[1], other, p->result);
    }
}

MESHONET_CLONES
static void add_space(const Preconditioning *p, ptrdiff_t first, ptrdiff_t last)
{
    const Space *space = &p->d->space;
    const ptrdiff_t mi = p->d->spectrum.mi, mj = p->d->spectrum.mj;
    for (int c = 0; c < 2; c++)
        from_space(space, space->unknowns, first, last, mj, c, p->result + c * mi * mj);
}

static void precondition_share(void *data, Member member)
{
    const Preconditioning *p = data;
    const Spectrum *s = &p->d->spectrum;
    float *own = p->room + member.rank * member_floats(s);
    const Range mine = team_share(s->xi.even.nodes, member);
    fold_rows(p, mine.first, mine.last, own);
    team_wait(member);
    divide(s, p->w, p->spare, own, member);
    team_wait(member);
    unfold_rows(p, mine.first, mine.last, own);
}

/* Sᵀ of one coordinate of the gradient. */
typedef struct {
    const Preconditioning *p;
    int coordinate;
} Restriction;

static void restrict_share(void *data, Member member)
{
    const Restriction *r = data;
    const Preconditioning *p = r->p;
    const ptrdiff_t mi = p->d->spectrum.mi, mj = p->d->spectrum.mj;
    float *own = p->room + member.rank * member_floats(&p->d->spectrum);
    const Range mine = team_share(space_blocks(mi), member);
    for (ptrdiff_t k = mine.first; k < mine.last; k++)
        restrict_block(&p->d->space, p->gradient + r->coordinate * mi * mj, mi, mj, k, own,
                       p->blocks + k * SPACE * SPACE);
}

TEAM_ROWS(space_share, Preconditioning, task->d->spectrum.mi, add_space)

/* result = P gradient. */
static void precondition(void *problem, const double *gradient, float *result)
{
    const Descent *d = problem;
    const Space *space = &d->space;
    const Spectrum *s = &d->spectrum;
    const ptrdiff_t width = values_of(&s->eta), modes = modes_of(&s->eta), wide = width > modes ? width : modes;
    float *w = d->transform, *blocks = w + 6 * s->mi * wide, *room = blocks + SPACE * SPACE * space_blocks(s->mi);
    Preconditioning p = {d, gradient, result, w, w + 2 * s->mi * wide, blocks, room};
    team_run(d->threads, precondition_share, &p);
    if (space->band.mi == 0)
        return;
    for (int c = 0; c < 2; c++) {
        Restriction r = {&p, c};
        team_run(d->threads, restrict_share, &r);
        restrict_sum(space, blocks, space_blocks(s->mi), c, space->unknowns);
    }
    solve_band(&space->band, space->unknowns);
    team_run(d->threads, space_share, &p);
}

/* The step along xi at each free node, from both directions: (p + q) / 2 with p = √a x_ξ and q = -i x_η / √a by centred
   differences, or the longer of the two where they oppose each other, in folded places. */
MESHONET_CLONES
static void frame_rows(const Descent *d, ptrdiff_t first, ptrdiff_t last)
{
    const ptrdiff_t nj = d->nj, nodes = d->ni * nj, mi = d->spectrum.mi, mj = d->spectrum.mj, n = mi * mj;
    const double *x = d->z, *y = d->z + nodes;
    const double along = 0.5 * sqrt(d->weights.aspect), across = 0.5 / sqrt(d->weights.aspect);
    for (ptrdiff_t i = first; i < last; i++) {
        const ptrdiff_t at = d->first + i, west = at > 0 ? at - 1 : d->ni - 2;
        for (ptrdiff_t j = 1; j <= mj; j++) {
            const ptrdiff_t k = at * nj + j, w = west * nj + j, e = (at + 1) * nj + j;
            const double px = along * (x[e] - x[w]), py = along * (y[e] - y[w]);
            const double qx = across * (y[k + 1] - y[k - 1]), qy = -across * (x[k + 1] - x[k - 1]);
            const double p = px * px + py * py, q = qx * qx + qy * qy;
            double cx = 0.5 * (px + qx), cy = 0.5 * (py + qy);
            if (cx * cx + cy * cy < 0.05 * (p + q))
                cx = p > q ? px : qx, cy = p > q ? py : qy;
            d->frame[i * mj + j - 1] = (float)cx, d->frame[n + i * mj + j - 1] = (float)cy;
        }
    }
}

TEAM_ROWS(frame_share, Descent, task->spectrum.mi, frame_rows)

/* The square of the largest move of `direction`, in cells, at free nodes `first` to before `last`. */
MESHONET_CLONES
static float largest_of(const Descent *d, ptrdiff_t first, ptrdiff_t last)
{
    const ptrdiff_t n = d->spectrum.mi * d->spectrum.mj;
    const float *restrict fx = d->frame, *restrict fy = d->frame + n;
    const float *restrict dx = d->steps.direction, *restrict dy = dx + n;
    float most = 0.0f;
    for (ptrdiff_t k = first; k < last; k++) {
        const float move = (dx[k] * dx[k] + dy[k] * dy[k]) / (fx[k] * fx[k] + fy[k] * fy[k] + 1e-36f);
        most = move > most ? move : most;
    }
    return most;
}

typedef struct {
    const Descent *d;
    float most[TEAM_MOST]; /* of each thread */
} Largest;

static void largest_share(void *data, Member member)
{
    Largest *l = data;
    const Range mine = team_share(l->d->spectrum.mi, member);
    float most = 0.0f;
    for (ptrdiff_t i = mine.first; i < mine.last; i++) { /* row by row: whatever the share, they are rounded alike */
        const float row = largest_of(l->d, i * l->d->spectrum.mj, (i + 1) * l->d->spectrum.mj);
        most = row > most ? row : most;
    }
    l->most[member.rank] = most;
}

static double largest_move(void *problem)
{
    Largest l = {problem, {0.0f}};
    float most = 0.0f;
    team_run(l.d->threads, largest_share, &l);
    for (int k = 0; k < TEAM_MOST; k++)
        most = l.most[k] > most ? l.most[k] : most;
    return sqrt((double)most);
}
