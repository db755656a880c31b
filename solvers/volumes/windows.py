"""Windows of nodes around groups of bad cells of a volume."""

from collections.abc import Iterator
from itertools import product

import numpy as np
from numpy.typing import NDArray

NEIGHBOURS = [step for step in product((-1, 0, 1), repeat=3) if any(step)]  # of a tile
TILE = 5
"""Cells along each side of a tile; bad cells in touching tiles form a group."""
LARGEST = 36
"""Largest number of nodes along a side of a window; larger groups are halved."""

Window = tuple[slice, slice, slice]


def windows(bad: NDArray[np.int64], margin: int, counts: tuple[int, int, int]) -> Iterator[Window]:
    """Yield windows of nodes around the groups of cells `bad` (n, 3), with `margin` more nodes on each side.

    >>> list(windows(np.array([[9, 0, 4], [9, 1, 5]]), 5, (30, 30, 8)))
    [(slice(4, 16, None), slice(0, 8, None), slice(0, 8, None))]
    """
    tiles: dict[tuple[int, ...], list[int]] = {}
    for number, tile in enumerate((bad // TILE).tolist()):
        tiles.setdefault(tuple(tile), []).append(number)
    waiting = set(tiles)
    while waiting:
        group = [waiting.pop()]
        for tile in group:
            near = {tuple(a + b for a, b in zip(tile, step, strict=True)) for step in NEIGHBOURS} & waiting
            waiting -= near
            group += sorted(near)
        yield from _around(bad[sorted(number for tile in group for number in tiles[tile])], margin, counts)


def _around(bad: NDArray[np.int64], margin: int, counts: tuple[int, int, int]) -> Iterator[Window]:
    low, high = bad.min(axis=0), bad.max(axis=0)
    axis = int(np.argmax(high - low))
    if len(bad) > 1 and high[axis] - low[axis] + 2 + 2 * margin > LARGEST:
        middle = (low[axis] + high[axis]) // 2
        yield from _around(bad[bad[:, axis] <= middle], margin, counts)
        yield from _around(bad[bad[:, axis] > middle], margin, counts)
        return
    first = np.maximum(low - margin, 0).tolist()
    last = np.minimum(high + 1 + margin, np.array(counts) - 1).tolist()
    yield (slice(first[0], last[0] + 1), slice(first[1], last[1] + 1), slice(first[2], last[2] + 1))
