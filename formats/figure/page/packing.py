"""Integers as compressed text in a page, unpacked in the browser by ``unpack.js``."""

import base64
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats

_PARTS = 256  # number of rounding steps in the shortest edge
_MOST = 2.0**50  # largest integer coordinate; differences of such numbers are exact in JavaScript


@dataclass(frozen=True)
class Packed:
    """Compressed integers: Base64 text, number of integers, and number of bytes of each integer."""

    text: str
    count: int
    width: int


def packed(numbers: NDArray[np.integer]) -> Packed:
    """Return integers (n,) below 2^50 in magnitude as compressed text, which ``unpack.js`` reads.

    Differences of successive integers become unsigned integers: 0, -1, 1, -2 become 0, 1, 2, 3, and so on.
    Bytes of equal significance are stored together, compressed by deflate and encoded as Base64.

    >>> packed(np.array([5, 6, 7])).width
    1
    """
    steps: NDArray[np.int64] = np.diff(numbers.astype(np.int64), prepend=np.int64(0)).astype(np.int64)
    plain = ((steps << 1) ^ (steps >> 63)).astype("<u8")
    most = int(plain.max(initial=0))
    width = max(1, (most.bit_length() + 7) // 8)
    planes = plain.view(np.uint8).reshape(-1, 8)[:, :width].T
    text = base64.b64encode(zlib.compress(planes.tobytes(), 6)).decode("ascii")
    return Packed(text, len(numbers), width)


def rounding_step(shortest: float, extent: float) -> float:
    """Return the step to which coordinates are rounded, a fraction of the `shortest` edge of a grid."""
    smallest = extent / _MOST
    return max(2.0 ** np.floor(np.log2(max(shortest / _PARTS, smallest, 1e-300))), smallest)


def shortest_edge(nodes: Floats, extent: float) -> float:
    """Return the length of the shortest edge of `nodes` (..., d) that is longer than 1e-14 `extent`."""
    least = extent
    for axis in range(nodes.ndim - 1):
        step = np.diff(nodes, axis=axis)
        length = np.sqrt(np.square(step, out=step).sum(axis=-1))
        length = length[length > 1e-14 * extent]
        least = min(least, float(length.min(initial=extent)))
    return least
