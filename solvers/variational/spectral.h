/* The inverse of the functional's Hessian on a uniform grid, in the frame of each node.

   Moves of the nodes, as complex numbers, are c w with c the step along xi at the node, so that w is free of the size
   and the turn of cells. For w the Hessian is about that of a grid of unit squares, which transforms along both
   directions make diagonal: d = c Q_i (scale · (Q_iᵀ (conj(c) g) Q_j)) Q_jᵀ, with scales of their own along xi and eta. Modes that the transforms
   leave out are divided by `rest`. Single precision is enough here. */
#ifndef MESHONET_SPECTRAL_H
#define MESHONET_SPECTRAL_H
#include "clones.h"
#include "variational_kernel.h"
#include <string.h>

#define PANEL 32 /* columns of a product at a time: two vectors of 512 bits */

#if defined(__GNUC__)
typedef float Lanes __attribute__((vector_size(64), aligned(4)));
#define LANES 16
#else
typedef float Lanes;
#define LANES 1
#endif
#define VECTORS (PANEL / LANES)

/* `rows` (4 at the most) rows of c = a b, one panel; b packed (k, PANEL), c with room for whole panels. */
MESHONET_INLINE void product_rows(const float *restrict a, ptrdiff_t stride, const float *restrict b, ptrdiff_t k,
                                  float *restrict c, ptrdiff_t c_stride, const int rows)
{
    Lanes sum[4][VECTORS];
    memset(sum, 0, sizeof sum);
    for (ptrdiff_t l = 0; l < k; l++) {
        const Lanes *line = (const Lanes *)(b + l * PANEL);
        for (int r = 0; r < rows; r++)
            for (int v = 0; v < VECTORS; v++)
                sum[r][v] += a[r * stride + l] * line[v];
    }
    for (int r = 0; r < rows; r++)
        memcpy(c + r * c_stride, sum[r], sizeof sum[r]);
}

/* c (m, n) = a (m, k) b (k, n), rows of n rounded up to whole panels; `packed` holds k PANEL floats. */
MESHONET_INLINE void product(const float *a, ptrdiff_t a_stride, const float *b, ptrdiff_t b_stride, float *c,
                             ptrdiff_t c_stride, ptrdiff_t m, ptrdiff_t k, ptrdiff_t n, float *packed)
{
    for (ptrdiff_t j = 0; j < n; j += PANEL) {
        for (ptrdiff_t l = 0; l < k; l++)
            memcpy(packed + l * PANEL, b + l * b_stride + j, PANEL * sizeof(float));
        ptrdiff_t i = 0;
        for (; i + 4 <= m; i += 4)
            product_rows(a + i * a_stride, a_stride, packed, k, c + i * c_stride + j, c_stride, 4);
        for (; i < m; i++)
            product_rows(a + i * a_stride, a_stride, packed, k, c + i * c_stride + j, c_stride, 1);
    }
}

MESHONET_INLINE ptrdiff_t padded(ptrdiff_t n) { return (n + PANEL - 1) / PANEL * PANEL; }

/* Replace the planes w (2, mi, nj) by what they are divided by the symbol; nj and kj are padded. */
MESHONET_INLINE void divide(const Spectrum *s, float *restrict w, float *restrict spare, float *packed)
{
    const ptrdiff_t mi = s->mi, mj = s->mj, ki = s->ki, kj = s->kj, nj = padded(mj), lj = padded(kj);
    float *restrict right = spare, *restrict both = spare + 2 * mi * lj;
    product(w, nj, s->q_j, lj, right, lj, 2 * mi, mj, kj, packed);
    for (int c = 0; c < 2; c++) {
        float *restrict from = right + c * mi * lj;
        product(s->q_i_t, mi, from, lj, both, lj, ki, mi, kj, packed);
        for (ptrdiff_t k = 0; k < ki; k++)
            for (ptrdiff_t l = 0; l < kj; l++)
                both[k * lj + l] *= s->scale[(c * ki + k) * kj + l];
        product(s->q_i, ki, both, lj, from, lj, mi, ki, kj, packed);
    }
    if (s->rest > 0.0f) { /* some modes are left out: rest (w - Q Qᵀ w), the second part in the scale already */
        float *restrict kept = both;
        product(right, lj, s->q_j_t, nj, kept, nj, 2 * mi, kj, mj, packed);
        for (ptrdiff_t k = 0; k < 2 * mi * nj; k++)
            w[k] = s->rest * w[k] + kept[k];
        return;
    }
    product(right, lj, s->q_j_t, nj, w, nj, 2 * mi, kj, mj, packed);
}
#endif
