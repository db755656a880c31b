"""Monotone piecewise cubics: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304."""

import numpy as np

from meshonet.geometry.arrays import Floats, Indices


def inner_slopes(h: Floats, delta: Floats) -> Floats:
    """Return slopes (n-1, ...) between n intervals that have the lengths `h` and mean slopes `delta`.

    A slope is a weighted harmonic mean of the mean slopes on both sides, or 0 if these differ in sign.
    """
    w1, w2 = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        means = (w1 + w2) / (w1 / delta[:-1] + w2 / delta[1:])
    return np.where(delta[:-1] * delta[1:] > 0, means, 0.0)


def monotone_cubic(x: Floats, values: Floats, at: Floats, *, linear: bool = False) -> Floats:
    """Return values (m, ...) at `at` (m,) of the curve through `values` (n, ...) at ascending `x` (n,).

    The curve is piecewise cubic, monotone in each interval and flat at extrema. With `linear` it is piecewise
    linear.
    """
    i, t, _ = piece_at(x, at, values.ndim)
    low, high = values[i], values[i + 1]
    if linear:
        return np.asarray((1.0 - t) * low + t * high)  # bitwise exact at both ends
    step = np.diff(x).reshape((-1,) + (1,) * (values.ndim - 1))
    slope = _slopes(step, np.diff(values, axis=0) / step)
    a, b = step[i] * slope[i], step[i] * slope[i + 1]
    return hermite_piece(t, low, high, a, b)


def piece_at(x: Floats, at: Floats, dimension: int) -> tuple[Indices, Floats, Floats]:
    """Return the interval between knots `x` (n,) in which each of `at` (m,) is, and where in the interval.

    The results are the index (m,) of the interval, the position as a fraction of the interval, and the
    interval's length. Position and length are arrays (m, 1, ..., 1), each with `dimension` axes.
    """
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    h, shape = x[i + 1] - x[i], (*at.shape, *(1,) * (dimension - 1))
    return i, ((at - x[i]) / h).reshape(shape), h.reshape(shape)


def hermite_piece(t: Floats, low: Floats, high: Floats, a: Floats, b: Floats) -> Floats:
    """Return cubics at t (0 to 1) with end values `low`, `high` and end derivatives `a`, `b`."""
    rise = high - low
    out = low + t * (a + t * ((3 * rise - 2 * a - b) + t * (a + b - 2 * rise)))
    return np.asarray(np.where(t >= 1.0, high, out))


def _slopes(step: Floats, delta: Floats) -> Floats:
    if len(delta) == 1:
        return np.concatenate([delta, delta])
    ends = []
    for a, b in ((0, 1), (-1, -2)):
        value = ((2 * step[a] + step[b]) * delta[a] - step[a] * delta[b]) / (step[a] + step[b])
        value = np.where(value * delta[a] > 0, value, 0.0)
        ends.append(np.where(np.abs(value) > 3 * np.abs(delta[a]), 3 * delta[a], value))
    return np.concatenate([ends[0][None], inner_slopes(step, delta), ends[1][None]])
