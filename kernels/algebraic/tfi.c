/* Transfinite interpolation of four edges: one pass, one division a node.

   At node (i, j) the straight lines that join equal parameters on opposite edges,
       u = s + (n - s) v,    v = w + (e - w) u        s, n, w, e: parameter of the node's foot on each edge,
   cross at
       u = (s + (n - s) w) / (1 - (n - s)(e - w)),    v = w + (e - w) u,
   and the Boolean sum of the two edge interpolations is taken there:
       x = (1-v) S_i + v N_i  +  (1-u) W_j + u E_j  -  (1-u)(1-v) a - u (1-v) b - u v c - (1-u) v d.
   With south and north weights equal (n = s, e = w) this is the separable blending of Gordon and Hall. */
#include "tfi.h"
#include "tfi_row.h"

MESHONET_CLONES
void tfi_fill(double *x, double *y, ptrdiff_t ni, ptrdiff_t nj, const TfiEdges *ex, const TfiEdges *ey,
              const TfiEdges *parameter)
{
    for (ptrdiff_t j = 0; j < nj; j++)
        x[j] = ex->west[j], y[j] = ey->west[j];
    for (ptrdiff_t i = 1; i < ni - 1; i++)
        fill_row(x + i * nj, y + i * nj, i, ni, nj, ex, ey, parameter);
    for (ptrdiff_t j = 0; j < nj; j++)
        x[(ni - 1) * nj + j] = ex->east[j], y[(ni - 1) * nj + j] = ey->east[j];
}
