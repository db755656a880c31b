#include "functions.h"

#include <math.h>
#include <string.h>

#include "elementary.h"

/* What the forms for vectors leave out, the C library does: infinities, NaN, the very large and the very small. */
#define REST(inside, function)              \
    for (ptrdiff_t k = 0; k < n; k++)       \
        if (!(inside))                      \
            out[k] = function;

#define BY_VECTORS(name, form, inside)                                                      \
    MESHONET_CLONES                                                                         \
    static void name##_of(const double *restrict x, ptrdiff_t n, double *restrict out)      \
    {                                                                                       \
        for (ptrdiff_t k = 0; k < n; k++)                                                   \
            out[k] = form;                                                                  \
        REST(inside, name(x[k]))                                                            \
    }

MESHONET_INLINE double limited(double x, double most) { return x < -most ? -most : x < most ? x : most; }
MESHONET_INLINE double sine(double x) { double s, c; sincos_double(x, &s, &c); return s; }
MESHONET_INLINE double cosine(double x) { double s, c; sincos_double(x, &s, &c); return c; }

BY_VECTORS(exp, exp_double(limited(x[k], 700.0)), fabs(x[k]) < 700.0)
BY_VECTORS(expm1, expm1_double(fabs(x[k]) < 700.0 ? x[k] : 0.0), fabs(x[k]) < 700.0 && x[k] != 0.0)
BY_VECTORS(tanh, tanh_double(fabs(x[k]) < 300.0 ? x[k] : 0.0), fabs(x[k]) < 300.0 && x[k] != 0.0)
BY_VECTORS(log, log_double(x[k]), x[k] > 1e-307 && x[k] < 1e308)
BY_VECTORS(sin, sine(fabs(x[k]) < 1e5 ? x[k] : 0.0), fabs(x[k]) < 1e5 && x[k] != 0.0) /* sin has the sign of 0 */
BY_VECTORS(cos, cosine(fabs(x[k]) < 1e5 ? x[k] : 0.0), fabs(x[k]) < 1e5)

MESHONET_CLONES
void function_angle(const double *restrict y, const double *restrict x, ptrdiff_t n, double *restrict out)
{
    for (ptrdiff_t k = 0; k < n; k++)
        out[k] = angle_double(y[k], x[k]);
    REST(fabs(x[k]) + fabs(y[k]) < 1e300 && fabs(x[k]) + fabs(y[k]) > 1e-290 && y[k] != 0.0, atan2(y[k], x[k]))
}

/* Those that are too rare for forms of their own: the C library's for one number at a time. */
#define ONE_BY_ONE(name)                                               \
    static void name##_of(const double *x, ptrdiff_t n, double *out) \
    {                                                                  \
        for (ptrdiff_t k = 0; k < n; k++)                              \
            out[k] = name(x[k]);                                       \
    }

ONE_BY_ONE(log1p)
ONE_BY_ONE(log2)
ONE_BY_ONE(log10)
ONE_BY_ONE(tan)
ONE_BY_ONE(asin)
ONE_BY_ONE(acos)
ONE_BY_ONE(atan)
ONE_BY_ONE(sinh)
ONE_BY_ONE(cosh)
ONE_BY_ONE(asinh)
ONE_BY_ONE(acosh)
ONE_BY_ONE(cbrt)

void function_power(const double *x, const double *y, ptrdiff_t n, double *out)
{
    for (ptrdiff_t k = 0; k < n; k++)
        out[k] = pow(x[k], y[k]);
}

Function function_named(const char *name)
{
    static const struct {
        const char *name;
        Function function;
    } all[] = {{"exp", exp_of},       {"log", log_of},   {"sin", sin_of},   {"cos", cos_of},   {"expm1", expm1_of},
               {"log1p", log1p_of},   {"log2", log2_of}, {"log10", log10_of}, {"tan", tan_of}, {"arcsin", asin_of},
               {"arccos", acos_of},   {"arctan", atan_of}, {"sinh", sinh_of}, {"cosh", cosh_of}, {"tanh", tanh_of},
               {"arcsinh", asinh_of}, {"arccosh", acosh_of}, {"cbrt", cbrt_of}};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        if (!strcmp(all[k].name, name))
            return all[k].function;
    return NULL;
}
