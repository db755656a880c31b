/* Layers of a network over images with adjacent channels. Included once for each real type T, with VECTOR bytes per vector;
   SUFFIX is appended to every name, and KERNEL precedes functions (target processor). */
#define LANES (VECTOR / (int)sizeof(T))
#define MOST_PIXELS 12
#define MOST_VECTORS 4

typedef T NAME(Lanes) __attribute__((vector_size(VECTOR), aligned(sizeof(T)), may_alias));

/* sum (pixels, vectors LANES), lines `pitch` apart = bias + the taps of `pixels` neighbours in a row. Of each pixel
   `rows` runs of `run` numbers count, `line` apart; w has a line of `wide` outputs for each. All sums stay in
   registers. */
MESHONET_INLINE void NAME(tile)(const T *restrict in, ptrdiff_t pixel, ptrdiff_t line, int rows, ptrdiff_t run,
                                const T *restrict w, ptrdiff_t wide, const T *bias, T *sum, ptrdiff_t pitch,
                                const int pixels, const int vectors)
{
    NAME(Lanes) held[MOST_PIXELS][MOST_VECTORS], weight[MOST_VECTORS];
#pragma GCC unroll 16
    for (int p = 0; p < pixels; p++)
#pragma GCC unroll 4
        for (int v = 0; v < vectors; v++)
            held[p][v] = *(const NAME(Lanes) *)(bias + v * LANES);
    for (int r = 0; r < rows; r++) {
        const T *from = in + r * line;
        for (ptrdiff_t k = 0; k < run; k++, w += wide) {
#pragma GCC unroll 4
            for (int v = 0; v < vectors; v++)
                weight[v] = *(const NAME(Lanes) *)(w + v * LANES);
#pragma GCC unroll 16
            for (int p = 0; p < pixels; p++) {
                const T x = from[p * pixel + k];
#pragma GCC unroll 4
                for (int v = 0; v < vectors; v++)
                    held[p][v] += x * weight[v];
            }
        }
    }
#pragma GCC unroll 16
    for (int p = 0; p < pixels; p++)
#pragma GCC unroll 4
        for (int v = 0; v < vectors; v++)
            *(NAME(Lanes) *)(sum + p * pitch + v * LANES) = held[p][v];
}

/* out (pixels, n) of `stride` numbers a pixel = sum (pixels, wide) + add; not inlined: copies of it would be slow to
   compile and no faster. */
static KERNEL __attribute__((noinline)) void NAME(put)(const T *restrict sum, const T *restrict add, T *restrict out,
                                                       int pixels, int n, int wide, ptrdiff_t stride)
{
    for (int p = 0; p < pixels; p++, sum += wide, out += stride) {
        for (int l = 0; l < n; l++)
            out[l] = add ? sum[l] + add[l] : sum[l];
        add = add ? add + stride : add;
    }
}

/* How many pixels of a row of m go together, `vectors` each: what fills the registers and leaves no rest here. */
static int NAME(pixels_of)(int vectors, ptrdiff_t m)
{
#if VECTOR == 64
    const int best = vectors == 4 ? 5 : vectors == 1 ? 11 : 9;
    return m >= best ? best : m >= 5 && vectors == 3 ? 5 : 1;
#else
    (void)vectors;
    return m >= 5 ? 5 : 1;
#endif
}

#define TILE(p, v) case 16 * v + p: \
    NAME(tile)(from, pixel, line, rows, run, w, wide, bias, to, pitch, p, v); break;

/* One row of m outputs; the last tile of a row begins early enough to be whole. Those that go
   `straight` where they belong may go beyond the last pixel, into the row after. */
