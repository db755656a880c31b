"""From the weights of the quad network to the kernels of ordinary convolutions.

Channels lie as (set, element of the group), the element fastest. Arrays are of numpy or of torch, `xp` is the
module they are of, and the tables come from `symmetry` as arrays of the same.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from solvers.neural.quads.symmetry import ORDER, RELATIVE, TAPS, Integers


def table(size: int) -> Integers:
    """Return (8, 8, size²): where in a set of weights (8 size²,) each tap of the kernel K[h, g] stands."""
    count = size * size
    return np.asarray(RELATIVE[:, :, None] * count + TAPS[size].reshape(ORDER, 1, count))


def convolution(weight: Any, places: Any, xp: Any) -> Any:
    """Return (8 out, 8 in, size, size) from `weight` (out, in, 8, size, size) and `places`, its `table`."""
    out, into, _, size, _ = weight.shape
    spread = weight.reshape(out, into, -1)[:, :, places]
    return xp.moveaxis(spread, 2, 1).reshape(ORDER * out, ORDER * into, size, size)


def lift(weight: Any, seen: Any, xp: Any) -> Any:
    """Return (8 out, FEATURES) from `weight` (out, FEATURES): the features as seen from each element."""
    return xp.einsum("cf,gfk->cgk", weight, seen).reshape(ORDER * len(weight), -1)


def projection(weight: Any, elements: Any, xp: Any) -> Any:
    """Return (2 heads, 8 in) from `weight` (heads, 2, in): vectors brought back from each element."""
    back = xp.einsum("gda,hac->hdcg", elements, weight) / ORDER
    return back.reshape(2 * len(weight), -1)
