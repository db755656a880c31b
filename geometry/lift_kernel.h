/* The conformal lift of a body's wall; see lift.py for the maps and what decides them. */
#ifndef MESHONET_LIFT_KERNEL_H
#define MESHONET_LIFT_KERNEL_H

#include <stddef.h>

typedef struct { double re, im; } Cplx;

/* One corner removal: p, q before, P, Q after, exterior angle k pi. */
typedef struct { Cplx p, q, P, Q; double k; } LiftCorner;

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

/* The nodes ahead of and behind `tip` that are .004 of the distance to `other` away from it. */
void lift_beside(const Cplx *wall, ptrdiff_t n, ptrdiff_t tip, Cplx other, ptrdiff_t *ahead, ptrdiff_t *behind);

#endif
