/* The inverse of the functional's Hessian on a uniform grid, in the frame of each node, in single precision.

   Displacements are c w with c the step along xi. For w the Hessian is about that of unit squares, diagonalised by
   transforms: d = c Q_i (scale · (Q_iᵀ (conj(c) g) Q_j)) Q_jᵀ; modes that are left out are divided by `rest`. Modes are
   even or odd about the middle: halves (v(k) ± v(-k)) / √2 have their own. */
#pragma once
#include "clones.h"
#include "panel.h"
#include "team.h"
#include "variational.h"
#include <string.h>

#define LANES 16 /* floats of a vector register, at the most */
#define VECTORS (PANEL / LANES)
#define ROWS 12   /* of a product at a time: as many sums as registers hold */
#define DEPTH 192 /* terms of a sum at a time: their panel stays in the first cache */
#define FOLDED 0.70710678f

typedef float Lanes __attribute__((vector_size(64), aligned(4), may_alias));

/* `rows` (ROWS at the most) rows of c = a b, or of c += a b with `add`, one panel; b packed (k, PANEL), c with room for
   whole panels. */
MESHONET_INLINE void product_rows(const float *restrict a, ptrdiff_t stride, const float *restrict b, ptrdiff_t k,
                                  float *restrict c, ptrdiff_t c_stride, const int rows, int add)
{
    Lanes sum[ROWS][VECTORS];
    memset(sum, 0, sizeof sum);
    if (add)
        for (int r = 0; r < rows; r++)
            memcpy(sum[r], c + r * c_stride, sizeof sum[r]);
    for (ptrdiff_t l = 0; l < k; l++) {
        const Lanes *line = (const Lanes *)(b + l * PANEL);
        for (int r = 0; r < rows; r++)
            for (int v = 0; v < VECTORS; v++)
                sum[r][v] += a[r * stride + l] * line[v];
    }
    for (int r = 0; r < rows; r++)
        memcpy(c + r * c_stride, sum[r], sizeof sum[r]);
}

/* One panel of `product`. */
MESHONET_CLONES
void spectral_panel(const float *a, ptrdiff_t a_stride, const float *packed, float *c,
                                   ptrdiff_t c_stride, ptrdiff_t m, ptrdiff_t k, int add)
{
    ptrdiff_t i = 0;
    for (; i + ROWS <= m; i += ROWS)
        product_rows(a + i * a_stride, a_stride, packed, k, c + i * c_stride, c_stride, ROWS, add);
    for (; i + 3 <= m; i += 3)
        product_rows(a + i * a_stride, a_stride, packed, k, c + i * c_stride, c_stride, 3, add);
    for (; i < m; i++)
        product_rows(a + i * a_stride, a_stride, packed, k, c + i * c_stride, c_stride, 1, add);
}

/* c (m, n) = a (m, k) b (k, n), rows of n rounded up to whole panels; `packed` holds DEPTH PANEL floats. */
static void product(const float *a, ptrdiff_t a_stride, const float *b, ptrdiff_t b_stride, float *c,
                             ptrdiff_t c_stride, ptrdiff_t m, ptrdiff_t k, ptrdiff_t n, float *packed)
{
    for (ptrdiff_t j = 0; j < n; j += PANEL)
        for (ptrdiff_t start = 0; start == 0 || start < k; start += DEPTH) {
            const ptrdiff_t depth = k - start < DEPTH ? k - start : DEPTH;
            for (ptrdiff_t l = 0; l < depth; l++)
                memcpy(packed + l * PANEL, b + (start + l) * b_stride + j, PANEL * sizeof(float));
            spectral_panel(a + start, a_stride, packed, c + j, c_stride, m, depth, start > 0);
        }
}

MESHONET_INLINE ptrdiff_t padded(ptrdiff_t n) { return (n + PANEL - 1) / PANEL * PANEL; }

/* A folded row of values, or of modes: the even half and the odd one, each in whole panels. */
MESHONET_INLINE ptrdiff_t values_of(const Transform *t) { return padded(t->even.nodes) + padded(t->odd.nodes); }
MESHONET_INLINE ptrdiff_t modes_of(const Transform *t) { return padded(t->even.modes) + padded(t->odd.modes); }

/* The row v of n values, folded. */
MESHONET_INLINE void fold(const float *restrict v, const Transform *t, float *restrict folded)
{
    const ptrdiff_t n = t->even.nodes + t->odd.nodes, half = t->odd.nodes, start = padded(t->even.nodes);
    float *restrict odd = folded + start;
    for (ptrdiff_t k = 0; k < half; k++) {
        folded[k] = FOLDED * (v[k] + v[n - 1 - k]);
        odd[k] = FOLDED * (v[k] - v[n - 1 - k]);
    }
    if (t->even.nodes > half)
        folded[half] = v[half];
    for (ptrdiff_t k = t->even.nodes; k < start; k++)
        folded[k] = 0.0f;
    for (ptrdiff_t k = half; k < padded(half); k++)
        odd[k] = 0.0f;
}

