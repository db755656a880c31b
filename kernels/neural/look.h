/* Features of a grid and of its last step at every node, in the order of encoding.py. Differences are computed in double,
   everything else in the real type T; SUFFIX is appended to every name. */

MESHONET_INLINE void NAME(look_row)(const double *restrict x, const double *restrict y, const double *restrict dx,
                                    const double *restrict dy, double size, ptrdiff_t n, ptrdiff_t i,
                                    T (*restrict row)[LOOK_MOST], T *restrict out)
{
    const double cells = (double)(n - 1);
    const ptrdiff_t before = i > 0 ? -n : 0, after = i < n - 1 ? n : 0;
    const double steep = before && after ? 0.5 * cells : cells, bend = before && after ? 2.0 * cells : 0.0;
    x += i * n, y += i * n, dx += i * n, dy += i * n;
    for (ptrdiff_t j = 0; j < n; j++) {
        row[0][j] = steep * (x[j + after] - x[j + before]);
        row[2][j] = steep * (y[j + after] - y[j + before]);
        row[4][j] = bend * (x[j + after] + x[j + before] - 2.0 * x[j]);
        row[6][j] = bend * (y[j + after] + y[j + before] - 2.0 * y[j]);
        row[10][j] = x[j], row[11][j] = y[j];
        row[15][j] = -1.0 + 2.0 * (double)i / cells, row[16][j] = -1.0 + 2.0 * (double)j / cells;
    }
    for (ptrdiff_t j = 1; j < n - 1; j++) {
        row[1][j] = 0.5 * cells * (x[j + 1] - x[j - 1]);
        row[3][j] = 0.5 * cells * (y[j + 1] - y[j - 1]);
        row[5][j] = 2.0 * cells * (x[j + 1] + x[j - 1] - 2.0 * x[j]);
        row[7][j] = 2.0 * cells * (y[j + 1] + y[j - 1] - 2.0 * y[j]);
    }
    for (int end = 0; end < 2; end++) {
        const ptrdiff_t j = end ? n - 1 : 0, k = end ? n - 2 : 0;
        row[1][j] = cells * (x[k + 1] - x[k]), row[3][j] = cells * (y[k + 1] - y[k]);
        row[5][j] = row[7][j] = 0.0;
    }
    const T one = 1, tiny = (T)LOOK_TINY, grow = (T)(1.0 / size);
    for (ptrdiff_t j = 0; j < n; j++) {
        const T ur = row[0][j], vr = row[1][j], ui = row[2][j], vi = row[3][j];
        const T u = JOIN(sqrt_, T)(ur * ur + ui * ui), v = JOIN(sqrt_, T)(vr * vr + vi * vi), w = one / (u * v + tiny);
        const T dot = ur * vr + ui * vi, cross = ur * vi - ui * vr, area = cross < 0 ? -cross : cross;
        row[8][j] = u + (T)LOOK_FLOOR, row[9][j] = v + (T)LOOK_FLOOR;
        row[12][j] = dot * w, row[13][j] = cross * w;
        row[14][j] = area + JOIN(sqrt_, T)(cross * cross + one);
    }
    for (ptrdiff_t j = 0; j < n; j++) {
        const T p = (T)dx[j], q = (T)dy[j], length = JOIN(sqrt_, T)(p * p + q * q + tiny * tiny), inverse = one / length;
        const T drawn = (T)LOOK_STRETCH * grow * length;
        row[17][j] = p * ((T)0.5 * inverse), row[18][j] = q * ((T)0.5 * inverse);
        row[19][j] = drawn + JOIN(sqrt_, T)(drawn * drawn + one);
    }
    T logs[4][LOOK_MOST]; /* the last two: of inverse hyperbolic sines without their signs */
    const int where[4] = {8, 9, 14, 19};
    for (int k = 0; k < 4; k++)
        for (ptrdiff_t j = 0; j < n; j++)
            logs[k][j] = JOIN(log_, T)(row[where[k]][j]);
    for (ptrdiff_t j = 0; j < n; j++)
        logs[2][j] = row[13][j] < 0 ? -logs[2][j] : logs[2][j];
    const T scale = (T)(log10(size) + 2.0);
    for (ptrdiff_t j = 0; j < n; j++, out += LOOK_FEATURES) {
        for (int k = 0; k < LOOK_FEATURES; k++)
            out[k] = row[k][j];
        out[8] = logs[0][j], out[9] = logs[1][j], out[14] = logs[2][j];
        out[17] *= logs[3][j], out[18] *= logs[3][j], out[19] = scale;
    }
}

MESHONET_CLONES
void NAME(network_look)(const double *planes, const double *steps, ptrdiff_t batch, ptrdiff_t n, T *out)
{
    T row[LOOK_FEATURES][LOOK_MOST];
    const ptrdiff_t plane = n * n;
    for (ptrdiff_t b = 0; b < batch; b++, planes += 2 * plane, steps += 2 * plane) {
        const double square = product_of(steps, steps, 2 * plane), size = sqrt(square / (double)plane + LOOK_TINY * LOOK_TINY) + LOOK_STILL;
        for (ptrdiff_t i = 0; i < n; i++, out += n * LOOK_FEATURES)
            NAME(look_row)(planes, planes + plane, steps, steps + plane, size, n, i, row, out);
    }
}
#undef T
#undef SUFFIX