static KERNEL __attribute__((noinline)) void NAME(row)(const T *in, ptrdiff_t pixel, ptrdiff_t line, int rows,
    ptrdiff_t run, const T *w, ptrdiff_t wide, const T *bias, const T *add, T *out, ptrdiff_t stride, int n,
    int vectors, ptrdiff_t m, int straight)
{
    T sum[MOST_PIXELS * MOST_VECTORS * LANES] __attribute__((aligned(64)));
    const int pixels = NAME(pixels_of)(vectors, m);
    const ptrdiff_t pitch = straight ? stride : vectors * LANES;
    for (ptrdiff_t j = 0; j < m; j += pixels) {
        j = j + pixels > m ? m - pixels : j;
        const T *from = in + j * pixel;
        T *to = straight ? out + j * stride : sum;
        switch (16 * vectors + pixels) {
            TILE(1, 1) TILE(1, 2)
#if VECTOR == 64
            TILE(11, 1) TILE(9, 2) TILE(9, 3) TILE(5, 3) TILE(5, 4) TILE(1, 3) TILE(1, 4)
#else
            TILE(5, 1) TILE(5, 2)
#endif
            default: return; /* no other number of pixels is ever asked for */
        }
        if (!straight)
            NAME(put)(sum, add ? add + j * stride : add, out + j * stride, pixels, n, vectors * LANES, stride);
    }
}

static KERNEL void NAME(convolve)(const T *in, const Convolution *c, const T *w, const T *bias, const T *add, T *out)
{
    const ptrdiff_t rows = (c->m - c->size) / c->stride + 1, m = (c->n - c->size) / c->stride + 1;
    const ptrdiff_t line = c->n * c->inputs, co = c->outputs;
    const ptrdiff_t per = 64 / (ptrdiff_t)sizeof(T), wide = (co + per - 1) / per * per;
    const int all = (int)((co + LANES - 1) / LANES), most = VECTOR == 64 ? 4 : 2, blocks = (all + most - 1) / most;
    for (int block = 0, v = 0; block < blocks; block++) {
        const int vectors = (all - v + blocks - block - 1) / (blocks - block);
        const ptrdiff_t at = (ptrdiff_t)v * LANES, left = co - at;
        const int n = left < vectors * LANES ? (int)left : vectors * LANES;
        const ptrdiff_t past = vectors * LANES - n; /* the end of a pixel; what is there is written later */
        for (ptrdiff_t row = 0; row < c->batch * rows; row++) {
            const ptrdiff_t after = (c->batch * rows - 1 - row) * m * co;
            const int straight = !add && (past == 0 || (blocks == 1 && after >= past));
            const T *from = in + (row / rows * c->m + row % rows * c->stride) * line;
            const ptrdiff_t to = row * m * co + at;
            NAME(row)(from, c->inputs * c->stride, line, c->size, c->size * c->inputs, w + at, wide, bias + at,
                      add ? add + to : add, out + to, co, n, vectors, m, straight);
        }
        v += vectors;
    }
}

/* out (batch, m + 2 pad, n + 2 pad, channels), pad 0 or 1: x / (1 + exp(-x)) inside, zeros around it; with `around`
   its first and last rows are the last and the first of those inside. */
static KERNEL void NAME(activate)(const T *restrict in, ptrdiff_t batch, ptrdiff_t m, ptrdiff_t n, ptrdiff_t channels,
                                  int around, int pad, T *restrict out)
{
    const T most = sizeof(T) == sizeof(float) ? (T)80 : (T)700; /* 1/(1 + exp) is its limit beyond */
    const ptrdiff_t row = n * channels, side = pad ? channels : 0, wide = row + 2 * side, above = pad ? wide : 0;
    for (ptrdiff_t b = 0; b < batch; b++) {
        T *first = out;
        memset(out, 0, (size_t)above * sizeof(T));
        out += above;
        for (ptrdiff_t i = 0; i < m; i++, in += row, out += wide) {
            memset(out, 0, (size_t)side * sizeof(T));
            for (ptrdiff_t k = 0; k < row; k++) {
                const T least = in[k] > most ? most : in[k], x = least < -most ? -most : least;
                out[side + k] = in[k] / ((T)1 + JOIN(exp_, T)(-x));
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

static void NAME(layer)(const Layer *l)
{
    const Convolution *c = &l->c;
    if (l->kind == CONVOLVE)
        NAME(convolve)(l->x, c, l->w, l->bias, l->add, l->out);
    else if (l->kind == ACTIVATE)
        NAME(activate)(l->x, c->batch, c->m, c->n, c->inputs, l->around, c->size, l->out);
    else
        NAME(refine)(l->x, c->batch, c->m, c->n, c->inputs, l->around, l->add, l->out);
}
#undef T
#undef SUFFIX
