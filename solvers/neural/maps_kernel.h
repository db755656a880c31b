/* From strip points w = psi + i phi to the plane; see lift.py for the maps. */
#ifndef MESHONET_MAPS_KERNEL_H
#define MESHONET_MAPS_KERNEL_H

typedef struct { double re, im; } Cplx;

typedef struct { Cplx p, q, P, Q; double k; } CornerMap;

typedef struct {
    Cplx centre, quarter, pole;
    double phase;
    int n_corners;
    const CornerMap *corners; /* in the order in which they are restored */
} LiftMaps;

/* n points: psi, phi in, x, -y out, in place. */
void lift_to_plane(double *psi_x, double *phi_y, long n, const LiftMaps *maps);

#endif
