"""Writing Plot3D: 17 significant digits or float64, so that no wall cell is lost to rounding."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import BinaryIO

import numpy as np

from formats.text_rows import write_rows
from geometry.arrays import Floats
from geometry.errors import InputError
from geometry.grid import Grid

_LINE = 4
"""Numbers a line of text."""

Put = Callable[[BinaryIO, Sequence["Block"]], None]


class Block:
    """One grid as Plot3D stores it: dims, and x, y[, z] with i fastest.

    Parameters
    ----------
    grid : the grid.
    heights : z of each plane; none of them makes a two-dimensional block without z.
    """

    def __init__(self, grid: Grid, heights: tuple[float, ...]) -> None:
        self.grid, self.heights = grid, heights
        self.dims = (grid.ni, grid.nj, len(heights)) if heights else (grid.ni, grid.nj)

    def arrays(self) -> Iterator[Floats]:
        """Yield each coordinate flat; one at a time, so that a second grid is never in memory."""
        planes = max(1, len(self.heights))
        for axis in (0, 1):
            flat = self.grid.nodes[..., axis].ravel(order="F")
            yield flat if planes == 1 else np.tile(flat, planes)
        if self.heights:
            yield np.repeat(np.array(self.heights), self.grid.ni * self.grid.nj)

    @property
    def bytes(self) -> int:
        """Bytes of all coordinates."""
        numbers = 3 * len(self.heights) or 2
        return 8 * numbers * self.grid.ni * self.grid.nj


def write_blocks(path: Path, grids: Iterable[Grid], put: Put, heights: tuple[float, ...] = ()) -> None:
    """Write the blocks of `grids` with one of the ways below.

    Raises
    ------
    InputError
        there is no grid.
    """
    blocks = [Block(grid, heights) for grid in grids]
    if not blocks:
        raise InputError("there is no grid to write", "check the input")
    with path.open("wb") as stream:
        put(stream, blocks)


def put_text(stream: BinaryIO, blocks: Sequence[Block]) -> None:
    """Write text: the count of blocks, the dims of each on a line, then the numbers."""
    head = [str(len(blocks)), *(" ".join(map(str, block.dims)) for block in blocks)]
    stream.write(("\n".join(head) + "\n").encode())
    for block in blocks:
        for values in block.arrays():
            whole = len(values) - len(values) % _LINE
            for part, width in ((values[:whole], _LINE), (values[whole:], len(values) - whole)):
                if width:
                    write_rows(stream, " ".join(["%e"] * width), part.reshape(-1, width))


def put_binary(stream: BinaryIO, blocks: Sequence[Block]) -> None:
    """Write C binary, little endian, float64."""
    stream.write(_counts(blocks))
    for block in blocks:
        for values in block.arrays():
            stream.write(values.astype("<f8", copy=False).data)


def put_fortran(stream: BinaryIO, blocks: Sequence[Block]) -> None:
    """Write Fortran records, little endian, float64: count, dims, one record a block."""
    _record(stream, struct.pack("<i", len(blocks)))
    _record(stream, _counts(blocks)[4:])
    for block in blocks:
        if block.bytes >= 1 << 31:
            raise InputError(
                "a block of 2 GiB or more does not fit in a Fortran record", "write plot3d-binary"
            )
        marker = struct.pack("<i", block.bytes)
        stream.write(marker)
        for values in block.arrays():
            stream.write(values.astype("<f8", copy=False).data)
        stream.write(marker)


def _counts(blocks: Sequence[Block]) -> bytes:
    sizes = [size for block in blocks for size in block.dims]
    return struct.pack(f"<{1 + len(sizes)}i", len(blocks), *sizes)


def _record(stream: BinaryIO, data: bytes) -> None:
    marker = struct.pack("<i", len(data))
    stream.write(marker + data + marker)
