#include "spectrum.h"
#include "clones.h"
#include "energy/panel.h"
#include <math.h>
#include <string.h>

static ptrdiff_t whole_panels(ptrdiff_t n)
{
    return (n + PANEL - 1) / PANEL * PANEL;
}

static size_t panel_floats(const Spectrum3 *s)
{
    const ptrdiff_t longest = s->m[0] > s->m[1] ? s->m[0] : s->m[1];
    return (size_t)(3 * PANEL * longest);
}

size_t spectrum3_floats(const Spectrum3 *s)
{
    const ptrdiff_t *m = s->m, pitch = whole_panels(m[2]);
    ptrdiff_t count = m[0] * m[1] * m[2] + 2 * m[0] * m[1] * pitch + m[2] * pitch;
    for (int e = 0; e < 3; e++)
        count += m[e] * m[e] + whole_panels(m[e]);
    return m[0] == 0 ? 0 : (size_t)count + (size_t)s->threads * panel_floats(s);
}

/* √(2/n) sin(π (a + 1)(b + 1) / n), and the eigenvalues of the second difference. */
static void sine_transform(ptrdiff_t m, float *sines, float *eigen)
{
    const double step = 3.14159265358979323846 / (double)(m + 1), unit = sqrt(2.0 / (double)(m + 1));
    for (ptrdiff_t a = 0; a < m; a++) {
        const double half = sin(0.5 * step * (double)(a + 1));
        eigen[a] = (float)(4.0 * half * half);
        for (ptrdiff_t b = 0; b < m; b++)
            sines[a * m + b] = (float)(unit * sin(step * (double)((a + 1) * (b + 1) % (2 * m + 2))));
    }
    for (ptrdiff_t a = m; a < whole_panels(m); a++)
        eigen[a] = 4.0f;
}

void spectrum3_place(Spectrum3 *s, float *floats)
{
    const ptrdiff_t *m = s->m;
    if (m[0] == 0)
        return;
    s->pitch = whole_panels(m[2]);
    s->scale = floats, s->w = floats + m[0] * m[1] * m[2];
    s->v = s->w + m[0] * m[1] * s->pitch, s->packed = s->v + m[0] * m[1] * s->pitch;
    float *next = s->packed + m[2] * s->pitch;
    for (int e = 0; e < 3; e++) {
        s->sines[e] = next, s->eigen[e] = next + m[e] * m[e];
        next = s->eigen[e] + whole_panels(m[e]);
        sine_transform(m[e], s->sines[e], s->eigen[e]);
    }
    memset(s->packed, 0, (size_t)(m[2] * s->pitch) * sizeof *s->packed);
    for (ptrdiff_t l = 0; l < m[2]; l++)
        for (ptrdiff_t k = 0; k < m[2]; k++)
            s->packed[k / PANEL * PANEL * m[2] + l * PANEL + k % PANEL] = s->sines[2][l * m[2] + k];
    s->panels = next;
}

typedef struct {
    const Spectrum3 *s;
    const double *gradient;
    float *result;
} Division;

/* One coordinate of a row of inner nodes, times D, into a padded row. */
MESHONET_CLONES
static void scaled_row(const double *restrict gradient, const float *restrict scale, ptrdiff_t n, ptrdiff_t pitch,
                       float *restrict to)
{
    for (ptrdiff_t k = 0; k < n; k++)
        to[k] = scale[k] * (float)gradient[k];
    for (ptrdiff_t k = n; k < pitch; k++)
        to[k] = 0.0f;
}

MESHONET_CLONES
static void unscaled_row(const float *restrict from, const float *restrict scale, ptrdiff_t n, float *restrict to)
{
    for (ptrdiff_t k = 0; k < n; k++)
        to[k] = scale[k] * from[k];
}

/* c = S c along eta for a plane, panel by panel; `panel` holds m2 PANEL floats. */
static void along_eta(const Spectrum3 *s, const float *from, float *to, float *panel)
{
    for (ptrdiff_t k = 0; k < s->pitch; k += PANEL) {
        for (ptrdiff_t j = 0; j < s->m[1]; j++)
            memcpy(panel + j * PANEL, from + j * s->pitch + k, PANEL * sizeof *panel);
        spectral_panel(s->sines[1], s->m[1], panel, to + k, s->pitch, s->m[1], s->m[1], 0);
    }
}

/* Rows along zeta times their transform. */
static void along_zeta(const Spectrum3 *s, const float *from, float *to)
{
    for (ptrdiff_t k = 0; k < s->pitch; k += PANEL)
        spectral_panel(from, s->pitch, s->packed + k * s->m[2], to + k, s->pitch, s->m[1], s->m[2], 0);
}

