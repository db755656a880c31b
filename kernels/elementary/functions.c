#include "functions.h"

#include <math.h>
#include <string.h>

#include "elementary.h"

/* What the forms for vectors leave out, the C library does: infinities, NaN, the very large and the very small. */
#define REST(inside, function)              \
    for (ptrdiff_t k = 0; k < n; k++)       \
        if (!(inside))                      \
            out[k] = function;

MESHONET_CLONES
static void exp_of(const double *restrict x, ptrdiff_t n, double *restrict out)
{
    for (ptrdiff_t k = 0; k < n; k++) {
        const double most = x[k] < 700.0 ? x[k] : 700.0;
        out[k] = exp_double(most > -700.0 ? most : -700.0);
    }
    REST(fabs(x[k]) < 700.0, exp(x[k]))
}

MESHONET_CLONES
static void expm1_of(const double *restrict x, ptrdiff_t n, double *restrict out)
{
    for (ptrdiff_t k = 0; k < n; k++)
        out[k] = expm1_double(fabs(x[k]) < 700.0 ? x[k] : 0.0);
    REST(fabs(x[k]) < 700.0 && x[k] != 0.0, expm1(x[k]))
}

MESHONET_CLONES
static void tanh_of(const double *restrict x, ptrdiff_t n, double *restrict out)
{
    for (ptrdiff_t k = 0; k < n; k++)
        out[k] = tanh_double(fabs(x[k]) < 300.0 ? x[k] : 0.0);
    REST(fabs(x[k]) < 300.0 && x[k] != 0.0, tanh(x[k]))
}

MESHONET_CLONES
static void log_of(const double *restrict x, ptrdiff_t n, double *restrict out)
{
    for (ptrdiff_t k = 0; k < n; k++)
        out[k] = log_double(x[k]);
    REST(x[k] > 1e-307 && x[k] < 1e308, log(x[k]))
}

MESHONET_CLONES
static void sin_of(const double *restrict x, ptrdiff_t n, double *restrict out)
{
    for (ptrdiff_t k = 0; k < n; k++) {
        double cosine;
        sincos_double(fabs(x[k]) < 1e5 ? x[k] : 0.0, out + k, &cosine);
    }
    REST(fabs(x[k]) < 1e5 && x[k] != 0.0, sin(x[k])) /* which has the sign of 0 */
}

MESHONET_CLONES
static void cos_of(const double *restrict x, ptrdiff_t n, double *restrict out)
{
    for (ptrdiff_t k = 0; k < n; k++) {
        double sine;
        sincos_double(fabs(x[k]) < 1e5 ? x[k] : 0.0, &sine, out + k);
    }
    REST(fabs(x[k]) < 1e5, cos(x[k]))
}

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
