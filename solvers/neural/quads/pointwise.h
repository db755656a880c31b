/* What stands between convolutions: activation with padding, and finer copies. Included once for each real type T. */
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define NAME(name) JOIN(name, SUFFIX)

/* out (batch, m + 2, n + 2, channels): x / (1 + exp(-x)) inside, zeros around it; with `around` its first and last
   rows are the last and the first of those inside. */
MESHONET_CLONES
void NAME(network_activate)(const T *restrict in, ptrdiff_t batch, ptrdiff_t m, ptrdiff_t n, ptrdiff_t channels,
                            int around, T *restrict out)
{
    const ptrdiff_t row = n * channels, wide = row + 2 * channels;
    for (ptrdiff_t b = 0; b < batch; b++) {
        T *first = out;
        memset(out, 0, (size_t)wide * sizeof(T));
        out += wide;
        for (ptrdiff_t i = 0; i < m; i++, in += row, out += wide) {
            memset(out, 0, (size_t)channels * sizeof(T));
            for (ptrdiff_t k = 0; k < row; k++)
                out[channels + k] = in[k] / ((T)1 + EXP(-in[k]));
            memset(out + channels + row, 0, (size_t)channels * sizeof(T));
        }
        memset(out, 0, (size_t)wide * sizeof(T));
        if (around) {
            memcpy(first, out - wide, (size_t)wide * sizeof(T));
            memcpy(out, first + wide, (size_t)wide * sizeof(T));
        }
        out += wide;
    }
}

/* out (batch, 2 m - 1, 2 n - 1, channels) = add + `in` (batch, m, n, channels) between its nodes; with `around` there
   are 2 m rows, the last between the last and the first. */
MESHONET_CLONES
void NAME(network_refine)(const T *restrict in, ptrdiff_t batch, ptrdiff_t m, ptrdiff_t n, ptrdiff_t channels,
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
