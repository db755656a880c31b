/* Conformal map of a body's wall to the strip; see lift.py for the maps and the choice among them. */
#pragma once
#include <stddef.h>

typedef struct { double re, im; } Cplx; /* a complex number that every compiler has */

#define TERMS 13 /* of the series below */

/* One corner removal: p, q before, P, Q after, exterior angle k pi. Far from the corner it is undone by
       v = m + k h' coth(k artanh e) = m + (v' - m') (series[0] + series[1] e^2 + ...),    e = h'/(v' - m'),
   m the middle of p and q, m' that of P and Q, and h' half their distance. */
typedef struct { Cplx p, q, P, Q; double k; double series[TERMS]; } LiftCorner;

typedef struct {
    Cplx centre, quarter, pole;
    double phase;
    int n_corners;
    LiftCorner corners[2];
} BodyLift;

/* `wall` (n,) counter-clockwise, n >= 8, to points `w` (n,) of the strip. `corners` (2,) are the nodes of the trailing
   edge; their number is returned. `winding`: how often the wall goes around its middle. `scratch` for 3 n numbers. */
int lift_wall(const Cplx *wall, ptrdiff_t n, int swap, BodyLift *found, Cplx *w, ptrdiff_t *corners, double *winding,
              double *scratch);

/* `z` (n,) in walking order around and outside the body to `w` (n,). */
void lift_to_strip(const BodyLift *lift, const Cplx *z, ptrdiff_t n, Cplx *w);

/* zeta along the wall, changing root where a side crosses the slit. */
void lift_follow(const Cplx *wall, ptrdiff_t n, Cplx centre, Cplx quarter, Cplx *zeta);

/* Fill in the series of a corner. */
void lift_expand(LiftCorner *corner);

/* A corner of the wall, the nodes ahead of it and behind, and the first point w of its line, in the strip. */
typedef struct { Cplx corner, ahead, behind, w; } LineOff;

/* The shift of phi, at most `limit`, with which a line leaves a corner of the wall at equal angles; `start` when none is
   found. See bisector.py. */
double lift_bisect(const BodyLift *lift, const LineOff *line, double start, double limit);
