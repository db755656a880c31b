/* A complex number that every compiler has. */
#ifndef MESHONET_COMPLEX_PAIR_H
#define MESHONET_COMPLEX_PAIR_H

typedef struct { double re, im; } Cplx;

#endif
