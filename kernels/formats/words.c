/* Numbers of text in Fortran's free format: blanks, commas or line ends between them, exponents with e, d or q, or
   without a letter. Rounded correctly, to even. */
#include "words.h"
#include "clones.h"
#include <string.h>

enum { MOST_DIGITS = 19, EXACT_POWER = 22 };
static const double EXACT[EXACT_POWER + 1] = {
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
};

MESHONET_CLONES
ptrdiff_t count_words(const char *text, ptrdiff_t n)
{
    ptrdiff_t count = 0;
    for (ptrdiff_t from = 0; from < n; from += 128) { /* of 128 bytes at a time, whose count fits in one */
        const ptrdiff_t to = from + 128 < n ? from + 128 : n;
        unsigned char some = 0;
        for (ptrdiff_t k = from > 0 ? from : 1; k < to; k++) {
            const unsigned char here = (unsigned char)text[k], before = (unsigned char)text[k - 1];
            const unsigned char begins = !(here <= ' ' || here == ',' || here == ';');
            const unsigned char ended = before <= ' ' || before == ',' || before == ';';
            some = (unsigned char)(some + (begins & ended));
        }
        count += some;
    }
    return count + 1;
}

static int separates(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r') || c == ',' || c == ';' || c == '\x1a';
}

/* Write m 10^q, rounded, and return 1; or 0 where 128 bits of the power of ten leave the rounding open, or the number
   is subnormal or too large. The product of the 64 leading bits of m and of the power is known to less than two units
   of its upper 128 bits (Lemire, Software: Practice and Experience 51 (2021) 1700). */
static int rounded(uint64_t m, int q, const power_of_ten *powers, uint64_t *bits)
{
    if (q < MESHONET_LEAST_POWER || q > MESHONET_MOST_POWER)
        return 0;
    const power_of_ten p = powers[q - MESHONET_LEAST_POWER];
    const int zeros = __builtin_clzll(m);
    const uint64_t w = m << zeros;
    const unsigned __int128 top = (unsigned __int128)w * p.high + (uint64_t)((unsigned __int128)w * p.low >> 64);
    const int shift = (int)(top >> 127) + 74;
    const unsigned __int128 one = (unsigned __int128)1 << shift, half = one >> 1, rest = top & (one - 1);
    if (rest <= half && rest + 2 > half)
        return 0;
    uint64_t digits = (uint64_t)(top >> shift) + (rest > half);
    int biased = p.exponent + 64 - zeros + shift + 52 + 1023;
    if (digits >> 53) {
        digits >>= 1;
        biased++;
    }
    if (biased < 1 || biased > 2046)
        return 0;
    *bits = (uint64_t)biased << 52 | (digits & (((uint64_t)1 << 52) - 1));
    return 1;
}

static int value_of(uint64_t m, int q, int cut, const power_of_ten *powers, double *value)
{
    if (!cut && m >> 53 == 0 && q >= -EXACT_POWER && q <= EXACT_POWER) {
        *value = q < 0 ? (double)m / EXACT[-q] : (double)m * EXACT[q];
        return 1;
    }
    uint64_t bits = 0, above = 0;
    if (m == 0) {
        if (cut)
            return 0;
    } else if (!rounded(m, q, powers, &bits) || (cut && (!rounded(m + 1, q, powers, &above) || bits != above))) {
        return 0;
    }
    memcpy(value, &bits, sizeof bits);
    return 1;
}

/* Return the end of the number that starts at `at`, or NULL where there is none or no shortcut serves it. */
static const char *number(const char *at, const char *end, const power_of_ten *powers, double *value)
{
    const int negative = *at == '-';
    if (negative || *at == '+')
        at++;
    uint64_t m = 0;
    int kept = 0, q = 0, cut = 0, digits = 0;
    for (int behind = 0; at < end; at++) {
        const unsigned digit = (unsigned)*at - '0';
        if (digit < 10) {
            digits = 1;
            if (kept < MOST_DIGITS) {
                m = 10 * m + digit;
                kept += m != 0;
                q -= behind;
            } else {
                cut |= digit != 0;
                q += !behind;
            }
        } else if (*at == '.' && !behind) {
            behind = 1;
        } else {
            break;
        }
    }
    if (!digits)
        return NULL;
    if (at < end && !separates(*at)) {
        const char letter = (char)(*at | 0x20);
        if (letter == 'e' || letter == 'd' || letter == 'q')
            at++;
        else if (*at != '+' && *at != '-')
            return NULL;
        const int below = at < end && *at == '-';
        if (at < end && (*at == '-' || *at == '+'))
            at++;
        int power = 0, places = 0;
        for (; at < end && (unsigned)*at - '0' < 10 && places < 5; at++, places++)
            power = 10 * power + (*at - '0');
        if (places == 0 || places == 5 || (at < end && !separates(*at)))
            return NULL;
        q += below ? -power : power;
    }
    if (!value_of(m, q, cut, powers, value))
        return NULL;
    if (negative)
        *value = -*value;
    return at;
}

ptrdiff_t take_numbers(const char *text, ptrdiff_t n, double *out, ptrdiff_t room, ptrdiff_t *stop,
                       const power_of_ten *powers)
{
    const char *at = text, *const end = text + n;
    ptrdiff_t count = 0;
    for (;;) {
        while (at < end && separates(*at))
            at++;
        if (at == end || count == room)
            break;
        const char *behind = number(at, end, powers, out + count);
        if (!behind)
            break;
        at = behind;
        count++;
    }
    *stop = at - text;
    return count;
}
