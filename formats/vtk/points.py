"""Points and names as files of VTK have them."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.source import printable
from meshonet.geometry.arrays import Floats

_BLOCK_NODES = 1 << 15
"""Nodes laid out at a time: 24 bytes each stay in the second-level cache."""
_PLANES = 8
"""Planes of a volume laid out at a time: as many numbers as a cache line of its rows has."""


def points_of(nodes: Floats, dtype: str) -> Iterator[NDArray[Any]]:
    """Yield nodes (ni, nj, 2 or 3) or (ni, nj, nk, 3) as points (n, 3), i fastest, some rows at a time.

    Nodes in the plane get z = 0.
    """
    if nodes.ndim == 4:
        for start in range(0, nodes.shape[2], _PLANES):
            part = nodes[:, :, start : start + _PLANES]
            block = np.empty((*part.shape[2::-1], 3), dtype)
            for j in range(nodes.shape[1]):
                block[:, j] = part[:, j].swapaxes(0, 1)
            yield block.reshape(-1, 3)
        return
    ni, nj, coordinates = nodes.shape
    rows = max(1, _BLOCK_NODES // ni)
    block = np.zeros((rows, ni, 3), dtype)
    for start in range(0, nj, rows):
        part = block[: nj - start]
        for axis in range(coordinates):
            part[..., axis] = nodes[:, start : start + rows, axis].T
        yield part.reshape(-1, 3)


def escaped(text: str) -> str:
    """Return `text` for an XML attribute; xml.sax has this too, behind 30 ms of network modules."""
    for plain, entity in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;")):
        text = text.replace(plain, entity)
    return printable(text)
