/* The preconditioner of a descent: gradients turned into the frame of each node, divided as in spectral.h, and turned
   back. Frames are the steps along xi, so that a move in them counts in cells.

   The transforms know neither how the softest moves, p = ψ_ξ with q = -ψ_η, couple both coordinates, nor how cells
   differ: the smoothest ones would come last. So to P comes S H⁻¹ Sᵀ, with S splines from the inner nodes of a coarse
   grid and H the Hessian there (hessian.h), as a banded Cholesky factor. */
#pragma once
#include "hessian.h"
#include "spectral.h"

/* Sᵀ gradient, (mi, mj) to the unknowns of coordinate c; `values` holds ROWS mj floats. */
MESHONET_CLONES
void space_restrict(const Space *s, const double *restrict gradient, ptrdiff_t mi, ptrdiff_t mj, int c,
                    float *restrict values, float *restrict unknowns)
{
    Lanes total[SPACE][SPACE / LANES];
    memset(total, 0, sizeof total);
    for (ptrdiff_t i = 0; i < mi; i += ROWS) {
        const ptrdiff_t rows = mi - i < ROWS ? mi - i : ROWS;
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
    float found[SPACE][SPACE];
    memcpy(found, total, sizeof found);
    for (ptrdiff_t l = 0; l < s->band.mi; l++)
        for (ptrdiff_t k = 0; k < s->band.mj; k++)
            unknowns[2 * (l * s->band.mj + k) + c] = (float)s->unit * found[l][k];
}

/* result += S unknowns of coordinate c. */
MESHONET_INLINE void from_space(const Space *s, const float *restrict unknowns, ptrdiff_t mi, ptrdiff_t mj, int c,
                                float *restrict result)
{
    float total[SPACE][SPACE];
    memset(total, 0, sizeof total);
    for (ptrdiff_t l = 0; l < s->band.mi; l++)
        for (ptrdiff_t k = 0; k < s->band.mj; k++)
            total[l][k] = unknowns[2 * (l * s->band.mj + k) + c];
    for (ptrdiff_t i = 0; i < mi; i++) {
        const float *restrict along = s->along + i * SPACE;
        float *restrict row = result + i * mj, v[SPACE];
        memset(v, 0, sizeof v);
        for (int l = 0; l < SPACE; l++)
            for (int k = 0; k < SPACE; k++)
                v[k] += along[l] * total[l][k];
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

/* result = P gradient. Rows i and mi - 1 - i are folded together. */
MESHONET_CLONES
static void precondition(void *problem, const double *restrict gradient, float *restrict result)
{
    const Descent *d = problem;
    const Spectrum *s = &d->spectrum;
    const ptrdiff_t mi = s->mi, mj = s->mj, width = values_of(&s->eta), modes = modes_of(&s->eta);
    float *w = d->transform, *packed = w + 6 * mi * (width > modes ? width : modes);
    float *a[2] = {packed, packed + mj}, *b[2] = {packed + 2 * mj, packed + 3 * mj};
    for (ptrdiff_t i = 0; i < s->xi.even.nodes; i++) {
        const ptrdiff_t other = mi - 1 - i;
        into_frame(d, gradient, i, a[0], a[1]);
        if (other > i)
            into_frame(d, gradient, other, b[0], b[1]);
        for (int c = 0; c < 2; c++) {
            float *rows = w + c * mi * width;
            if (other > i) {
                mix(a[c], b[c], mj);
                fold(b[c], &s->eta, rows + (s->xi.even.nodes + i) * width);
            }
            fold(a[c], &s->eta, rows + i * width);
        }
    }
    divide(s, w, w + 2 * mi * (width > modes ? width : modes), packed);
    for (ptrdiff_t i = 0; i < s->xi.even.nodes; i++) {
        const ptrdiff_t other = mi - 1 - i;
        for (int c = 0; c < 2; c++) {
            const float *rows = w + c * mi * width;
            unfold(rows + i * width, &s->eta, a[c]);
            if (other > i) {
                unfold(rows + (s->xi.even.nodes + i) * width, &s->eta, b[c]);
                mix(a[c], b[c], mj);
            }
        }
        out_of_frame(d, a[0], a[1], i, result);
        if (other > i)
            out_of_frame(d, b[0], b[1], other, result);
    }
    const Space *space = &d->space;
    if (space->band.mi == 0)
        return;
    for (int c = 0; c < 2; c++)
        space_restrict(space, gradient + c * mi * mj, mi, mj, c, packed, space->unknowns);
    solve_band(&space->band, space->unknowns);
    for (int c = 0; c < 2; c++)
        from_space(space, space->unknowns, mi, mj, c, result + c * mi * mj);
}

/* The step along xi at each free node, from both directions: (p + q) / 2 with p = √a x_ξ and q = -i x_η / √a by centred
   differences, or the longer of the two where they oppose each other, in folded places. */
MESHONET_CLONES
static void set_frame(Descent *d)
{
    const ptrdiff_t nj = d->nj, nodes = d->ni * nj, mi = d->spectrum.mi, mj = d->spectrum.mj, n = mi * mj;
    const double *x = d->z, *y = d->z + nodes;
    const double along = 0.5 * sqrt(d->weights.aspect), across = 0.5 / sqrt(d->weights.aspect);
    for (ptrdiff_t i = 0; i < mi; i++) {
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

/* The largest move of `direction`, in cells. */
MESHONET_CLONES
static double largest_move(void *problem)
{
    const Descent *d = problem;
    const ptrdiff_t n = d->spectrum.mi * d->spectrum.mj;
    const float *restrict fx = d->frame, *restrict fy = d->frame + n;
    const float *restrict dx = d->steps.direction, *restrict dy = dx + n;
    float most = 0.0f;
    for (ptrdiff_t k = 0; k < n; k++) {
        const float move = (dx[k] * dx[k] + dy[k] * dy[k]) / (fx[k] * fx[k] + fy[k] * fy[k] + 1e-36f);
        most = move > most ? move : most;
    }
    return sqrt((double)most);
}
