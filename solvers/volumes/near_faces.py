"""Checks whether inner nodes next to faces have a valid position."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.six_faces import FACES, SixFaces
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import closed_node

Place = tuple[int, int, int]

Ranges = list[tuple[int, int]]  # first and end index of nodes along each direction


def closed_place(faces: SixFaces) -> Place | None:
    """Return indices i, j, k of an inner node that has no valid position, or None.

    A node next to faces has four half-spaces for each face, which must have a common point
    (kernels/volumes/near_faces.c).
    """
    for sides, ranges in next_to_faces(faces.counts):
        walls = tuple((np.ascontiguousarray(getattr(faces, side)), *PLACES[side]) for side in sides)
        sizes = [last - low for low, last in ranges]
        number = closed_node(walls, tuple(ranges), threads_for(int(np.prod(sizes))))
        if number >= 0:
            at = np.unravel_index(number, sizes)
            i, j, k = (int(low + step) for (low, _), step in zip(ranges, at, strict=True))
            return i, j, k
    return None


def next_to_faces(counts: tuple[int, int, int]) -> Iterator[tuple[tuple[Side, ...], Ranges]]:
    """Yield sets of three, two or one sides, and the inner nodes next to all of them."""
    for size in (3, 2, 1) if min(counts) > 2 else ():
        for sides in combinations(FACES, size):
            if len({PLACES[side][0] for side in sides}) == size:
                yield sides, _ranges(sides, counts)


def _ranges(sides: tuple[Side, ...], counts: tuple[int, int, int]) -> Ranges:
    ranges = [(1, n - 1) for n in counts]
    for side in sides:
        axis, end = PLACES[side]
        at = 1 if end == 0 else counts[axis] - 2
        ranges[axis] = (at, at + 1)
    return ranges
