"""From the weights of the quad network to the kernels of ordinary convolutions.

Channels lie as (set, element of the group), the element fastest. Arrays are of numpy or of torch, `xp` is the
module they are of, and the tables come from `symmetry` as arrays of the same.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.solvers.neural.quad.symmetry import ORDER, RELATIVE, TAPS, Integers


def table(size: int) -> Integers:
    """Return (8, 8, size²): where in a set of weights (8 size²,) each tap of the kernel K[h, g] stands."""
    count = size * size
    return np.asarray(RELATIVE[:, :, None] * count + TAPS[size].reshape(ORDER, 1, count))


def convolution(weight: Any, places: Any, xp: Any) -> Any:
    """Return (8 out, 8 in, size, size) from `weight` (out, in, 8, size, size) and `places`, its `table`."""
    out, into, _, size, _ = weight.shape
    spread = weight.reshape(out, into, -1)[:, :, places]
    return xp.moveaxis(spread, 2, 1).reshape(ORDER * out, ORDER * into, size, size)


POINTS: Floats = np.array(
    [
        [1 / 2, 0, 0],
        [-1 / 2, -1 / 2, -1 / 2],
        [-1 / 6, 1 / 6, -1 / 6],
        [1 / 6, 1 / 3, 2 / 3],
        [0, 0, 1],
    ]
)
"""(5, 3) takes the taps of a kernel along an axis to what `winograd.h` multiplies: values at 0, 1, -1, 2 and
infinity, divided by what interpolation through these divides by."""


def at_points(kernel: Floats) -> Floats:
    """Return (out, in, 5, 5) of a kernel (out, in, 3, 3), `POINTS` along both axes."""
    return np.asarray(POINTS @ kernel @ POINTS.T)


def lift(weight: Any, seen: Any, xp: Any) -> Any:
    """Return (8 out, FEATURES) from `weight` (out, FEATURES): the features as seen from each element."""
    return xp.einsum("cf,gfk->cgk", weight, seen).reshape(ORDER * len(weight), -1)


def projection(weight: Any, elements: Any, xp: Any) -> Any:
    """Return (2 heads, 8 in) from `weight` (heads, 2, in): vectors brought back from each element."""
    back = xp.einsum("gda,hac->hdcg", elements, weight) / ORDER
    return back.reshape(2 * len(weight), -1)
