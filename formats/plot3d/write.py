"""Writing Plot3D: 17 significant digits or float64, so that no wall cell is lost to rounding."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.format import Heights, Options
from meshonet.formats.text.number_table import write_rows
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

_LINE = 4
"""Numbers a line of text."""


class Block:
    """One grid as Plot3D stores it: dims, and x, y[, z] with the first index fastest.

    Parameters
    ----------
    grid : the grid.
    heights : z of each plane; none of them makes a two-dimensional block without z.
    options : which index runs in z, whether there is an iblank array.
    """

    def __init__(self, grid: Grid, heights: tuple[float, ...], options: Options) -> None:
        self.grid, self.heights, self.iblank = grid, heights, "iblank" in options
        self._span = 0 if "span-i" in options else 1 if "span-j" in options else 2
        dims = [grid.ni, grid.nj]
        if heights:
            dims.insert(self._span, len(heights))
        self.dims = tuple(dims)

    def arrays(self) -> Iterator[Floats]:
        """Yield each coordinate flat; one at a time, so that a second grid is never in memory."""
        planes = max(1, len(self.heights))
        for axis in (0, 1):
            flat = self.grid.nodes[..., axis].ravel(order="F")
            yield flat if planes == 1 else self._repeated(flat)
        if self.heights:
            shape = [1, 1, 1]
            shape[self._span] = planes
            yield np.broadcast_to(np.array(self.heights).reshape(shape), self.dims).ravel(order="F")

    def _repeated(self, flat: Floats) -> Floats:
        if self._span == 2:
            return np.tile(flat, len(self.heights))
        plane = np.expand_dims(flat.reshape((self.grid.ni, self.grid.nj), order="F"), self._span)
        return np.broadcast_to(plane, self.dims).ravel(order="F")

    @property
    def nodes(self) -> int:
        """Nodes of all planes."""
        return int(np.prod(self.dims))


def write_grids(
    path: Path, grids: Iterable[Grid], heights: Heights = (), *, options: Options = frozenset()
) -> None:
    """Write a block for each of `grids`: a plane of its nodes at each of `heights`, or one without z.

    Raises InputError: there is no grid; several in a file without a count; a block that no Fortran record
    can hold.
    """
    if not heights and "2d" not in options and ("3d" in options or "binary" in options):
        heights = (0.0,)  # VTK takes a counted flat C binary file of float64 for a solid one of float32
    if "planes" in options:
        raise InputError("planes are read and not written", "leave the word out")
    blocks = [Block(grid, heights, options) for grid in grids]
    if not blocks:
        raise InputError("there is no grid to write", "check the input")
    if "single" in options and len(blocks) > 1:
        raise InputError(
            f"{len(blocks)} grids do not fit in a file without a count", "leave out the word single"
        )
    put = {"ascii": _put_text, "binary": _put_binary, "fortran": _put_fortran}
    kind = next((kind for kind in put if kind in options), "ascii")
    with path.open("wb") as stream:
        put[kind](stream, blocks, options)


def _put_text(stream: BinaryIO, blocks: Sequence[Block], options: Options) -> None:
    """Write text: the count of blocks, the dims of each on a line, then the numbers."""
    head = [] if "single" in options else [str(len(blocks))]
    head += [" ".join(map(str, block.dims)) for block in blocks]
    stream.write(("\n".join(head) + "\n").encode())
    for block in blocks:
        for values in block.arrays():
            _put_lines(stream, "%e", values)
        if block.iblank:
            _put_lines(stream, "%d", np.ones(block.nodes, np.int64))


def _put_lines(stream: BinaryIO, field: str, values: NDArray[Any]) -> None:
    whole = len(values) - len(values) % _LINE
    for part, width in ((values[:whole], _LINE), (values[whole:], len(values) - whole)):
        if width:
            write_rows(stream, " ".join([field] * width), part.reshape(-1, width))


def _put_binary(stream: BinaryIO, blocks: Sequence[Block], options: Options) -> None:
    """Write C binary."""
    for record in _head(blocks, options):
        stream.write(record)
    for block in blocks:
        for data in _body(block, options):
            stream.write(data)


def _put_fortran(stream: BinaryIO, blocks: Sequence[Block], options: Options) -> None:
    """Write Fortran records: count, dims, one record a block."""
    word = struct.Struct(_order(options) + "i")
    for record in _head(blocks, options):
        stream.write(word.pack(len(record)) + record + word.pack(len(record)))
    for block in blocks:
        size = block.nodes * (len(block.dims) * _real(options).itemsize + 4 * int(block.iblank))
        if size >= 1 << 31:
            raise InputError(
                "a block of 2 GiB or more does not fit in a Fortran record", "write it as plot3d:binary"
            )
        stream.write(word.pack(size))
        for data in _body(block, options):
            stream.write(data)
        stream.write(word.pack(size))


def _head(blocks: Sequence[Block], options: Options) -> Iterator[bytes]:
    """Yield the count, where there is one, and the dims."""
    sizes = [size for block in blocks for size in block.dims]
    if "single" not in options:
        yield struct.pack(f"{_order(options)}i", len(blocks))
    yield struct.pack(f"{_order(options)}{len(sizes)}i", *sizes)


def _body(block: Block, options: Options) -> Iterator[memoryview]:
    """Yield the coordinates and iblank of a block."""
    for values in block.arrays():
        yield values.astype(_real(options), copy=False).data
    if block.iblank:
        yield np.ones(block.nodes, _order(options) + "i4").data


def _order(options: Options) -> str:
    return ">" if "big" in options else "<"


def _real(options: Options) -> np.dtype[Any]:
    return np.dtype(_order(options) + ("f4" if "float32" in options else "f8"))
