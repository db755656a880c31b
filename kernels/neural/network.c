/* Minima and maxima are single instructions when NaN need not come out of them; it comes out of what they are in. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("finite-math-only")
#endif

#include "network.h"

#include <math.h>
#include <string.h>

#include "clones.h"
#include "elementary.h"
#include "sums.h"

/* exp(x) = 2^n exp(r): n = x / ln 2 to the nearest by adding 1.5 2^23, whose low bits then are n. The polynomial of degree 5 has the least relative error, 8e-8. */
MESHONET_INLINE float exp_float(float x)
{
    union { float real; unsigned int bits; } shifted, scale;
    shifted.real = x * 1.44269504f + 12582912.0f;
    const float n = shifted.real - 12582912.0f;
    const float r = (x - n * 0.693145752f) - n * 1.42860677e-6f;
    float p = 0.008297619f;
    p = p * r + 0.04191563f;
    p = p * r + 0.16667576f;
    p = p * r + 0.4999889f;
    p = p * r + 0.9999997f;
    p = p * r + 1.0000001f;
    scale.bits = (shifted.bits + 127) << 23;
    return p * scale.real;
}

/* log(x) = n log 2 + 2 artanh s, s = (m - 1) / (m + 1), x = 2^n m with m from √½ to √2; x is positive and normal. The
   first term that is left out, s^10 / 11, is less than 2e-9. */
MESHONET_INLINE float log_float(float x)
{
    union { float real; int bits; } m = {x};
    const int n = (m.bits - 0x3f3504f3) >> 23; /* bits of √½ */
    m.bits -= n * (1 << 23);
    const float s = (m.real - 1.0f) / (m.real + 1.0f), z = s * s;
    return (float)n * 0.69314718f + s * (2.0f + z * (2.0f / 3 + z * (2.0f / 5 + z * (2.0f / 7 + z * (2.0f / 9)))));
}

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define NAME(name) JOIN(name, SUFFIX)
#define sqrt_double sqrt
#define sqrt_float sqrtf

#define T float
#define SUFFIX _float
#include "look.h"
#define T double
#define SUFFIX _double
#include "look.h"

/* Vectors of 256 bits everywhere, and where the processor has them, of 512. */
#define VECTOR 32
#define KERNEL MESHONET_CLONES
#define T float
#define SUFFIX _float
#include "layers_of_type.h"
#define T double
#define SUFFIX _double
#include "layers_of_type.h"

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && __GNUC__ >= 12
#define MESHONET_WIDE 1
#undef VECTOR
#undef KERNEL
#define VECTOR 64
#define KERNEL __attribute__((target("arch=x86-64-v4,prefer-vector-width=512")))
#define T float
#define SUFFIX _wide_float
#include "layers_of_type.h"
#define T double
#define SUFFIX _wide_double
#include "layers_of_type.h"
#endif

void network_layer(const Layer *l)
{
#ifdef MESHONET_WIDE /* a tile in the innermost function is slow when the processor lacks its vectors */
    if (__builtin_cpu_supports("x86-64-v4")) {
        (l->single ? layer_wide_float : layer_wide_double)(l);
        return;
    }
#endif
    (l->single ? layer_float : layer_double)(l);
}
