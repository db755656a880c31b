"""The outer boundary of a multi-block grid: the patch of each boundary cell, and the ranges of patches.

::

    side of a block       owners of its cells         patches that cover it
    +--+--+--+--+--+
    |     |joined  |      0  0 -2 -2 -2     0 0 . . .     the first on cells 0 and 1 of both rows,
    |wall +--+--+--+      0  0 -1 -1 -1     0 0 1 1 1     then one with the name of the side
    +--+--+--+--+--+
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import SIDES, Bools, Side
from meshonet.geometry.blocks.block import PLACES, Range, face_counts
from meshonet.geometry.blocks.patches import Patch

JOINED, UNNAMED = -2, -1
"""Owner numbers of connected cells, and of cells without a patch."""


def owners_of(
    patches: Sequence[Patch], counts: tuple[int, ...], inside: Iterable[tuple[Side, Range]], side: Side
) -> NDArray[np.intp]:
    """Return, for each cell (n,) or (n, m) at a side, the index of the last patch that contains it.

    `inside` lists the connected parts of the block's sides; a part is a side and an index range of nodes.
    Its cells get `JOINED`. Other cells without a patch get `UNNAMED`. `counts` are the block's node counts.
    """
    nodes = face_counts(counts, side)
    owners = np.full([n - 1 for n in nodes], UNNAMED, dtype=np.intp)
    for number, patch in enumerate(patches):
        if patch.side == side:
            owners[_cells(patch.range(nodes))] = number
    for connected, span in inside:
        if connected == side:
            owners[_cells(span)] = JOINED
    return owners


def outer_patches(
    patches: Sequence[Patch], counts: tuple[int, ...], inside: Iterable[tuple[Side, Range]], block: int = 0
) -> list[Patch]:
    """Return patches that cover each cell of the outer boundary of block number `block` exactly once.

    Where `patches` overlap, the later one counts. Cells without a patch get one named after their side.
    `counts` and `inside` are as in `owners_of`.
    """
    own = [patch for patch in patches if patch.block == block]
    inside = list(inside)
    outer: list[Patch] = []
    for side in (*SIDES, *tuple(PLACES)[4 : 2 * len(counts)]):
        for number, (first, *rest) in rectangles(owners_of(own, counts, inside, side)):
            patch = own[number] if number >= 0 else Patch(side, side, 0, 1, block=block)
            outer.append(replace(patch, start=first[0], stop=first[1], across=rest[0] if rest else None))
    return outer


def rectangles(owners: NDArray[np.intp]) -> Iterator[tuple[int, Range]]:
    """Divide a side into rectangles of cells, each of one patch; yield patch index and range of nodes.

    Cells at a connection (`JOINED`) are left out. `owners` (n,) or (n, m) is the result of `owners_of`.
    """
    cells = owners.reshape(len(owners), -1)
    left = cells != JOINED
    while left.any():
        i, j = np.unravel_index(int(np.argmax(left)), left.shape)
        same = left & (cells == cells[i, j])
        width = _run(same[i, j:])
        height = _run(same[i:, j : j + width].all(axis=1))
        left[i : i + height, j : j + width] = False
        span: Range = ((int(i), int(i) + height),)
        yield int(cells[i, j]), span if owners.ndim == 1 else (*span, (int(j), int(j) + width))


def _run(flags: Bools) -> int:
    """Return how many of the first `flags` are set, up to the first that is not."""
    return len(flags) if flags.all() else int(np.argmin(flags))


def _cells(span: Range) -> tuple[slice, ...]:
    return tuple(slice(first, last) for first, last in span)
