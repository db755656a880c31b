/* Products of matrices in single precision, a panel of columns at a time. */
#pragma once
#include <stddef.h>

#define PANEL 32 /* columns of a product at a time: two vectors of 512 bits */

/* c (m, PANEL) = a (m, k) packed (k, PANEL), or c += with `add`. */
void spectral_panel(const float *a, ptrdiff_t a_stride, const float *packed, float *c, ptrdiff_t c_stride, ptrdiff_t m,
                    ptrdiff_t k, int add);
