"""Writing Plot3D: 17 significant digits or float64, so that no wall cell is lost to rounding."""

import struct
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.format import Heights, Options
from meshonet.formats.output import PART_SUFFIX, final_name, whole_file
from meshonet.formats.plot3d.nmf import write_map
from meshonet.formats.text.number_table import write_rows
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

_LINE = 4
"""Numbers a line of text."""


class Block:
    """A plane block as Plot3D stores it: dims, and x, y[, z] the first index fastest; no heights, no z."""

    def __init__(self, lattice: Floats, heights: Heights, options: Options) -> None:
        self.lattice, self.heights, self.iblank = lattice, heights, "iblank" in options
        self._span = _span(options)
        dims = list(lattice.shape[:2])
        if heights:
            dims.insert(self._span, len(heights))
        self.dims = tuple(dims)

    def arrays(self) -> Iterator[Floats]:
        """Yield each coordinate flat; one at a time, so that a second grid is never in memory."""
        for axis in (0, 1):
            plane = self.lattice[..., axis]
            if len(self.heights) > 1:
                plane = np.broadcast_to(np.expand_dims(plane, self._span), self.dims)
            yield plane.ravel(order="F")
        if self.heights:
            shape = [1, 1, 1]
            shape[self._span] = len(self.heights)
            yield np.broadcast_to(np.array(self.heights).reshape(shape), self.dims).ravel(order="F")

    @property
    def nodes(self) -> int:
        """Nodes of all planes."""
        return int(np.prod(self.dims))


def write_grids(
    path: Path, grids: Iterable[Grid], heights: Heights = (), *, options: Options = frozenset()
) -> None:
    """Write the blocks of `grids`: a plane of their nodes at each of `heights`, or one without z.

    Where a grid has several blocks, a neutral map file beside the file says where they join, and what is
    what.

    Raises InputError: there is no grid; several in a file without a count; a block that no Fortran record
    can hold.
    """
    if not heights and "2d" not in options and ("3d" in options or "binary" in options):
        heights = (0.0,)  # VTK takes a counted flat C binary file of float64 for a solid one of float32
    if "planes" in options:
        raise InputError("planes are read and not written", "leave the word out")
    grids = list(grids)
    blocks = [Block(each.nodes, heights, options) for grid in grids for each in grid.blocks]
    if not blocks:
        raise InputError("there is no grid to write", "check the input")
    if "single" in options and len(blocks) > 1:
        what = "grids" if len(grids) > 1 else "blocks"
        problem = f"{len(blocks)} {what} do not fit in a file without a count"
        raise InputError(problem, "leave out the word single")
    put = _put_bytes if options & {"binary", "fortran"} else _put_text
    with path.open("wb") as stream:
        put(stream, blocks, options)
    beside = map_of(path)
    if beside is not None and any(grid.topology == "blocks" for grid in grids):
        with whole_file(str(beside)) as part:
            write_map(part, grids, len(heights) or 1, _span(options) if heights else 2)


def _span(options: Options) -> int:
    """Return the index that counts the planes in z."""
    return 0 if "span-i" in options else 1 if "span-j" in options else 2


def map_of(path: Path) -> Path | None:
    """Return where the neutral map of the file at `path` is, or goes; none of a stream."""
    name = final_name(path)
    return None if name.endswith(PART_SUFFIX) else path.with_name(name).with_suffix(".nmf")


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


def _put_bytes(stream: BinaryIO, blocks: Sequence[Block], options: Options) -> None:
    """Write C binary, or Fortran records: count, dims, one record a block, each between its length twice."""
    framed = "fortran" in options

    def frame(size: int) -> bytes:
        return struct.pack(_order(options) + "i", size) if framed else b""

    for record in _head(blocks, options):
        stream.write(frame(len(record)) + record + frame(len(record)))
    for block in blocks:
        size = block.nodes * (len(block.dims) * _real(options).itemsize + 4 * int(block.iblank))
        if framed and size >= 1 << 31:
            problem = "a block of 2 GiB or more does not fit in a Fortran record"
            raise InputError(problem, "write it as plot3d:binary")
        stream.write(frame(size))
        for values in block.arrays():
            stream.write(values.astype(_real(options), copy=False).data)
        if block.iblank:
            stream.write(np.ones(block.nodes, _order(options) + "i4").data)
        stream.write(frame(size))


def _head(blocks: Sequence[Block], options: Options) -> Iterator[bytes]:
    """Yield the count, where there is one, and the dims."""
    sizes = [size for block in blocks for size in block.dims]
    if "single" not in options:
        yield struct.pack(f"{_order(options)}i", len(blocks))
    yield struct.pack(f"{_order(options)}{len(sizes)}i", *sizes)


def _order(options: Options) -> str:
    return ">" if "big" in options else "<"


def _real(options: Options) -> np.dtype[Any]:
    return np.dtype(_order(options) + ("f4" if "float32" in options else "f8"))
