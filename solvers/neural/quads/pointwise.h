/* What stands between convolutions: activation with padding, and finer copies. Included once for each real type T. */
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define NAME(name) JOIN(name, SUFFIX)

/* out (batch, n + 2, n + 2, channels): x / (1 + exp(-x)) inside, zeros around it. */
MESHONET_CLONES
void NAME(network_activate)(const T *restrict in, ptrdiff_t batch, ptrdiff_t n, ptrdiff_t channels, T *restrict out)
{
    const ptrdiff_t row = n * channels, wide = row + 2 * channels;
    for (ptrdiff_t b = 0; b < batch; b++) {
        memset(out, 0, (size_t)wide * sizeof(T));
        out += wide;
        for (ptrdiff_t i = 0; i < n; i++, in += row, out += wide) {
            memset(out, 0, (size_t)channels * sizeof(T));
            for (ptrdiff_t k = 0; k < row; k++)
                out[channels + k] = in[k] / ((T)1 + EXP(-in[k]));
            memset(out + channels + row, 0, (size_t)channels * sizeof(T));
        }
        memset(out, 0, (size_t)wide * sizeof(T));
        out += wide;
    }
}

/* out (batch, n, n, channels) = add + `in` (batch, m, m, channels) between its nodes, n = 2 m - 1. */
MESHONET_CLONES
void NAME(network_refine)(const T *restrict in, ptrdiff_t batch, ptrdiff_t m, ptrdiff_t channels,
                          const T *restrict add, T *restrict out)
{
    const ptrdiff_t n = 2 * m - 1;
    for (ptrdiff_t b = 0; b < batch; b++, in += m * m * channels)
        for (ptrdiff_t i = 0; i < n; i++)
            for (ptrdiff_t j = 0; j < n; j++, add += channels, out += channels) {
                const T *sw = in + ((i >> 1) * m + (j >> 1)) * channels, *se = sw + (i & 1) * m * channels;
                const T *nw = sw + (j & 1) * channels, *ne = se + (j & 1) * channels;
                for (ptrdiff_t k = 0; k < channels; k++)
                    out[k] = add[k] + (T)0.25 * ((sw[k] + ne[k]) + (se[k] + nw[k]));
            }
}
#undef NAME
