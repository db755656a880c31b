/* From strip points w = psi + i phi to the plane; see geometry/lift.py for the maps. */
#pragma once
#include <math.h>

#include "elementary.h"
#include "lift.h"

#define CHUNK 256 /* points at a time, so that they stay in the first cache */
#define FAR 0.0625 /* |e^2| up to which it holds to round-off: FAR^TERMS is 2e-16 */
#define TOGETHER 8 /* points for which one tells whether it does */

/* v = exp(psi + i (phi + phase)) */
MESHONET_INLINE void unroll(const double *psi, const double *phi, double phase, long n, double *vr, double *vi) {
    for (long j = 0; j < n; j++) {
        double s, c, r = exp_double(psi[j]);
        sincos_double(phi[j] + phase, &s, &c);
        vr[j] = r * c;
        vi[j] = r * s;
    }
}

/* v <- (q r - p)/(r - 1) with r = ((v - P)/(v - Q))^k */
MESHONET_INLINE void restore_corner(const LiftCorner *m, long n, double *restrict vr, double *restrict vi,
                                    double *restrict lr, double *restrict an) {
    for (long j = 0; j < n; j++) {
        double a = vr[j] - m->P.re, b = vi[j] - m->P.im, c = vr[j] - m->Q.re, d = vi[j] - m->Q.im;
        lr[j] = (a * a + b * b) / (c * c + d * d);
        vr[j] = a * c + b * d; /* (v - P) conj(v - Q): the quotient's direction */
        vi[j] = b * c - a * d;
    }
    for (long j = 0; j < n; j++) lr[j] = log_double(lr[j]);
    for (long j = 0; j < n; j++) an[j] = angle_double(vi[j], vr[j]);
    const double k = m->k;
    for (long j = 0; j < n; j++) {
        double s, c, size = exp_double(0.5 * k * (lr[j] > -600.0 ? lr[j] : -600.0)); /* at the corner itself: 0 */
        sincos_double(k * an[j], &s, &c);
        double rr = size * c, ri = size * s;
        double nr = m->q.re * rr - m->q.im * ri - m->p.re, ni = m->q.re * ri + m->q.im * rr - m->p.im;
        double dr = rr - 1.0, w = 1.0 / (dr * dr + ri * ri);
        vr[j] = (nr * dr + ni * ri) * w;
        vi[j] = (ni * dr - nr * ri) * w;
    }
}

/* The same by the series, from point `first` on. */
MESHONET_INLINE void restore_far(const LiftCorner *m, long first, long n, double *restrict vr, double *restrict vi) {
    const double mr = 0.5 * (m->p.re + m->q.re), mi = 0.5 * (m->p.im + m->q.im);
    const double Mr = 0.5 * (m->P.re + m->Q.re), Mi = 0.5 * (m->P.im + m->Q.im);
    const double hr = 0.5 * (m->P.re - m->Q.re), hi = 0.5 * (m->P.im - m->Q.im);
    for (long j = first; j < n; j++) {
        const double dr = vr[j] - Mr, di = vi[j] - Mi, w = 1.0 / (dr * dr + di * di);
        const double er = (hr * dr + hi * di) * w, ei = (hi * dr - hr * di) * w;
        const double zr = er * er - ei * ei, zi = 2.0 * er * ei;
        double sr = m->series[TERMS - 1], si = 0.0;
        for (int t = TERMS - 2; t >= 0; t--) {
            const double next = sr * zr - si * zi + m->series[t];
            si = sr * zi + si * zr;
            sr = next;
        }
        vr[j] = mr + dr * sr - di * si;
        vi[j] = mi + dr * si + di * sr;
    }
}

/* Return how many of the points, all that are near the corner among them, the series is not for. Points run outwards:
   the nearest to the corner of some behind each other is the first. */
MESHONET_INLINE long near_corner(const LiftCorner *m, long n, const double *vr, const double *vi) {
    const double Mr = 0.5 * (m->P.re + m->Q.re), Mi = 0.5 * (m->P.im + m->Q.im);
    const double hr = 0.5 * (m->P.re - m->Q.re), hi = 0.5 * (m->P.im - m->Q.im);
    const double far = (hr * hr + hi * hi) / FAR;
    while (n > 0) {
        const long first = n > TOGETHER ? n - TOGETHER : 0;
        const double dr = vr[first] - Mr, di = vi[first] - Mi;
        if (!(dr * dr + di * di > far)) break;
        n = first;
    }
    return n;
}

/* At most CHUNK points, psi and phi in, x and y out (y mirrored back: minus the imaginary part of z), in place. */
MESHONET_INLINE void lift_to_plane(double *restrict psi_x, double *restrict phi_y, long n, const BodyLift *m) {
    double vr[CHUNK], vi[CHUNK], a[CHUNK], b[CHUNK];
    unroll(psi_x, phi_y, m->phase, n, vr, vi);
    for (long j = 0; j < n; j++) {
        vr[j] += m->pole.re;
        vi[j] += m->pole.im;
    }
    for (int k = m->n_corners - 1; k >= 0; k--) {
        const long near = near_corner(&m->corners[k], n, vr, vi);
        restore_corner(&m->corners[k], near, vr, vi, a, b);
        restore_far(&m->corners[k], near, n, vr, vi);
    }
    MESHONET_INDEPENDENT
    for (long j = 0; j < n; j++) {
        double w = 1.0 / (vr[j] * vr[j] + vi[j] * vi[j]);
        double zr = vr[j] * (1.0 + w), zi = vi[j] * (1.0 - w);
        psi_x[j] = m->centre.re + m->quarter.re * zr - m->quarter.im * zi;
        phi_y[j] = -(m->centre.im + m->quarter.re * zi + m->quarter.im * zr);
    }
}
