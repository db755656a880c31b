/* Convolutions by 3 x 3 taps in fewer products: 3 x 3 outputs together take 25 for each pair of channels, not 81.

   Along an axis, five inputs d and taps g make three outputs: A ((G g) (B d)), from values of polynomials at 0, 1,
   -1, 2 and infinity. Winograd, Arithmetic Complexity of Computations, SIAM 1980; Lavin & Gray, CVPR 2016.
   Goes after convolve.h, whose names it uses. */
static const T NAME(nothing)[MOST_VECTORS * LANES];

/* B on five vectors, `step` apart, in place. */
MESHONET_INLINE void NAME(spread)(NAME(Lanes) *d, const int step)
{
    const NAME(Lanes) d1 = d[step], d2 = d[2 * step], e = d[3 * step] - d1;
    d[0] = (d[0] - d2) * 2 + e;
    d[step] = e - (d1 + d2);
    d[2 * step] = e - (d2 - d1) * 3;
    d[3 * step] = e;
    d[4 * step] = (d[4 * step] - d2) - e * 2;
}

/* A on five vectors, `step` apart: the first three are the outputs. */
MESHONET_INLINE void NAME(gather)(NAME(Lanes) *d, const int step)
{
    const NAME(Lanes) sum = d[step] + d[2 * step], other = d[step] - d[2 * step], at2 = d[3 * step];
    d[0] = d[0] + sum + at2;
    d[step] = other + at2 * 2;
    d[2 * step] = sum + at2 * 4 + d[4 * step];
}

/* v (WINOGRAD_VALUES, channels), `plane` numbers apart, of 5 x 5 pixels whose rows are `line` apart. */
static KERNEL __attribute__((noinline)) void NAME(before)(const T *restrict in, ptrdiff_t line, ptrdiff_t channels,
                                                          T *restrict v, ptrdiff_t plane)
{
    for (ptrdiff_t c = 0; c < channels; c += LANES) {
        c = c + LANES > channels ? channels - LANES : c;
        NAME(Lanes) d[WINOGRAD_VALUES];
#pragma GCC unroll 5
        for (int i = 0; i < 5; i++) {
#pragma GCC unroll 5
            for (int j = 0; j < 5; j++)
                d[5 * i + j] = *(const NAME(Lanes) *)(in + i * line + j * channels + c);
            NAME(spread)(d + 5 * i, 1);
        }
#pragma GCC unroll 5
        for (int j = 0; j < 5; j++) {
            NAME(spread)(d + j, 5);
#pragma GCC unroll 5
            for (int i = 0; i < 5; i++)
                *(NAME(Lanes) *)(v + (5 * i + j) * plane + c) = d[5 * i + j];
        }
    }
}

/* 3 x 3 pixels of out = those of sums (WINOGRAD_VALUES, channels), `plane` apart, + bias + add. */
static KERNEL __attribute__((noinline)) void NAME(after)(const T *restrict sums, ptrdiff_t plane,
    const T *restrict bias, const T *restrict add, T *restrict out, ptrdiff_t line, ptrdiff_t channels)
{
    for (ptrdiff_t c = 0; c < channels; c += LANES) {
        c = c + LANES > channels ? channels - LANES : c;
        const NAME(Lanes) more = *(const NAME(Lanes) *)(bias + c);
        NAME(Lanes) d[WINOGRAD_VALUES];
#pragma GCC unroll 5
        for (int i = 0; i < 5; i++) {
#pragma GCC unroll 5
            for (int j = 0; j < 5; j++)
                d[5 * i + j] = *(const NAME(Lanes) *)(sums + (5 * i + j) * plane + c);
            NAME(gather)(d + 5 * i, 1);
        }
#pragma GCC unroll 3
        for (int j = 0; j < 3; j++) {
            NAME(gather)(d + j, 5);
#pragma GCC unroll 3
            for (int i = 0; i < 3; i++) {
                const ptrdiff_t at = i * line + j * channels + c;
                NAME(Lanes) sum = d[5 * i + j] + more;
                if (add)
                    sum += *(const NAME(Lanes) *)(add + at);
                *(NAME(Lanes) *)(out + at) = sum;
            }
        }
    }
}

