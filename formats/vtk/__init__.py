"""VTK files: XML structured grids, multi-block and legacy structured grids."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.source import printable
from meshonet.geometry.arrays import Floats

_BLOCK_NODES = 1 << 15  # nodes converted at a time; at 24 bytes each they stay in the second-level cache


def points_of(nodes: Floats, dtype: str) -> Iterator[NDArray[Any]]:
    """Yield nodes (ni, nj[, nk], 2 or 3) in pieces as points (n, 3); i varies fastest, a missing z is 0."""
    *counts, coordinates = nodes.shape
    last = len(counts) - 1
    step = max(1, _BLOCK_NODES * counts[-1] // math.prod(counts))
    for start in range(0, counts[-1], step):
        part = nodes[(slice(None),) * last + (slice(start, start + step),)]
        points = np.zeros((*part.shape[last::-1], 3), dtype)
        points[..., :coordinates] = part.transpose(*range(last, -1, -1), last + 1)
        yield points.reshape(-1, 3)


def escaped(text: str) -> str:
    """Return `text` with the special characters of an XML attribute escaped."""
    for plain, entity in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;")):
        text = text.replace(plain, entity)
    return printable(text)
