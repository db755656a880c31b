/* Moves that a few nodes describe, and the functional's own Hessian on these.

   The transforms know neither how the softest moves, p = ψ_ξ with q = -ψ_η, couple both coordinates, nor how cells
   differ: the smoothest ones would come last. So to P comes S H⁻¹ Sᵀ, with S splines from the inner nodes of a coarse
   grid and H the Hessian there, by differences of the gradient, as a banded Cholesky factor. */
#ifndef MESHONET_COARSE_SPACE_H
#define MESHONET_COARSE_SPACE_H
#include "clones.h"
#include "spectral.h"
#include "variational_kernel.h"
#include <math.h>
#include <string.h>

/* A node shares terms of the functional with the 13 that are two steps or fewer away. Such diamonds tile the plane, one
   of each colour in any, so nodes of one colour share none (Golomb, Welch, SIAM J. Appl. Math. 18 (1970) 302-317). */
#define COLOURS 13
#define COLOUR(i, j) ((2 * (i) + 3 * (j)) % COLOURS)
#define STEP 1e-6 /* of the cells, for differences */

/* L of H = L Lᵀ, in place, rows of `width` + 1 up to the diagonal; return 0 when H is not positive. */
MESHONET_INLINE int factorise(double *band, ptrdiff_t n, ptrdiff_t width)
{
    const ptrdiff_t stride = width + 1;
    for (ptrdiff_t r = 0; r < n; r++) {
        double *row = band + r * stride + width - r; /* row[c] is H(r, c) */
        for (ptrdiff_t c = r > width ? r - width : 0; c <= r; c++) {
            const double *other = band + c * stride + width - c;
            const ptrdiff_t from = r > width ? r - width : 0, low = c > width ? c - width : 0;
            double sum = row[c];
            for (ptrdiff_t k = from > low ? from : low; k < c; k++)
                sum -= row[k] * other[k];
            if (c < r)
                row[c] = sum / other[c];
            else if (sum > 0.0)
                row[r] = sqrt(sum);
            else
                return 0;
        }
    }
    return 1;
}

/* Replace b by H⁻¹ b. */
MESHONET_INLINE void solve_band(const double *band, ptrdiff_t n, ptrdiff_t width, double *restrict b)
{
    const ptrdiff_t stride = width + 1;
    for (ptrdiff_t r = 0; r < n; r++) {
        const double *restrict row = band + r * stride + width - r;
        double sum = b[r];
        for (ptrdiff_t k = r > width ? r - width : 0; k < r; k++)
            sum -= row[k] * b[k];
        b[r] = sum / row[r];
    }
    for (ptrdiff_t r = n - 1; r >= 0; r--) {
        const double *restrict row = band + r * stride + width - r;
        const double value = b[r] / row[r];
        b[r] = value;
        for (ptrdiff_t k = r > width ? r - width : 0; k < r; k++)
            b[k] -= row[k] * value;
    }
}

/* Sᵀ gradient, (mi, mj) to the unknowns of coordinate c; `values` holds ROWS mj floats. */
MESHONET_CLONES
void space_restrict(const Space *s, const double *restrict gradient, ptrdiff_t mi, ptrdiff_t mj, int c,
                    float *restrict values, double *restrict unknowns)
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
    for (ptrdiff_t l = 0; l < s->mi; l++)
        for (ptrdiff_t k = 0; k < s->mj; k++)
            unknowns[2 * (l * s->mj + k) + c] = (double)found[l][k];
}

/* result += S unknowns of coordinate c. */
MESHONET_INLINE void from_space(const Space *s, const double *restrict unknowns, ptrdiff_t mi, ptrdiff_t mj, int c,
                                float *restrict result)
{
    float total[SPACE][SPACE];
    memset(total, 0, sizeof total);
    for (ptrdiff_t l = 0; l < s->mi; l++)
        for (ptrdiff_t k = 0; k < s->mj; k++)
            total[l][k] = (float)unknowns[2 * (l * s->mj + k) + c];
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
#endif
