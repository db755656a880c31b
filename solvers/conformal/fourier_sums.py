"""Fourier sums at any number of equal steps of theta, through FFTs whose length is a power of two."""

from functools import lru_cache

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, read_only
from meshonet.geometry.elementary import cos, exp, product
from meshonet.kernels._native import fourier_columns

TAPS = 14  # as in kernels/conformal/strip_rows.h
LANES = 8  # as in lanes.h
SHARPNESS = 2.30 * TAPS  # b
FEWEST = 256  # columns


def columns(modes: Complexes) -> Floats:
    """Return a table (Q, 2, width) from which m Fourier series can be evaluated quickly at any angle.

    `modes` (m, 2 K + 1) are the coefficients c_k of the series for k = 0 .. K, -K .. -1. A series becomes a
    sum over Q angles theta_q in equal steps. All but `TAPS` terms are 0: w = 0 at |x| > 1::

        sum_k c_k exp(i k theta) = sum_q w(theta - theta_q) f_q,      f_q = sum_k c_k / v_k exp(i k theta_q)
        w(theta) = exp(b (sqrt(1 - x^2) - 1)),    x = Q theta / (pi TAPS),    |x| < 1,    b = 2.3 TAPS
        v_k = sum_q w(theta_q) exp(-i k theta_q),    theta_q = 2 pi q / Q

    The axes of the table are q, the real and imaginary part of f_q, and the series. `width` is m, rounded up
    to a multiple of `LANES`. Q is a power of two above 4 K. The error is about exp(-pi TAPS sqrt(1/2)) =
    3e-14 of the largest mode. Barnett, Magland & af Klinteberg, SIAM J. Sci. Comput. 41 (2019) C479.
    """
    count, wide = len(modes), -(-len(modes) // LANES) * LANES
    highest = modes.shape[1] // 2
    gain, unit = _transform(max(FEWEST, 1 << (4 * highest + 3).bit_length()))  # Q >= 4 highest + 4
    samples = np.zeros((2 * len(unit), 2, wide))
    if count:
        fourier_columns(np.ascontiguousarray(modes), gain, unit, samples)
    return samples


@lru_cache(maxsize=16)
def _transform(count: int) -> tuple[Floats, Complexes]:
    """Return 1 / v_k for k = 0 .. count / 4 by the trapezoidal rule, whose error is exp(-b)."""
    steps = 8 * TAPS
    x = np.arange(-steps, steps + 1) / steps
    window = exp(SHARPNESS * (np.sqrt(np.maximum(1.0 - x * x, 0.0)) - 1.0))
    angle = np.pi * TAPS / count * np.outer(np.arange(count // 4 + 1), x)
    unit = exp(2j * np.pi * np.arange(count // 2) / count)
    gain: Floats = steps / (0.5 * TAPS) / product(cos(angle), window)
    return read_only(gain), read_only(unit)
