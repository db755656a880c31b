"""The rows of blocks of a layout: all grid lines that go through the same blocks, side by side."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.chords import Chords

_OPPOSITE = (1, 0, 3, 2)  # of south, north, west, east


@dataclass(frozen=True, eq=False)
class Row:
    """Blocks one behind the other, from wall to wall or back to where they begin.

    Parameters
    ----------
    nodes : (k, n) of the k grid lines through all the blocks, the first and last along their sides; those of
        closed ones end with the first node again.
    closed : whether they come back to where they begin.
    blocks : numbers of the blocks.
    """

    nodes: Indices
    closed: bool
    blocks: tuple[int, ...]


def rows_of(chords: Chords) -> Iterator[Row]:
    """Yield every row of blocks; each block is in two."""
    beside: dict[int, list[tuple[int, int]]] = {}
    for block, sides in enumerate(chords.sides.tolist()):
        for side, edge in enumerate(sides):
            beside.setdefault(edge, []).append((block, side))
    done: set[tuple[int, bool]] = set()
    starts = [beside[int(edge)][0] for edge in np.flatnonzero(chords.wall)]
    starts += [(block, side) for block in range(len(chords.sides)) for side in (0, 2)]  # rows without an end
    for begin in starts:
        parts: list[Indices] = []
        blocks: list[int] = []
        here: tuple[int, int] | None = begin
        while here is not None and (here[0], here[1] < 2) not in done:
            block, side = here
            done.add((block, side < 2))
            part = _from_side(chords.layout.blocks[block], side)
            if parts and part[0, 0] != parts[-1][0, -1]:
                part = part[::-1]
            parts.append(part)
            blocks.append(block)
            out = _OPPOSITE[side]
            here = next(
                (each for each in beside[int(chords.sides[block, out])] if each != (block, out)), None
            )
        if parts:
            nodes = np.concatenate([parts[0], *(part[:, 1:] for part in parts[1:])], axis=1)
            yield Row(nodes, here is not None and bool((nodes[:, 0] == nodes[:, -1]).all()), tuple(blocks))


def _from_side(block: Indices, side: int) -> Indices:
    """Return a block with lines from one of its sides to the opposite one as rows."""
    return (block, block[:, ::-1], block.T, block.T[:, ::-1])[side]
