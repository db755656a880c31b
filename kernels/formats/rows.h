/* Rows of numbers as text; see rows.c. */
#pragma once
#include <stddef.h>
#include <stdint.h>

/* Most bytes that one number takes. */
enum { MESHONET_INTEGER_BYTES = 20, MESHONET_FLOAT_BYTES = 25 };

/* The m + 1 pieces of text around the m numbers of a row: piece k is text[at[k]] to text[at[k+1]]. */
typedef struct {
    const char *text;
    const ptrdiff_t *at;
    ptrdiff_t m;
} row_form;

/* 10^n, rounded down to (high 2^64 + low) 2^exponent, for n from MESHONET_LEAST_POWER to MESHONET_MOST_POWER. */
typedef struct {
    uint64_t high, low;
    int exponent;
} power_of_ten;

enum { MESHONET_LEAST_POWER = -293, MESHONET_MOST_POWER = 324 };

/* Write n rows of m numbers, int64_t without `powers` and else double, to `out`, which has room; return the bytes written. */
ptrdiff_t put_rows(char *out, const void *rows, ptrdiff_t n, row_form form, const power_of_ten *powers);