/* Divide a panel of modes, rows along xi, columns from k on of row j, by the symbol of M. */
MESHONET_CLONES
static void divide(const Spectrum3 *s, ptrdiff_t j, ptrdiff_t k, float *panel)
{
    const HexWeights *w = &s->weights;
    const float cells = 0.5f * (float)w->cells, *restrict third = s->eigen[2] + k;
    const float bend = (float)(w->smoothness * cbrt(w->cells) * cbrt(w->cells));
    const float by[3] = {(float)(s->over[0] * s->over[0]), (float)(s->over[1] * s->over[1]),
                         (float)(s->over[2] * s->over[2])};
    for (ptrdiff_t i = 0; i < s->m[0]; i++) {
        const float p = s->eigen[0][i], q = s->eigen[1][j];
        const float sum = by[0] * p + by[1] * q, smooth = 1.5f + bend * (p + q);
        float *restrict row = panel + i * PANEL;
        for (ptrdiff_t l = 0; l < PANEL; l++)
            row[l] *= cells / ((sum + by[2] * third[l]) * (smooth + bend * third[l]));
    }
}

/* Transform along xi, divide, and transform back. */
static void along_xi(const Spectrum3 *s, float *w, ptrdiff_t j, ptrdiff_t k, float *panel)
{
    const ptrdiff_t m = s->m[0], stride = s->m[1] * s->pitch;
    float *modes = panel + m * PANEL, *at = w + j * s->pitch + k;
    for (ptrdiff_t i = 0; i < m; i++)
        memcpy(panel + i * PANEL, at + i * stride, PANEL * sizeof *panel);
    spectral_panel(s->sines[0], m, panel, modes, PANEL, m, m, 0);
    divide(s, j, k, modes);
    spectral_panel(s->sines[0], m, modes, panel, PANEL, m, m, 0);
    for (ptrdiff_t i = 0; i < m; i++)
        memcpy(at + i * stride, panel + i * PANEL, PANEL * sizeof *panel);
}

static void divide_share(void *data, Member member)
{
    const Division *p = data;
    const Spectrum3 *s = p->s;
    const ptrdiff_t *m = s->m, inner = m[0] * m[1] * m[2], plane = m[1] * s->pitch, columns = plane / PANEL;
    float *panel = s->panels + (size_t)member.rank * panel_floats(s);
    const Range mine = team_share(m[0], member), stacks = team_share(columns, member);
    for (int c = 0; c < 3; c++) {
        for (ptrdiff_t i = mine.first; i < mine.last; i++) {
            float *w = s->w + i * plane, *v = s->v + i * plane;
            for (ptrdiff_t j = 0; j < m[1]; j++) {
                const ptrdiff_t at = (i * m[1] + j) * m[2];
                scaled_row(p->gradient + c * inner + at, s->scale + at, m[2], s->pitch, w + j * s->pitch);
            }
            along_zeta(s, w, v);
            along_eta(s, v, w, panel);
        }
        team_wait(member);
        for (ptrdiff_t column = stacks.first; column < stacks.last; column++)
            along_xi(s, s->w, column * PANEL / s->pitch, column * PANEL % s->pitch, panel);
        team_wait(member);
        for (ptrdiff_t i = mine.first; i < mine.last; i++) {
            float *w = s->w + i * plane, *v = s->v + i * plane;
            along_eta(s, w, v, panel);
            along_zeta(s, v, w);
            for (ptrdiff_t j = 0; j < m[1]; j++) {
                const ptrdiff_t at = (i * m[1] + j) * m[2];
                unscaled_row(w + j * s->pitch, s->scale + at, m[2], p->result + c * inner + at);
            }
        }
    }
}

void spectrum3_divide(const Spectrum3 *s, const double *gradient, float *result)
{
    Division division = {s, gradient, result};
    team_run(s->threads, divide_share, &division);
}

void spectrum3_renew(Spectrum3 *s, const HexWeights *weights, const double *stiffness)
{
    double diagonal = 0.0;
    s->weights = *weights;
    for (int e = 0; e < 3; e++)
        diagonal += (weights->power == SHAPES ? 2.0 : 12.0) * s->over[e] * s->over[e] / weights->cells;
    for (ptrdiff_t k = 0; k < s->m[0] * s->m[1] * s->m[2]; k++) {
        const double ratio = sqrt(diagonal / stiffness[k]);
        s->scale[k] = ratio < 1.0 ? (float)ratio : 1.0f;
    }
}