MESHONET_INLINE void unfold(const float *restrict folded, const Transform *t, float *restrict v)
{
    const ptrdiff_t n = t->even.nodes + t->odd.nodes, half = t->odd.nodes;
    const float *restrict odd = folded + padded(t->even.nodes);
    for (ptrdiff_t k = 0; k < half; k++) {
        v[k] = FOLDED * (folded[k] + odd[k]);
        v[n - 1 - k] = FOLDED * (folded[k] - odd[k]);
    }
    if (t->even.nodes > half)
        v[half] = folded[half];
}

/* Of two rows the sum and the difference over √2, in place. */
MESHONET_INLINE void mix(float *restrict a, float *restrict b, ptrdiff_t n)
{
    for (ptrdiff_t k = 0; k < n; k++) {
        const float sum = FOLDED * (a[k] + b[k]), difference = FOLDED * (a[k] - b[k]);
        a[k] = sum, b[k] = difference;
    }
}

/* `rows` rows times the modes of both halves, or back. */
static void along_rows(const float *w, const Transform *t, float *to, ptrdiff_t rows, int back, float *packed)
{
    const ptrdiff_t nodes = values_of(t), modes = modes_of(t);
    for (int odd = 0; odd < 2; odd++) {
        const Half *h = odd ? &t->odd : &t->even;
        const ptrdiff_t n = padded(h->nodes), m = padded(h->modes);
        if (back)
            product(w, modes, h->q_t, n, to, nodes, rows, h->modes, h->nodes, packed);
        else
            product(w, nodes, h->q, m, to, modes, rows, h->nodes, h->modes, packed);
        w += back ? m : n, to += back ? n : m;
    }
}

/* Divide the transforms along eta, planes (2, mi, width), by the symbol: columns `first` to before `last`. */
static void divide_columns(const Spectrum *s, float *right, float *both, ptrdiff_t first, ptrdiff_t last, float *packed)
{
    const ptrdiff_t mi = s->mi, width = modes_of(&s->eta), n = last - first;
    const float *scale = s->scale + first;
    for (int c = 0; c < 2; c++) {
        float *rows = right + c * mi * width + first;
        for (int odd = 0; odd < 2; odd++) {
            const Half *h = odd ? &s->xi.odd : &s->xi.even;
            product(h->q_t, padded(h->nodes), rows, width, both + first, width, h->modes, h->nodes, n, packed);
            for (ptrdiff_t k = 0; k < h->modes; k++)
                for (ptrdiff_t j = 0; j < n; j++)
                    both[k * width + first + j] *= scale[k * width + j];
            product(h->q, padded(h->modes), both + first, width, rows, width, h->nodes, h->modes, n, packed);
            scale += h->modes * width, rows += h->nodes * width;
        }
    }
}

/* Replace the folded planes w (2, mi, values of eta) by what they are divided by the symbol, as one of a team. */
static void divide(const Spectrum *s, float *restrict w, float *restrict spare, float *packed, Member member)
{
    const ptrdiff_t mi = s->mi, width = modes_of(&s->eta), nodes = values_of(&s->eta);
    float *restrict right = spare, *restrict both = spare + 2 * mi * (width > nodes ? width : nodes);
    const Range groups = team_share((2 * mi + ROWS - 1) / ROWS, member), panels = team_share(width / PANEL, member);
    const ptrdiff_t first = groups.first * ROWS, last = groups.last * ROWS < 2 * mi ? groups.last * ROWS : 2 * mi;
    along_rows(w + first * nodes, &s->eta, right + first * width, last - first, 0, packed);
    team_wait(member);
    divide_columns(s, right, both, PANEL * panels.first, PANEL * panels.last, packed);
    team_wait(member);
    const ptrdiff_t start = first * nodes, end = last * nodes;
    if (s->rest > 0.0f) { /* some modes are left out: rest (w - Q Qᵀ w), the second part in the scale already */
        along_rows(right + first * width, &s->eta, both + start, last - first, 1, packed);
        for (ptrdiff_t r = start; r < end; r += nodes)
            for (ptrdiff_t k = r; k < r + nodes; k++)
                w[k] = s->rest * w[k] + both[k];
    } else {
        along_rows(right + first * width, &s->eta, w + start, last - first, 1, packed);
    }
}
