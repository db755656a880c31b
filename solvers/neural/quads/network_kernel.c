/* Argument reduction in the exponentials lives on the order of its operations. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-associative-math")
#endif

#include "network_kernel.h"

#include <math.h>
#include <string.h>

#include "clones.h"
#include "exponential.h"

/* glibc's vector version of it; elsewhere it stays a scalar call */
#if defined(__GLIBC__) && defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 35)
extern double log(double) __attribute__((simd("notinbranch")));
#endif

/* exp(x) = 2^n exp(r): n = x / ln 2 to the nearest by adding 1.5 2^52 (2^23), whose low bits then are n; arguments beyond what 1/(1 + exp) tells from its limits are clamped. 2 ulp. */
MESHONET_INLINE double exp_double(double x)
{
    x = x > 700.0 ? 700.0 : x < -700.0 ? -700.0 : x;
    union { double real; unsigned long long bits; } shifted, scale;
    shifted.real = x * 1.4426950408889634 + 6755399441055744.0;
    const double n = shifted.real - 6755399441055744.0;
    const double r = (x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
    scale.bits = (shifted.bits + 1023) << 52;
    return exp_reduced(r) * scale.real;
}

MESHONET_INLINE float exp_float(float x)
{
    x = x > 80.0f ? 80.0f : x < -80.0f ? -80.0f : x;
    union { float real; unsigned int bits; } shifted, scale;
    shifted.real = x * 1.44269504f + 12582912.0f;
    const float n = shifted.real - 12582912.0f;
    const float r = (x - n * 0.693145752f) - n * 1.42860677e-6f;
    float p = 1.0f / 5040.0f;
    p = p * r + 1.0f / 720.0f;
    p = p * r + 1.0f / 120.0f;
    p = p * r + 1.0f / 24.0f;
    p = p * r + 1.0f / 6.0f;
    p = p * r + 0.5f;
    p = p * r + 1.0f;
    p = p * r + 1.0f;
    scale.bits = (shifted.bits + 127) << 23;
    return p * scale.real;
}

#define T float
#define SUFFIX _float
#define EXP exp_float
#include "pointwise.h"
#include "look.h"
#undef T
#undef SUFFIX
#undef EXP
#define T double
#define SUFFIX _double
#define EXP exp_double
#include "pointwise.h"
#include "look.h"
#undef T
#undef SUFFIX

/* Vectors of 256 bits everywhere, and where the processor has them, of 512. */
#define VECTOR 32
#define KERNEL MESHONET_CLONES
#define T float
#define SUFFIX _float
#include "convolve.h"
#include "winograd.h"
#undef T
#undef SUFFIX
#define T double
#define SUFFIX _double
#include "convolve.h"
#include "winograd.h"
#undef T
#undef SUFFIX
#undef VECTOR
#undef KERNEL

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && __GNUC__ >= 12
#define MESHONET_WIDE 1
#define VECTOR 64
#define KERNEL __attribute__((target("arch=x86-64-v4")))
#define T float
#define SUFFIX _wide_float
#include "convolve.h"
#include "winograd.h"
#undef T
#undef SUFFIX
#define T double
#define SUFFIX _wide_double
#include "convolve.h"
#include "winograd.h"
#undef T
#undef SUFFIX
#undef VECTOR
#undef KERNEL
#endif

/* A tile in the innermost function is slow when the processor lacks its vectors, so the choice is made here. */
#ifdef MESHONET_WIDE
#define WIDE(call, otherwise) if (__builtin_cpu_supports("x86-64-v4")) { call; } else { otherwise; }
#else
#define WIDE(call, otherwise) otherwise;
#endif

void network_convolve_float(const float *in, const Convolution *c, const float *w, const float *bias, const float *add,
                            float *out)
{
    WIDE(convolve_wide_float(in, c, w, bias, add, out), convolve_float(in, c, w, bias, add, out))
}

void network_convolve_double(const double *in, const Convolution *c, const double *w, const double *bias,
                             const double *add, double *out)
{
    WIDE(convolve_wide_double(in, c, w, bias, add, out), convolve_double(in, c, w, bias, add, out))
}

void network_winograd_float(const float *in, const Convolution *c, const float *w, const float *bias, const float *add,
                            float *scratch, float *out)
{
    WIDE(winograd_wide_float(in, c, w, bias, add, scratch, out), winograd_float(in, c, w, bias, add, scratch, out))
}

void network_winograd_double(const double *in, const Convolution *c, const double *w, const double *bias,
                             const double *add, double *scratch, double *out)
{
    WIDE(winograd_wide_double(in, c, w, bias, add, scratch, out), winograd_double(in, c, w, bias, add, scratch, out))
}
