/* Rows of numbers as text, for mesh files of solvers: whole numbers two digits at a time, floats with the 17
   significant digits that bring every bit back. */
#include "rows.h"
#include <stdio.h>
#include <string.h>

static const char PAIRS[] =
    "00010203040506070809101112131415161718192021222324252627282930313233343536373839404142434445464748495051525354"
    "5556575859606162636465666768697071727374757677787980818283848586878889909192939495969798" "99";

static char *put(char *out, const char *text, ptrdiff_t count)
{
    memcpy(out, text, (size_t)count);
    return out + count;
}

static char *put_integer(char *out, int64_t value)
{
    char digits[MESHONET_INTEGER_BYTES];
    char *at = digits + sizeof digits;
    uint64_t left = value < 0 ? 0 - (uint64_t)value : (uint64_t)value;
    while (left >= 100) {
        at -= 2;
        memcpy(at, PAIRS + 2 * (left % 100), 2);
        left /= 100;
    }
    if (left >= 10) {
        at -= 2;
        memcpy(at, PAIRS + 2 * left, 2);
    } else {
        *--at = (char)('0' + left);
    }
    if (value < 0)
        *out++ = '-';
    return put(out, at, digits + sizeof digits - at);
}

/* What no shortcut serves: not finite, subnormal, or too near the middle of two roundings. */
static char *put_float_slowly(char *out, double value)
{
    char *end = out + snprintf(out, MESHONET_FLOAT_BYTES, "%.16e", value);
    for (char *at = out; at < out + 3; at++)
        if (*at == ',') /* a locale's decimal point */
            *at = '.';
    return end;
}

static char *put_exponent(char *out, int k)
{
    *out++ = 'e';
    *out++ = k < 0 ? '-' : '+';
    k = k < 0 ? -k : k;
    if (k >= 100)
        *out++ = (char)('0' + k / 100);
    return put(out, PAIRS + 2 * (k % 100), 2);
}

/* The 17 digits d_0 ... d_16 and the exponent k of |value| = d_0.d_1 ... d_16 10^k are those of the integer next to
   |value| 10^(16-k), which is m 2^e times a power of ten known to 128 bits: an error below one unit of the upper
   128 bits of their product, so that only a fraction next to one half leaves the rounding open. */
static char *put_float(char *out, double value, const power_of_ten *powers)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    const int biased = (int)(bits >> 52 & 0x7ff);
    if (!(bits << 1)) {
        if (bits)
            *out++ = '-';
        return put(out, "0.0000000000000000e+00", 22);
    }
    if (biased == 0 || biased == 0x7ff)
        return put_float_slowly(out, value);
    const uint64_t m = (bits << 11) | (uint64_t)1 << 63;
    int k = (int)(((int64_t)(biased - 1023) * 1292913986) >> 32); /* floor of the logarithm of 2^(biased-1023) */
    for (;;) {
        const power_of_ten p = powers[16 - k - MESHONET_LEAST_POWER];
        const unsigned __int128 top = (unsigned __int128)m * p.high + (uint64_t)((unsigned __int128)m * p.low >> 64);
        const int shift = 1022 - biased - p.exponent; /* top 2^-shift is |value| 10^(16-k) */
        const unsigned __int128 one = (unsigned __int128)1 << shift, half = one >> 1, rest = top & (one - 1);
        uint64_t digits = (uint64_t)(top >> shift);
        if (digits >= 100000000000000000) {
            k++;
            continue;
        }
        if (rest + 2 >= half && rest <= half + 2)
            return put_float_slowly(out, value);
        digits += rest > half;
        if (digits == 100000000000000000) {
            digits /= 10;
            k++;
        }
        if (bits >> 63)
            *out++ = '-';
        char *at = out + 18;
        for (; at > out + 2; digits /= 100)
            memcpy(at -= 2, PAIRS + 2 * (digits % 100), 2);
        out[0] = (char)('0' + digits);
        out[1] = '.';
        return put_exponent(out + 18, k);
    }
}

ptrdiff_t put_rows(char *out, const void *rows, ptrdiff_t n, row_form form, const power_of_ten *powers)
{
    char *at = out;
    for (ptrdiff_t k = 0; k < n; k++) {
        for (ptrdiff_t m = 0; m < form.m; m++) {
            at = put(at, form.text + form.at[m], form.at[m + 1] - form.at[m]);
            at = powers ? put_float(at, ((const double *)rows)[k * form.m + m], powers)
                        : put_integer(at, ((const int64_t *)rows)[k * form.m + m]);
        }
        at = put(at, form.text + form.at[form.m], form.at[form.m + 1] - form.at[form.m]);
    }
    return at - out;
}
