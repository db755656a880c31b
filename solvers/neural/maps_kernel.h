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
    /* beyond |v| = exp(psi_far) the whole map is z = quarter v + sum_n laurent[n] v^-n, v = zeta' - pole */
    double psi_far, reach; /* reach = psi_far - psi of the wall */
    int n_laurent;
    const Cplx *laurent;
} LiftMaps;

/* Rows of m points each: psi, phi in, x, -y out, in place. */
void lift_to_plane(double *psi_x, double *phi_y, long rows, long m, const LiftMaps *maps);

#endif
