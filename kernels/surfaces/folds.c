/* Cells between the lines of a march. A cell's map is trilinear; its Jacobian has 27 Bezier coefficients
       B_pqr = sum over a + a' = p, b + b' = q, c + c' = r of w_p w_q w_r det(U_bc, V_ac', W_a'b'),  w = 1, 1/2, 1,
   with U, V, W its edges along i, j, k. Those of even p, q, r are the corners' Jacobians; where all are positive, the
   Jacobian is so everywhere. Eight cells of a column are tested together. */
#include "folds.h"
#include "clones.h"
#include "lanes.h"
#include "team.h"
#include <math.h>
#include <string.h>

typedef struct {
    Lanes x, y, z;
} Vectors;

typedef struct {
    double corner[LANES], least[LANES], quality[LANES];
} Tested;

typedef struct {
    const double *lines;
    ptrdiff_t nodes, levels;
    const ptrdiff_t *quads;
    ptrdiff_t count;
    const Folds *folds;
} Work;

MESHONET_INLINE Vectors less(Vectors a, Vectors b) { return (Vectors){a.x - b.x, a.y - b.y, a.z - b.z}; }

MESHONET_INLINE Vectors crossed(Vectors a, Vectors b)
{
    return (Vectors){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

MESHONET_INLINE Lanes dotted(Vectors a, Vectors b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

typedef long long Mask __attribute__((vector_size(LANES * sizeof(long long)), aligned(sizeof(double))));

MESHONET_INLINE Lanes chosen(Mask mask, Lanes a, Lanes b) { return (Lanes)((mask & (Mask)a) | (~mask & (Mask)b)); }

MESHONET_INLINE Lanes smaller(Lanes a, Lanes b) { return chosen(a < b, a, b); }

MESHONET_INLINE Lanes larger(Lanes a, Lanes b) { return chosen(a > b, a, b); }

/* Eight cells from nodes x[a][b], whose coordinates are 9 numbers each, at both levels. */
MESHONET_CLONES
static void test_eight(const double *const *from, Tested *tested)
{
    Vectors x[2][2][2], u[2][2], v[2][2], w[2][2];
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            for (int c = 0; c < 2; c++) {
                const double *const *line = from + 3 * (2 * a + b);
                x[a][b][c] = (Vectors){OF(line[0] + c), OF(line[1] + c), OF(line[2] + c)};
            }
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
            u[a][b] = less(x[1][a][b], x[0][a][b]);
            v[a][b] = less(x[a][1][b], x[a][0][b]);
            w[a][b] = less(x[a][b][1], x[a][b][0]);
        }
    Lanes coefficient[3][3][3], corner, size = {0.0};
    memset(coefficient, 0, sizeof coefficient);
    for (int k = 0; k < 16; k++) { /* V_ac' x W_a'b' */
        const int a = k & 1, c2 = (k >> 1) & 1, a2 = (k >> 2) & 1, b2 = k >> 3;
        const Vectors face = crossed(v[a][c2], w[a2][b2]);
        for (int b = 0; b < 2; b++)
            for (int c = 0; c < 2; c++)
                coefficient[a + a2][b + b2][c + c2] += dotted(u[b][c], face);
    }
    Lanes all = coefficient[0][0][0];
    for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++)
            for (int r = 0; r < 3; r++)
                all = smaller(all, coefficient[p][q][r]);
    Lanes scaled = {0.0}, low = coefficient[0][0][0];
    for (int k = 0; k < 8; k++) {
        const int a = k & 1, b = (k >> 1) & 1, c = k >> 2;
        corner = coefficient[2 * a][2 * b][2 * c];
        const Lanes squares = dotted(u[b][c], u[b][c]) * dotted(v[a][c], v[a][c]) * dotted(w[a][b], w[a][b]);
        const Lanes away = larger(corner, -corner), value = corner * away / squares; /* a signed square */
        scaled = k ? smaller(scaled, value) : value;
        low = smaller(low, corner), size = larger(size, away);
    }
    AT(tested->corner) = scaled, AT(tested->least) = all, AT(tested->quality) = low / size;
}

static void test_column(const Work *work, ptrdiff_t quad)
{
    const ptrdiff_t levels = work->levels, *corners = work->quads + 4 * quad;
    static const int NODE[4] = {0, 3, 1, 2}; /* corner of (a, b) at 2 a + b */
    const Folds *f = work->folds;
    double padded[12][LANES + 1];
    f->corner[quad] = f->quality[quad] = INFINITY;
    f->level[quad] = f->folded[quad] = f->doubtful[quad] = 0;
    for (ptrdiff_t k = 0; k < levels - 1; k += LANES) {
        const double *from[12];
        const ptrdiff_t cells = levels - 1 - k < LANES ? levels - 1 - k : LANES;
        for (int m = 0; m < 12; m++) {
            from[m] = work->lines + ((m % 3) * work->nodes + corners[NODE[m / 3]]) * levels + k;
            if (cells == LANES)
                continue;
            memcpy(padded[m], from[m], (size_t)(cells + 1) * sizeof(double));
            for (ptrdiff_t j = cells + 1; j <= LANES; j++)
                padded[m][j] = 2.0 * padded[m][j - 1] - padded[m][j - 2];
            from[m] = padded[m];
        }
        Tested tested;
        test_eight(from, &tested);
        for (ptrdiff_t j = 0; j < cells; j++) {
            if (!(tested.corner[j] >= f->corner[quad]))
                f->corner[quad] = tested.corner[j], f->level[quad] = k + j;
            if (!(tested.quality[j] >= f->quality[quad]))
                f->quality[quad] = tested.quality[j];
            f->folded[quad] += !(tested.corner[j] > 0.0);
            f->doubtful[quad] += !(tested.least[j] > 0.0);
        }
    }
    f->corner[quad] = copysign(sqrt(fabs(f->corner[quad])), f->corner[quad]);
}

static void run(void *data, Member member)
{
    const Work *work = data;
    ptrdiff_t first, last;
    team_share(work->count, member, &first, &last);
    for (ptrdiff_t quad = first; quad < last; quad++)
        test_column(work, quad);
}

void find_folds(const double *lines, ptrdiff_t nodes, ptrdiff_t levels, const ptrdiff_t *quads, ptrdiff_t count,
                const Folds *folds, int threads)
{
    Work work = {lines, nodes, levels, quads, count, folds};
    team_run(threads, run, &work);
}
