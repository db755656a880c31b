"""Monotone interpolation.

Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304.
"""

import numpy as np

from meshonet.geometry.arrays import Floats


def inner_slopes(h: Floats, delta: Floats) -> Floats:
    """Return slopes (n-1,) between n intervals of lengths `h` and slopes `delta`: weighted harmonic means.

    The cubics with these slopes overshoot in no interval.
    """
    w1, w2 = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
    return np.asarray((w1 + w2) / (w1 / delta[:-1] + w2 / delta[1:]))


def monotone_cubic(x: Floats, y: Floats, at: Floats) -> Floats:
    """Return the monotone cubic through (x, y), both (n,) and increasing, at `at` (m,) within them.

    The slopes at the ends are those of parabolas through three points, limited.
    """
    h, delta = np.diff(x), np.diff(y) / np.diff(x)
    slope = np.full(len(x), delta[0])
    if len(x) > 2:
        slope[1:-1] = inner_slopes(h, delta)
        for end, a, b in ((0, 0, 1), (-1, -1, -2)):
            value = ((2 * h[a] + h[b]) * delta[a] - h[a] * delta[b]) / (h[a] + h[b])
            slope[end] = min(max(value, 0.0), 3 * delta[a])
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(h) - 1)
    t = (at - x[i]) / h[i]
    rise = np.diff(y)[i]
    a, b = h[i] * slope[i], h[i] * slope[i + 1]
    out = y[i] + t * (a + t * ((3 * rise - 2 * a - b) + t * (a + b - 2 * rise)))
    return np.asarray(np.where(at >= x[-1], y[-1], out))


def monotone_through(x: Floats, values: Floats, at: Floats, *, linear: bool = False) -> Floats:
    """Return what goes through `values` (n, ...) at increasing `x` (n,), at `at` (m,) within these.

    Cubics that overshoot in no interval, flat where values stop rising or falling; or straight lines.
    """
    h = np.diff(x)
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(h) - 1)
    along = (-1,) + (1,) * (values.ndim - 1)
    t = ((at - x[i]) / h[i]).reshape(along)
    low, high = values[i], values[i + 1]
    if linear or len(h) == 1:
        return np.asarray((1.0 - t) * low + t * high)  # bitwise both ends
    step = h.reshape(along)
    delta = np.diff(values, axis=0) / step
    w1, w2 = 2 * step[1:] + step[:-1], step[1:] + 2 * step[:-1]
    same = delta[:-1] * delta[1:] > 0
    safe = np.where(same, delta[:-1], 1.0), np.where(same, delta[1:], 1.0)
    inner = np.where(same, (w1 + w2) / (w1 / safe[0] + w2 / safe[1]), 0.0)
    ends = []
    for a, b in ((0, 1), (-1, -2)):
        value = ((2 * step[a] + step[b]) * delta[a] - step[a] * delta[b]) / (step[a] + step[b])
        value = np.where(value * delta[a] > 0, value, 0.0)
        ends.append(np.where(np.abs(value) > 3 * np.abs(delta[a]), 3 * delta[a], value))
    slope = np.concatenate([ends[0][None], inner, ends[1][None]])
    a, b, rise = step[i] * slope[i], step[i] * slope[i + 1], high - low
    out = low + t * (a + t * ((3 * rise - 2 * a - b) + t * (a + b - 2 * rise)))
    return np.asarray(np.where(t >= 1.0, high, out))
