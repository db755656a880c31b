/* The shift along the strip with which a line leaves a corner along its bisector; see bisector.py. */
#include "lift_maps.h"

#define STEPS 5       /* of the secant method */
#define HALVED 1e-12  /* what may be left of the difference of the two angles (radians) */
#define TRIED 0.05    /* of the limit: the second of the first two shifts */

/* y = k e coth(k artanh e) solves (1 - e^2) (e y' - y) = k^2 e^2 - y^2. */
void lift_expand(LiftCorner *m)
{
    double *a = m->series;
    a[0] = 1.0;
    for (int n = 1; n < TERMS; n++) {
        double sum = (2 * n - 3) * a[n - 1] + (n == 1 ? m->k * m->k : 0.0);
        for (int j = 1; j < n; j++) sum -= a[j] * a[n - j];
        a[n] = sum / (2 * n + 1);
    }
}

/* The angle from b counter-clockwise to a, in [0, 2 pi). */
MESHONET_INLINE double turn_to(Cplx b, Cplx a)
{
    const double angle = atan2(a.im * b.re - a.re * b.im, a.re * b.re + a.im * b.im);
    return angle < 0.0 ? angle + 6.283185307179586476925 : angle;
}

/* How much larger the angle behind the line is than the one ahead of it. */
static double unequal(const BodyLift *maps, const LineOff *l, double shift)
{
    double x = l->w.re, y = l->w.im + shift;
    lift_to_plane(&x, &y, 1, maps);
    const Cplx line = {x - l->corner.re, -y - l->corner.im};
    const Cplx behind = {l->behind.re - l->corner.re, l->behind.im - l->corner.im};
    const Cplx ahead = {l->ahead.re - l->corner.re, l->ahead.im - l->corner.im};
    return turn_to(line, behind) - turn_to(ahead, line);
}

double lift_bisect(const BodyLift *maps, const LineOff *l, double start, double limit)
{
    const double first = unequal(maps, l, start);
    double a = start, fa = first, b = start + (fa > 0.0 ? -TRIED : TRIED) * limit, fb = unequal(maps, l, b);
    for (int k = 0; k < STEPS && fa != fb && !(fabs(fb) < HALVED); k++) {
        const double next = b - fb * (b - a) / (fb - fa);
        a = b, fa = fb;
        b = next < -limit ? -limit : next > limit ? limit : next;
        fb = unequal(maps, l, b);
    }
    return isfinite(fb) && fabs(fb) <= fabs(first) ? b : start;
}
