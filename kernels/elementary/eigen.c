#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "clones.h"
#include "eigen.h"

#define MOST 60 /* steps for an eigenvalue; it takes two or three */

/* Turn two rows (or columns) of `n` numbers, `by` apart. */
MESHONET_INLINE void turn(double *one, double *two, ptrdiff_t n, ptrdiff_t by, double c, double s)
{
    for (ptrdiff_t k = 0; k < n * by; k += by) {
        const double a = one[k], b = two[k];
        one[k] = c * a + s * b;
        two[k] = c * b - s * a;
    }
}

/* The cosine and sine that turn (a, b) to (r, 0). */
MESHONET_INLINE void rotation(double a, double b, double *c, double *s)
{
    const double r = sqrt(a * a + b * b);
    *c = r > 0.0 ? a / r : 1.0;
    *s = r > 0.0 ? b / r : 0.0;
}

/* a = q h q^T by rotations, h zero below its first subdiagonal; h replaces a. */
static void to_hessenberg(double *a, double *q, ptrdiff_t n)
{
    double c, s;
    for (ptrdiff_t k = 0; k < n * n; k++)
        q[k] = k % (n + 1) ? 0.0 : 1.0;
    for (ptrdiff_t j = 0; j + 2 < n; j++)
        for (ptrdiff_t i = n - 1; i > j + 1; i--) {
            rotation(a[(i - 1) * n + j], a[i * n + j], &c, &s);
            turn(a + (i - 1) * n, a + i * n, n, 1, c, s);
            turn(a + i - 1, a + i, n, n, c, s);
            turn(q + i - 1, q + i, n, n, c, s);
            a[i * n + j] = 0.0;
        }
}

/* The eigenvalue of the last two rows and columns up to `last` that is nearer to the last diagonal number. */
static double shift_of(const double *a, ptrdiff_t n, ptrdiff_t last)
{
    const double *up = a + (last - 1) * n + last - 1, *down = up + n;
    const double half = 0.5 * (up[0] - down[1]), off = up[1] * down[0], square = half * half + off;
    if (square <= 0.0)
        return down[1];
    const double root = sqrt(square), to = half + (half < 0.0 ? -root : root);
    return down[1] - off / to;
}

/* A step of the QR iteration of rows `first` to `last`. */
static void iterate(double *a, double *q, ptrdiff_t n, ptrdiff_t first, ptrdiff_t last, double *turns)
{
    const double shift = shift_of(a, n, last);
    for (ptrdiff_t k = first; k <= last; k++)
        a[k * n + k] -= shift;
    for (ptrdiff_t k = first; k < last; k++) {
        double *c = turns + 2 * k, *s = c + 1;
        rotation(a[k * n + k], a[(k + 1) * n + k], c, s);
        turn(a + k * n + k, a + (k + 1) * n + k, n - k, 1, *c, *s);
        a[(k + 1) * n + k] = 0.0;
    }
    for (ptrdiff_t k = first; k < last; k++) {
        turn(a + k, a + k + 1, k + 2, n, turns[2 * k], turns[2 * k + 1]);
        turn(q + k, q + k + 1, n, n, turns[2 * k], turns[2 * k + 1]);
    }
    for (ptrdiff_t k = first; k <= last; k++)
        a[k * n + k] += shift;
}

/* a = q t q^T with t triangular, which replaces a: 0, or 1 where eigenvalues are not real. */
static int to_triangle(double *a, double *q, ptrdiff_t n, double *turns)
{
    int steps = 0;
    for (ptrdiff_t last = n - 1; last > 0;) {
        ptrdiff_t first = last;
        for (; first > 0; first--) {
            double *below = a + first * n + first - 1;
            if (fabs(*below) <= DBL_EPSILON * (fabs(below[-n]) + fabs(below[1]))) {
                *below = 0.0;
                break;
            }
        }
        if (first == last) {
            last--, steps = 0;
            continue;
        }
        if (++steps > MOST)
            return 1;
        iterate(a, q, n, first, last, turns);
    }
    return 0;
}

/* The eigenvectors x of the triangle t, its diagonal ones, and y, the inverse of x. */
static void of_triangle(const double *t, ptrdiff_t n, double *x, double *y)
{
    for (ptrdiff_t j = 0; j < n; j++)
        for (ptrdiff_t i = n - 1; i >= 0; i--) {
            double sum = 0.0;
            for (ptrdiff_t k = i + 1; k <= j; k++)
                sum += t[i * n + k] * x[k * n + j];
            x[i * n + j] = i > j ? 0.0 : i == j ? 1.0 : sum / (t[j * n + j] - t[i * n + i]);
        }
    for (ptrdiff_t j = 0; j < n; j++)
        for (ptrdiff_t i = n - 1; i >= 0; i--) {
            double sum = 0.0;
            for (ptrdiff_t k = i + 1; k <= j; k++)
                sum += x[i * n + k] * y[k * n + j];
            y[i * n + j] = i > j ? 0.0 : i == j ? 1.0 : -sum;
        }
}

MESHONET_CLONES
int real_eigen(double *a, ptrdiff_t n, double *values, double *vectors, double *inverse)
{
    double *room = malloc((size_t)(3 * n * n + 2 * n) * sizeof *room), *q = room, *x = q + n * n, *y = x + n * n;
    if (!room)
        return 2;
    to_hessenberg(a, q, n);
    const int failed = to_triangle(a, q, n, y + n * n);
    if (!failed) {
        of_triangle(a, n, x, y);
        for (ptrdiff_t j = 0; j < n; j++) {
            double square = 0.0;
            values[j] = a[j * n + j];
            for (ptrdiff_t i = 0; i <= j; i++)
                square += x[i * n + j] * x[i * n + j];
            const double size = sqrt(square);
            for (ptrdiff_t i = 0; i < n; i++) {
                x[i * n + j] /= size;
                y[j * n + i] *= size;
            }
        }
        for (ptrdiff_t i = 0; i < n; i++)
            for (ptrdiff_t j = 0; j < n; j++) {
                double ahead = 0.0, back = 0.0;
                for (ptrdiff_t k = 0; k < n; k++) {
                    ahead += q[i * n + k] * x[k * n + j];
                    back += y[i * n + k] * q[j * n + k];
                }
                vectors[i * n + j] = ahead;
                inverse[i * n + j] = back;
            }
    }
    free(room);
    return failed;
}
