/* The place, turn and size of domains, taken out and put back; see frame.py. Planes are (2, m, n). */
#pragma once
#include <stddef.h>

/* out = (planes - their middle) * factor, a complex number, as planes. */
void frame_take_out(const double *planes, ptrdiff_t m, ptrdiff_t n, double *factor, double *out);

/* planes += (moved - unit) / factor, both at unit size. */
void frame_put_back(double *planes, const double *moved, const double *unit, ptrdiff_t m, ptrdiff_t n,
                    const double *factor);

/* planes += rim (m, n) times answers, of which a node has so many numbers, the first two for these planes. */
void frame_add_float(double *planes, const float *answers, ptrdiff_t numbers, const double *rim, ptrdiff_t m,
                     ptrdiff_t n);
void frame_add_double(double *planes, const double *answers, ptrdiff_t numbers, const double *rim, ptrdiff_t m,
                      ptrdiff_t n);
