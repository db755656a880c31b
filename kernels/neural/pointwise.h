/* What stands between convolutions: activation with padding, and finer copies. Included once for each real type T, with
   SUFFIX after every name, EXP its exponential up to MOST, and KERNEL before functions (their processor). */
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define NAME(name) JOIN(name, SUFFIX)

/* out (batch, m + 2 pad, n + 2 pad, channels), pad 0 or 1: x / (1 + exp(-x)) inside, zeros around it; with `around`
   its first and last rows are the last and the first of those inside. */
static KERNEL void NAME(activate)(const T *restrict in, ptrdiff_t batch, ptrdiff_t m, ptrdiff_t n, ptrdiff_t channels,
                                  int around, int pad, T *restrict out)
{
    const ptrdiff_t row = n * channels, side = pad ? channels : 0, wide = row + 2 * side, above = pad ? wide : 0;
    for (ptrdiff_t b = 0; b < batch; b++) {
        T *first = out;
        memset(out, 0, (size_t)above * sizeof(T));
        out += above;
        for (ptrdiff_t i = 0; i < m; i++, in += row, out += wide) {
            memset(out, 0, (size_t)side * sizeof(T));
            for (ptrdiff_t k = 0; k < row; k++) {
                const T least = in[k] > MOST ? MOST : in[k], x = least < -MOST ? -MOST : least;
                out[side + k] = in[k] / ((T)1 + EXP(-x));
            }
            memset(out + side + row, 0, (size_t)side * sizeof(T));
        }
        memset(out, 0, (size_t)above * sizeof(T));
        if (around && pad) {
            memcpy(first, out - wide, (size_t)wide * sizeof(T));
            memcpy(out, first + wide, (size_t)wide * sizeof(T));
        }
        out += above;
    }
}

/* out (batch, 2 m - 1, 2 n - 1, channels) = add + `in` (batch, m, n, channels) between its nodes; with `around` there
   are 2 m rows, the last between the last and the first. */
static KERNEL void NAME(refine)(const T *restrict in, ptrdiff_t batch, ptrdiff_t m, ptrdiff_t n, ptrdiff_t channels,
                                int around, const T *restrict add, T *restrict out)
{
    const ptrdiff_t rows = around ? 2 * m : 2 * m - 1, columns = 2 * n - 1;
    for (ptrdiff_t b = 0; b < batch; b++, in += m * n * channels)
        for (ptrdiff_t i = 0; i < rows; i++) {
            const ptrdiff_t next = ((i >> 1) + (i & 1)) % m;
            for (ptrdiff_t j = 0; j < columns; j++, add += channels, out += channels) {
                const T *sw = in + ((i >> 1) * n + (j >> 1)) * channels, *se = in + (next * n + (j >> 1)) * channels;
                const T *nw = sw + (j & 1) * channels, *ne = se + (j & 1) * channels;
                for (ptrdiff_t k = 0; k < channels; k++)
                    out[k] = add[k] + (T)0.25 * ((sw[k] + ne[k]) + (se[k] + nw[k]));
            }
        }
}
#undef NAME