#define PRODUCT(p, v) case 16 * v + p: \
    NAME(tile)(from, into, 0, 1, into, w, wide, NAME(nothing), to, wide, p, v); break;

/* sums (count, vectors) = v (count, into) times w (into, vectors); a line of w or sums has `wide` numbers. */
static KERNEL __attribute__((noinline)) void NAME(products)(const T *v, ptrdiff_t into, const T *w, ptrdiff_t wide,
                                                            T *sums, ptrdiff_t count, int vectors)
{
#if VECTOR == 64
    const int best = vectors == 4 ? 4 : vectors == 1 ? 12 : 9;
#else
    const int best = 5;
#endif
    const int pixels = count >= best ? best : 1;
    for (ptrdiff_t k = 0; k < count; k += pixels) {
        k = k + pixels > count ? count - pixels : k;
        const T *from = v + k * into;
        T *to = sums + k * wide;
        switch (16 * vectors + pixels) {
            PRODUCT(1, 1) PRODUCT(1, 2)
#if VECTOR == 64
            PRODUCT(12, 1) PRODUCT(9, 2) PRODUCT(9, 3) PRODUCT(4, 4) PRODUCT(1, 3) PRODUCT(1, 4)
#else
            PRODUCT(5, 1) PRODUCT(5, 2)
#endif
            default: return; /* no other number of pixels is ever asked for */
        }
    }
}

/* Place along an axis of n outputs where the tile k begins; the last ends with the axis. */
static ptrdiff_t NAME(begin)(ptrdiff_t k, ptrdiff_t n)
{
    return 3 * k + 3 > n ? n - 3 : 3 * k;
}

static KERNEL void NAME(winograd)(const T *in, const Convolution *c, const T *w, const T *bias, const T *add,
                                  T *scratch, T *out)
{
    const ptrdiff_t m = c->m - 2, n = c->n - 2, down = (m + 2) / 3, along = (n + 2) / 3, all = c->batch * down * along;
    const ptrdiff_t ci = c->inputs, co = c->outputs, per = 64 / (ptrdiff_t)sizeof(T), wide = (co + per - 1) / per * per;
    const ptrdiff_t blocks = (all + WINOGRAD_TILES - 1) / WINOGRAD_TILES, most = (all + blocks - 1) / blocks;
    const ptrdiff_t plane = WINOGRAD_PLANE(ci, per), sum = WINOGRAD_PLANE(wide, per);
    const int vectors = (int)((co + LANES - 1) / LANES), some = VECTOR == 64 ? 4 : 2;
    const int parts = (vectors + some - 1) / some;
    T *v = scratch, *sums = scratch + WINOGRAD_VALUES * plane;
    for (ptrdiff_t first = 0; first < all; first += most) {
        const ptrdiff_t count = first + most > all ? all - first : most;
        for (int put = 0; put < 2; put++) {
            ptrdiff_t image = first / (down * along), i = first / along % down, j = first % along;
            for (ptrdiff_t k = 0; k < count; k++) {
                const ptrdiff_t row = NAME(begin)(i, m), column = NAME(begin)(j, n);
                const ptrdiff_t at = ((image * m + row) * n + column) * co;
                if (put)
                    NAME(after)(sums + k * wide, sum, bias, add ? add + at : add, out + at, n * co, co);
                else
                    NAME(before)(in + ((image * c->m + row) * c->n + column) * ci, c->n * ci, ci, v + k * ci, plane);
                if (++j == along) {
                    j = 0;
                    if (++i == down)
                        i = 0, image++;
                }
            }
            for (int value = 0; value < WINOGRAD_VALUES && !put; value++)
                for (int part = 0, at = 0; part < parts; part++) {
                    const int here = (vectors - at + parts - part - 1) / (parts - part);
                    NAME(products)(v + value * plane, ci, w + value * ci * wide + at * LANES, wide,
                                   sums + value * sum + at * LANES, count, here);
                    at += here;
                }
        }
    }
}
#undef PRODUCT
#undef TILE
#undef LANES
#undef NAME
#undef MOST_PIXELS
#undef MOST_VECTORS
