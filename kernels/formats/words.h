/* Numbers of text; see words.c. */
#pragma once
#include "rows.h"

/* Return how many words there are at the most in n bytes of text. */
ptrdiff_t count_words(const char *text, ptrdiff_t n);

/* Read words of n bytes of text as numbers to `out`, which has `room` for so many, up to the first that is none or that
   no shortcut serves; return how many were read, and in `stop` where the next word starts, or n. */
ptrdiff_t take_numbers(const char *text, ptrdiff_t n, double *out, ptrdiff_t room, ptrdiff_t *stop,
                       const power_of_ten *powers);
