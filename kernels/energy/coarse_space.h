/* Moves that a few nodes describe, and the functional's own Hessian on these.

   The transforms know neither how the softest moves, p = ψ_ξ with q = -ψ_η, couple both coordinates, nor how cells
   differ: the smoothest ones would come last. So to P comes S H⁻¹ Sᵀ, with S splines from the inner nodes of a coarse
   grid and H the Hessian there (hessian.h), as a banded Cholesky factor. */
#pragma once
#include "clones.h"
#include "spectral.h"
#include "variational.h"
#include <string.h>

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
