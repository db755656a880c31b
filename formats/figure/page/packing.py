"""Whole numbers as text for a page, which the browser unpacks (``unpack.js``).

Neighbours in a grid differ little, so that it is differences that are stored::

    numbers -> differences -> without sign (0, -1, 1, -2 ...) -> bytes of equal weight together -> deflate
    -> base64
"""

import base64
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats

_PARTS = 256
"""Parts of the shortest edge that coordinates are rounded to."""
_MOST = 2.0**50
"""Coordinates are counted up to this, which differences and a browser's numbers hold."""


@dataclass(frozen=True)
class Packed:
    """Numbers as base64, how many, and the bytes of each."""

    text: str
    count: int
    width: int


def packed(numbers: NDArray[np.integer]) -> Packed:
    """Return whole `numbers` (n,) packed; they are within 2^50 of zero.

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
    """Return what coordinates of a grid of `extent` are rounded to: a part of its `shortest` edge."""
    smallest = extent / _MOST
    return max(2.0 ** np.floor(np.log2(max(shortest / _PARTS, smallest, 1e-300))), smallest)


def shortest_edge(nodes: Floats, extent: float) -> float:
    """Return the shortest edge along the directions of `nodes` (..., d) that is one, not a pole's."""
    least = extent
    for axis in range(nodes.ndim - 1):
        step = np.diff(nodes, axis=axis)
        length = np.sqrt(np.square(step, out=step).sum(axis=-1))
        length = length[length > 1e-14 * extent]
        least = min(least, float(length.min(initial=extent)))
    return least
