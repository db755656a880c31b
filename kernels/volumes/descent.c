/* Descent of the functional in space: L-BFGS (energy/steps.c) with the preconditioner D M⁻¹ D.

   M is about the Hessian on a uniform grid of box cells, (2 / cells) Σ_d λ_d / L_d² (3/2 + β Σ_e (n_e - 1)² λ_e),
   λ = 4 sin²(π m / 2n), diagonal after sine transforms along all three directions, which are products with their
   matrices in single precision. D, at most 1, is the root of M's diagonal over the stiffness where nodes are. */
#include "descent.h"
#include "clones.h"
#include "energy/panel.h"
#include "team.h"
#include <math.h>
#include <string.h>

#define CLOSER 0.4 /* part of the smallest Jacobian that a step may leave */

static ptrdiff_t whole_panels(ptrdiff_t n)
{
    return (n + PANEL - 1) / PANEL * PANEL;
}

static size_t panel_floats(const Descent3 *d)
{
    const ptrdiff_t longest = d->m[0] > d->m[1] ? d->m[0] : d->m[1];
    return (size_t)(3 * PANEL * longest);
}

void descent3_sizes(Descent3 *d, size_t *doubles, size_t *floats)
{
    d->m[0] = d->f.n1 - 2, d->m[1] = d->f.n2 - 2, d->m[2] = d->f.n3 - 2, d->pitch = whole_panels(d->m[2]);
    const ptrdiff_t nodes = d->f.n1 * d->f.n2 * d->f.n3, inner = d->m[0] * d->m[1] * d->m[2];
    *doubles = 6 * (size_t)nodes + 6 * (size_t)inner + volume_energy_room(&d->f);
    *floats = 2 * (size_t)inner + 2 * (size_t)(d->m[0] * d->m[1] * d->pitch) + steps_floats(3 * inner) +
              (size_t)d->f.threads * panel_floats(d) + (size_t)(d->m[2] * d->pitch);
    for (int e = 0; e < 3; e++)
        *floats += (size_t)(d->m[e] * d->m[e] + whole_panels(d->m[e]));
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

void descent3_place(Descent3 *d, double *doubles, float *floats)
{
    const ptrdiff_t nodes = d->f.n1 * d->f.n2 * d->f.n3, inner = d->m[0] * d->m[1] * d->m[2];
    d->trial = doubles, d->g = doubles + 3 * nodes, d->room = d->g + 3 * nodes + 6 * inner;
    d->scale = floats, d->sizes = floats + inner, d->w = floats + 2 * inner;
    d->v = d->w + d->m[0] * d->m[1] * d->pitch, d->packed = d->v + d->m[0] * d->m[1] * d->pitch;
    float *next = d->packed + d->m[2] * d->pitch;
    for (int e = 0; e < 3; e++) {
        d->sines[e] = next, d->eigen[e] = next + d->m[e] * d->m[e];
        next = d->eigen[e] + whole_panels(d->m[e]);
        sine_transform(d->m[e], d->sines[e], d->eigen[e]);
    }
    memset(d->packed, 0, (size_t)(d->m[2] * d->pitch) * sizeof *d->packed);
    for (ptrdiff_t l = 0; l < d->m[2]; l++)
        for (ptrdiff_t k = 0; k < d->m[2]; k++)
            d->packed[k / PANEL * PANEL * d->m[2] + l * PANEL + k % PANEL] = d->sines[2][l * d->m[2] + k];
    d->panels = next;
    steps_place(&d->steps, 3 * inner, d->g + 3 * nodes, d->g + 3 * nodes + 3 * inner,
                next + (size_t)d->f.threads * panel_floats(d));
}

/* ---- the preconditioner ---- */

typedef struct {
    const Descent3 *d;
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
static void along_eta(const Descent3 *d, const float *from, float *to, float *panel)
{
    for (ptrdiff_t k = 0; k < d->pitch; k += PANEL) {
        for (ptrdiff_t j = 0; j < d->m[1]; j++)
            memcpy(panel + j * PANEL, from + j * d->pitch + k, PANEL * sizeof *panel);
        spectral_panel(d->sines[1], d->m[1], panel, to + k, d->pitch, d->m[1], d->m[1], 0);
    }
}

/* Rows along zeta times their transform. */
static void along_zeta(const Descent3 *d, const float *from, float *to)
{
    for (ptrdiff_t k = 0; k < d->pitch; k += PANEL)
        spectral_panel(from, d->pitch, d->packed + k * d->m[2], to + k, d->pitch, d->m[1], d->m[2], 0);
}

/* A panel of modes over M's symbol; its rows are along xi, its columns those from k on of row j. */
MESHONET_CLONES
static void divide(const Descent3 *d, ptrdiff_t j, ptrdiff_t k, float *panel)
{
    const Functional3 *f = &d->f;
    const float cells = 0.5f * (float)(f->n1 - 1) * (float)(f->n2 - 1) * (float)(f->n3 - 1);
    const float b = (float)f->smoothness, *restrict third = d->eigen[2] + k;
    const float by[3] = {(float)(f->over[0] * f->over[0]), (float)(f->over[1] * f->over[1]),
                         (float)(f->over[2] * f->over[2])};
    const float n[3] = {b * (float)((f->n1 - 1) * (f->n1 - 1)), b * (float)((f->n2 - 1) * (f->n2 - 1)),
                        b * (float)((f->n3 - 1) * (f->n3 - 1))};
    for (ptrdiff_t i = 0; i < d->m[0]; i++) {
        const float p = d->eigen[0][i], q = d->eigen[1][j];
        const float sum = by[0] * p + by[1] * q, smooth = 1.5f + n[0] * p + n[1] * q;
        float *restrict row = panel + i * PANEL;
        for (ptrdiff_t l = 0; l < PANEL; l++)
            row[l] *= cells / ((sum + by[2] * third[l]) * (smooth + n[2] * third[l]));
    }
}

/* Along xi there and back, with the division between. */
static void along_xi(const Descent3 *d, float *w, ptrdiff_t j, ptrdiff_t k, float *panel)
{
    const ptrdiff_t m = d->m[0], stride = d->m[1] * d->pitch;
    float *modes = panel + m * PANEL, *at = w + j * d->pitch + k;
    for (ptrdiff_t i = 0; i < m; i++)
        memcpy(panel + i * PANEL, at + i * stride, PANEL * sizeof *panel);
    spectral_panel(d->sines[0], m, panel, modes, PANEL, m, m, 0);
    divide(d, j, k, modes);
    spectral_panel(d->sines[0], m, modes, panel, PANEL, m, m, 0);
    for (ptrdiff_t i = 0; i < m; i++)
        memcpy(at + i * stride, panel + i * PANEL, PANEL * sizeof *panel);
}

static void precondition_share(void *data, Member member)
{
    const Division *p = data;
    const Descent3 *d = p->d;
    const ptrdiff_t *m = d->m, inner = m[0] * m[1] * m[2], plane = m[1] * d->pitch, columns = plane / PANEL;
    float *panel = d->panels + (size_t)member.rank * panel_floats(d);
    ptrdiff_t first, last, start, stop;
    team_share(m[0], member, &first, &last);
    team_share(columns, member, &start, &stop);
    for (int c = 0; c < 3; c++) {
        for (ptrdiff_t i = first; i < last; i++) {
            float *w = d->w + i * plane, *v = d->v + i * plane;
            for (ptrdiff_t j = 0; j < m[1]; j++) {
                const ptrdiff_t at = (i * m[1] + j) * m[2];
                scaled_row(p->gradient + c * inner + at, d->scale + at, m[2], d->pitch, w + j * d->pitch);
            }
            along_zeta(d, w, v);
            along_eta(d, v, w, panel);
        }
        team_wait(member);
        for (ptrdiff_t column = start; column < stop; column++)
            along_xi(d, d->w, column * PANEL / d->pitch, column * PANEL % d->pitch, panel);
        team_wait(member);
        for (ptrdiff_t i = first; i < last; i++) {
            float *w = d->w + i * plane, *v = d->v + i * plane;
            along_eta(d, w, v, panel);
            along_zeta(d, v, w);
            for (ptrdiff_t j = 0; j < m[1]; j++) {
                const ptrdiff_t at = (i * m[1] + j) * m[2];
                unscaled_row(w + j * d->pitch, d->scale + at, m[2], p->result + c * inner + at);
            }
        }
    }
}

static void precondition(void *problem, const double *gradient, float *result)
{
    Descent3 *d = problem;
    Division division = {d, gradient, result};
    team_run(d->f.threads, precondition_share, &division);
}

/* D and the sizes of cells for a row of inner nodes. */
MESHONET_CLONES
static void scale_row(const Descent3 *d, double diagonal, const double *x, const double *h, ptrdiff_t at, ptrdiff_t to)
{
    const ptrdiff_t nodes = d->f.n1 * d->f.n2 * d->f.n3, next[3] = {d->f.n2 * d->f.n3, d->f.n3, 1};
    float *restrict scale = d->scale + to, *restrict sizes = d->sizes + to;
    for (ptrdiff_t k = 0; k < d->m[2]; k++) {
        const double ratio = sqrt(diagonal / h[at + k]);
        scale[k] = ratio < 1.0 ? (float)ratio : 1.0f;
        sizes[k] = 1e30f;
    }
    for (int e = 0; e < 3; e++)
        for (ptrdiff_t k = 0; k < d->m[2]; k++) {
            double sum = 0.0;
            for (int c = 0; c < 3; c++) {
                const double *p = x + c * nodes + at + k, step = 0.5 * (p[next[e]] - p[-next[e]]);
                sum += step * step;
            }
            sizes[k] = (float)sum < sizes[k] ? (float)sum : sizes[k];
        }
}

void descent3_renew(Descent3 *d)
{
    const Functional3 *f = &d->f;
    double diagonal = 0.0;
    volume_stiffness(f, d->x, d->g, d->room);
    for (int e = 0; e < 3; e++)
        diagonal += (f->power == SHAPES ? 2.0 : 12.0) * f->over[e] * f->over[e];
    diagonal /= (double)(f->n1 - 1) * (double)(f->n2 - 1) * (double)(f->n3 - 1);
    for (ptrdiff_t i = 0; i < d->m[0]; i++)
        for (ptrdiff_t j = 0; j < d->m[1]; j++)
            scale_row(d, diagonal, d->x, d->g, ((i + 1) * f->n2 + j + 1) * f->n3 + 1, (i * d->m[1] + j) * d->m[2]);
}

/* ---- what the steps ask for ---- */

/* Of a row of inner nodes: its place among all nodes. */
MESHONET_INLINE ptrdiff_t place_of(const Descent3 *d, ptrdiff_t i, ptrdiff_t j)
{
    return ((i + 1) * d->f.n2 + j + 1) * d->f.n3 + 1;
}

/* Copies between all nodes and inner ones, by rows of inner nodes. */
typedef struct {
    Descent3 *d;
    double factor;
    void (*row)(Descent3 *d, double factor, ptrdiff_t from, ptrdiff_t to);
} Copies;

static void copy_share(void *data, Member member)
{
    const Copies *copies = data;
    Descent3 *d = copies->d;
    const ptrdiff_t nodes = d->f.n1 * d->f.n2 * d->f.n3, inner = d->m[0] * d->m[1] * d->m[2];
    ptrdiff_t first, last;
    team_share(d->m[0], member, &first, &last);
    for (ptrdiff_t c = 0; c < 3; c++)
        for (ptrdiff_t i = first; i < last; i++)
            for (ptrdiff_t j = 0; j < d->m[1]; j++)
                copies->row(d, copies->factor, c * inner + (i * d->m[1] + j) * d->m[2], c * nodes + place_of(d, i, j));
}

static void copy_rows(Descent3 *d, double factor, void (*row)(Descent3 *, double, ptrdiff_t, ptrdiff_t))
{
    Copies copies = {d, factor, row};
    team_run(d->f.threads, copy_share, &copies);
}

MESHONET_CLONES
static void moved_row(Descent3 *d, double factor, ptrdiff_t from, ptrdiff_t to)
{
    const float *restrict step = d->steps.direction + from;
    const double *restrict x = d->x + to;
    double *restrict trial = d->trial + to;
    for (ptrdiff_t k = 0; k < d->m[2]; k++)
        trial[k] = x[k] + factor * (double)step[k];
}

static void gradient_row(Descent3 *d, double factor, ptrdiff_t to, ptrdiff_t from)
{
    (void)factor;
    memcpy(d->steps.fresh + to, d->g + from, (size_t)d->m[2] * sizeof *d->g);
}

static void kept_row(Descent3 *d, double factor, ptrdiff_t from, ptrdiff_t to)
{
    (void)factor, (void)from;
    memcpy(d->x + to, d->trial + to, (size_t)d->m[2] * sizeof *d->x);
}

static double attempt(void *problem, double factor, double *smallest)
{
    Descent3 *d = problem;
    if (factor > 0.0)
        copy_rows(d, factor, moved_row);
    const double value = volume_energy(&d->f, factor > 0.0 ? d->trial : d->x, d->g, smallest, d->room);
    if (factor > 0.0 && !(d->f.epsilon > 0.0) && *smallest < CLOSER * d->steps.smallest)
        return INFINITY; /* a node this near the barrier would hold up all steps that follow */
    copy_rows(d, 0.0, gradient_row);
    return value;
}

static void keep(void *problem)
{
    copy_rows(problem, 0.0, kept_row);
}

/* In cells. */
MESHONET_CLONES
static double largest_move(void *problem)
{
    const Descent3 *d = problem;
    const ptrdiff_t n = d->m[0] * d->m[1] * d->m[2];
    const float *restrict x = d->steps.direction, *restrict y = x + n, *restrict z = y + n, *restrict sizes = d->sizes;
    float most = 0.0f;
    for (ptrdiff_t k = 0; k < n; k++) {
        const float moved = (x[k] * x[k] + y[k] * y[k] + z[k] * z[k]) / (sizes[k] + 1e-36f);
        most = moved > most ? moved : most;
    }
    return sqrt((double)most);
}

void descent3_start(Descent3 *d)
{
    Steps *s = &d->steps;
    s->problem = d, s->attempt = attempt, s->keep = keep, s->precondition = precondition;
    s->largest_move = largest_move;
    memcpy(d->trial, d->x, 3 * (size_t)(d->f.n1 * d->f.n2 * d->f.n3) * sizeof *d->trial); /* nodes that never move */
    descent3_renew(d);
    steps_start(s);
}

int descent3_take(Descent3 *d)
{
    return steps_take(&d->steps);
}
