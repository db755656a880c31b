/* Conformal maps in real arithmetic: compilers that have no complex numbers build this too. */

#include "lift.h"

#include <math.h>

#include "clones.h"

static const double PI = 3.14159265358979323846;
static const double SHARP_TURN = 1.3962634015954636;  /* 80 degrees: a first node that turns more is a sharp edge */
static const double CORNER_TURN = 0.26179938779914941; /* 15: one near the edge that turns more is a base's corner */
static const double BASE_REACH = 0.35;   /* how far from the edge, in chords, a corner of the base is looked for */
static const double SECOND_PRONG = 0.25; /* q is so far from p towards the pole: acts gently, still inside */

MESHONET_INLINE Cplx add(Cplx a, Cplx b) { return (Cplx){a.re + b.re, a.im + b.im}; }
MESHONET_INLINE Cplx less(Cplx a, Cplx b) { return (Cplx){a.re - b.re, a.im - b.im}; }
MESHONET_INLINE Cplx scaled(double s, Cplx a) { return (Cplx){s * a.re, s * a.im}; }
MESHONET_INLINE Cplx times(Cplx a, Cplx b) { return (Cplx){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
MESHONET_INLINE Cplx turned_back(Cplx a, Cplx b) /* conj(a) b */
{
    return (Cplx){a.re * b.re + a.im * b.im, a.re * b.im - a.im * b.re};
}
MESHONET_INLINE double size2(Cplx a) { return a.re * a.re + a.im * a.im; }
MESHONET_INLINE double size(Cplx a) { return hypot(a.re, a.im); }
MESHONET_INLINE Cplx over(Cplx a, Cplx b) { return scaled(1.0 / size2(b), turned_back(b, a)); }
MESHONET_INLINE Cplx middle(Cplx a, Cplx b) { return scaled(0.5, add(a, b)); }
MESHONET_INLINE Cplx unit(Cplx a) { return scaled(1.0 / size(a), a); }

/* The root with its real part >= 0; of points left of 0 on the axis the upper one. */
MESHONET_INLINE Cplx root(Cplx a)
{
    const double r = size(a), half = sqrt(0.5 * (r + fabs(a.re)));
    if (r == 0.0) return (Cplx){0.0, 0.0};
    if (a.re >= 0.0) return (Cplx){half, 0.5 * a.im / half};
    return (Cplx){0.5 * fabs(a.im) / half, a.im < 0.0 ? -half : half};
}

/* The outer root zeta of z = centre + quarter (zeta + 1/zeta), Z = (z - centre)/quarter. */
MESHONET_INLINE Cplx joukowski(Cplx Z)
{
    const Cplx less_two = {Z.re - 2.0, Z.im}, two_more = {Z.re + 2.0, Z.im};
    if (size2(less_two) < 1e-26) return (Cplx){1.0, 0.0}; /* an end of the slit is a branch point: no rounding there */
    return middle(Z, times(root(less_two), root(two_more)));
}

MESHONET_INLINE Cplx remove_corner(const LiftCorner *c, Cplx v)
{
    const Cplx from = less(v, c->p);
    if (from.re == 0.0 && from.im == 0.0) return c->P;
    const Cplx quotient = over(from, less(v, c->q));
    const double angle = atan2(quotient.im, quotient.re) / c->k, reach = pow(size2(quotient), 0.5 / c->k);
    const Cplx r = {reach * cos(angle), reach * sin(angle)};
    return over(less(times(c->Q, r), c->P), (Cplx){r.re - 1.0, r.im});
}

/* log |v - pole| + i angle, the angle continuous from node to node */
MESHONET_INLINE void unroll(const Cplx *v, ptrdiff_t n, Cplx pole, Cplx *w)
{
    double turns = 0.0, last = 0.0;
    for (ptrdiff_t i = 0; i < n; i++) {
        const Cplx offset = less(v[i], pole);
        const double angle = atan2(offset.im, offset.re);
        if (i > 0) turns -= rint((angle - last) / (2.0 * PI));
        last = angle;
        w[i] = (Cplx){0.5 * log(size2(offset)), angle + 2.0 * PI * turns};
    }
}

/* The centroid of the area inside a closed polygon, from near its first node, against cancellation. */
MESHONET_INLINE Cplx centroid(const Cplx *v, ptrdiff_t n)
{
    Cplx sum = {0.0, 0.0};
    double area = 0.0;
    for (ptrdiff_t i = 1; i + 1 < n; i++) {
        const Cplx a = less(v[i], v[0]), b = less(v[i + 1], v[0]);
        const double cross = turned_back(a, b).im;
        sum = add(sum, scaled(cross, add(a, b)));
        area += cross;
    }
    return add(v[0], scaled(1.0 / (3.0 * area), sum));
}

/* The corner of the base that lies ahead of the edge (step 1) or behind it (-1); 0 when there is none. */
static ptrdiff_t base_corner(const Cplx *wall, ptrdiff_t n, const double *turn, int step, double reach)
{
    ptrdiff_t best = 0;
    double way = 0.0, most = CORNER_TURN;
    Cplx before = wall[0];
    for (ptrdiff_t m = 1; m < n; m++) {
        const ptrdiff_t i = step > 0 ? m : n - m;
        way += size(less(wall[i], before));
        if (!(way < reach)) break;
        if (turn[i] > most) most = turn[i], best = i;
        before = wall[i];
    }
    return best;
}

/* The focus behind node `tip`: the circle through it and the nodes beside it tells. */
static Cplx focus(const Cplx *wall, ptrdiff_t n, ptrdiff_t tip, Cplx other)
{
    const Cplx b = wall[tip];
    const double chord = size(less(other, b));
    ptrdiff_t ahead = 1, behind = 1; /* nodes .004 of the chord away */
    for (ptrdiff_t m = n / 2 - 1; m > 0; m--) {
        if (size(less(wall[(tip + m) % n], b)) > 0.004 * chord) ahead = m;
        if (size(less(wall[(tip - m + n) % n], b)) > 0.004 * chord) behind = m;
    }
    const Cplx a = wall[(tip + ahead) % n], c = wall[(tip - behind + n) % n];
    const double area = 0.5 * fabs(turned_back(less(c, b), less(a, b)).im);
    const double sides = size(less(a, b)) * size(less(c, b)) * size(less(a, c));
    const double part = 2.0 * sides / (4.0 * area + 1e-12 * chord * chord) / chord;
    const double ratio = part < 4e-4 ? 4e-4 : part > 0.8 ? 0.8 : part;
    Cplx inwards = {c.im - a.im, a.re - c.re}; /* i (a - c) */
    if (turned_back(inwards, less(other, b)).re < 0.0) inwards = scaled(-1.0, inwards);
    return add(b, scaled(0.5 * chord * (1.0 - sqrt(1.0 - ratio)), unit(inwards)));
}

/* Middle and quarter of the slit. */
static void find_slit(const Cplx *wall, ptrdiff_t n, int corners, const ptrdiff_t *base, BodyLift *found)
{
    double most = 0.0;
    for (ptrdiff_t i = 0; i < n; i++) most = fmax(most, size(less(wall[i], wall[0])));
    ptrdiff_t first = n, last = 0;
    for (ptrdiff_t i = 0; i < n; i++)
        if (size(less(wall[i], wall[0])) > (1.0 - 1e-12) * most) {
            if (first == n) first = i;
            last = i;
        }
    const Cplx nose = middle(wall[first], wall[last]);
    Cplx tail = wall[0];
    if (corners == 2) {
        const Cplx between = middle(wall[base[0]], wall[base[1]]);
        const double gap = size(less(wall[base[0]], wall[base[1]]));
        tail = add(between, scaled(0.25 * gap, unit(less(nose, between))));
    } else if (corners == 0 || base[0] != 0) {
        tail = focus(wall, n, 0, nose);
    }
    Cplx head = middle(focus(wall, n, first, wall[0]), focus(wall, n, last, wall[0]));
    if (size(less(tail, head)) < 0.2 * size(less(nose, wall[0]))) { /* round: the foci meet, the map must not vanish */
        const Cplx between = middle(tail, head), spread = scaled(0.1, less(wall[0], nose));
        tail = add(between, spread);
        head = less(between, spread);
    }
    found->centre = middle(tail, head);
    found->quarter = scaled(0.25, less(tail, head));
}

void lift_follow(const Cplx *wall, ptrdiff_t n, Cplx centre, Cplx quarter, Cplx *zeta)
{
    double farthest = -1.0;
    int crossed = 0, outside = 0;
    Cplx before = {0.0, 0.0};
    for (ptrdiff_t i = 0; i < n; i++) {
        const Cplx Z = over(less(wall[i], centre), quarter);
        zeta[i] = joukowski(Z);
        if (i > 1 && (Z.im >= 0.0) != (before.im >= 0.0)) { /* from behind the edge, which may be a branch point */
            const double meets = before.re + (Z.re - before.re) * before.im / (before.im - Z.im);
            if (fabs(meets) < 2.0) crossed = !crossed;
        }
        if (i > 0 && size2(zeta[i]) > farthest) farthest = size2(zeta[i]), outside = crossed;
        if (crossed) zeta[i] = over((Cplx){1.0, 0.0}, zeta[i]);
        before = Z;
    }
    const Cplx one = {1.0, 0.0};
    if (outside) /* where it is farthest from the slit the wall is outside */
        for (ptrdiff_t i = 1; i < n; i++) zeta[i] = over(one, zeta[i]);
    const Cplx near = middle(zeta[1], zeta[n - 1]), inner = over(one, zeta[0]);
    if (size2(less(inner, near)) < size2(less(zeta[0], near))) zeta[0] = inner;
}

/* Straighten one corner of `v` (n,) if its exterior angle k pi asks for it and the result is finite. */
static void straighten(Cplx *v, ptrdiff_t n, ptrdiff_t node, double k, BodyLift *found, Cplx *straight)
{
    if (!((0.55 < k && k < 0.995) || (1.03 < k && k < 1.9))) return;
    const Cplx p = v[node], q = add(p, scaled(SECOND_PRONG, less(found->pole, p)));
    const LiftCorner corner = {p, q, p, less(p, scaled(1.0 / k, less(p, q))), k};
    for (ptrdiff_t i = 0; i < n; i++) {
        straight[i] = remove_corner(&corner, v[i]);
        if (!isfinite(straight[i].re + straight[i].im)) return;
    }
    for (ptrdiff_t i = 0; i < n; i++) v[i] = straight[i];
    found->corners[found->n_corners++] = corner;
    found->pole = centroid(v, n);
}

int lift_wall(const Cplx *wall, ptrdiff_t n, int swap, BodyLift *found, Cplx *w, ptrdiff_t *corners, double *winding,
              double *scratch)
{
    double chord = 0.0, *turn = scratch;
    for (ptrdiff_t i = 0; i < n; i++) {
        const Cplx ahead = less(wall[(i + 1) % n], wall[i]), behind = less(wall[i], wall[(i + n - 1) % n]);
        const Cplx around = turned_back(behind, ahead);
        turn[i] = atan2(around.im, around.re);
        chord = fmax(chord, size(less(wall[i], wall[0])));
    }
    int count = 0;
    if (turn[0] > SHARP_TURN) {
        corners[count++] = 0;
    } else {
        const ptrdiff_t both[] = {base_corner(wall, n, turn, 1, BASE_REACH * chord),
                                  base_corner(wall, n, turn, -1, BASE_REACH * chord)};
        for (int k = 0; k < 2; k++)
            if (both[k]) corners[count++] = both[k];
    }
    find_slit(wall, n, count, corners, found);
    lift_follow(wall, n, found->centre, found->quarter, w);
    found->pole = centroid(w, n);
    found->n_corners = 0;
    for (int k = 0; k < count; k++) {
        const ptrdiff_t node = corners[swap ? count - 1 - k : k];
        straighten(w, n, node, (node ? 1.0 : 0.5) * (1.0 + turn[node] / PI), found,
                   (Cplx *)(scratch + n));
    }
    const Cplx first = less(w[0], found->pole), last = less(w[n - 1], found->pole), closing = turned_back(last, first);
    unroll(w, n, found->pole, w);
    found->phase = w[0].im;
    *winding = (w[n - 1].im - w[0].im + atan2(closing.im, closing.re)) / (2.0 * PI);
    for (ptrdiff_t i = 0; i < n; i++) w[i].im -= found->phase;
    return count;
}

void lift_to_strip(const BodyLift *lift, const Cplx *z, ptrdiff_t n, Cplx *w)
{
    for (ptrdiff_t i = 0; i < n; i++) {
        w[i] = joukowski(over(less(z[i], lift->centre), lift->quarter));
        for (int k = 0; k < lift->n_corners; k++) w[i] = remove_corner(&lift->corners[k], w[i]);
    }
    unroll(w, n, lift->pole, w);
    for (ptrdiff_t i = 0; i < n; i++) w[i].im -= lift->phase;
}
