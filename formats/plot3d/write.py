"""Writes Plot3D files of planar grids, volumes and surfaces.

Numbers have 17 significant digits or are float64, so that thin wall cells are not lost to rounding.
"""

import math
import struct
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.format import Options, at_least_one
from meshonet.formats.mesh.axis_order import first_fastest
from meshonet.formats.output import PART_SUFFIX, final_name, whole_file
from meshonet.formats.plot3d.nmf import write_map
from meshonet.formats.text.number_table import write_rows
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

_LINE = 4  # number of values per line of text


class StoredBlock:
    """A block as stored in Plot3D: node counts, then x, y[, z]; its first index varies fastest."""

    def __init__(self, nodes: Floats, options: Options, *, space: bool) -> None:
        self._coordinates = list(np.moveaxis(nodes, -1, 0))
        self.iblank, self._dtype, self.axes = "iblank" in options, _real(options), 2 + int(space)
        dims = list(nodes.shape[:-1])
        if space and len(dims) == 2:
            dims.append(1)
        if space:
            dims.insert(_span(options), dims.pop())
        self._span, self.dims = _span(options), tuple(dims)

    def arrays(self) -> Iterator[NDArray[Any]]:
        """Yield the coordinates as flat arrays, one at a time to save memory."""
        for values in self._coordinates:
            solid = values.ndim == 3
            yield first_fastest(np.moveaxis(values, 2, self._span) if solid else values, self._dtype)
        if len(self._coordinates) < self.axes:
            yield np.zeros(self.nodes, self._dtype)

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return math.prod(self.dims)


def write_grids(path: Path, grids: Iterable[Grid], *, options: Options = frozenset()) -> None:
    """Write the blocks of `grids` as Plot3D, and a neutral map file unless there are several one-block grids.

    Planar blocks get z = 0 if other blocks have z or the format needs it. `options` are the words for the
    variant of the format. Raises InputError if there is no grid, if the variant cannot store several blocks
    or z, or if a block is too large for a Fortran record.
    """
    if "planes" in options:
        raise InputError("planes are read and not written", "leave the word out")
    rest = iter(grids)
    grids = [at_least_one(rest), *rest]
    space = any(grid.form != "plane" for grid in grids)
    if space and "2d" in options:
        raise InputError("nodes of a grid in space have z", "leave the word 2d out")
    # VTK takes a counted flat C binary file of float64 for a solid one of float32
    space = space or "3d" in options or ("binary" in options and "2d" not in options)
    blocks = [StoredBlock(each.nodes, options, space=space) for grid in grids for each in grid.blocks]
    if "single" in options and len(blocks) > 1:
        what = "grids" if len(grids) > 1 else "blocks"
        problem = f"{len(blocks)} {what} do not fit in a file without a count"
        raise InputError(problem, "leave out the word single")
    put = _put_bytes if options & {"binary", "fortran"} else _put_text
    with path.open("wb") as stream:
        put(stream, blocks, options)
    beside = map_of(path)
    if beside is not None and (len(grids) == 1 or any(grid.topology == "blocks" for grid in grids)):
        with whole_file(str(beside)) as part:
            write_map(part, grids, _span(options) if space else 2)


def _span(options: Options) -> int:
    """Return the file's index for the third direction of volumes."""
    return 0 if "span-i" in options else 1 if "span-j" in options else 2


def map_of(path: Path) -> Path | None:
    """Return the path of the neutral map file that belongs to the file at `path`; None for a stream."""
    name = final_name(path)
    return None if name.endswith(PART_SUFFIX) else path.with_name(name).with_suffix(".nmf")


def _put_text(stream: BinaryIO, blocks: Sequence[StoredBlock], options: Options) -> None:
    """Write text: the number of blocks, the node counts of each in a line, then the coordinates."""
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


def _put_bytes(stream: BinaryIO, blocks: Sequence[StoredBlock], options: Options) -> None:
    """Write C binary or Fortran records: count, node counts, one record per block between its lengths."""
    framed = "fortran" in options

    def frame(size: int) -> bytes:
        return struct.pack(_order(options) + "i", size) if framed else b""

    sizes = [size for block in blocks for size in block.dims]
    count = [] if "single" in options else [struct.pack(f"{_order(options)}i", len(blocks))]
    for record in (*count, struct.pack(f"{_order(options)}{len(sizes)}i", *sizes)):
        stream.write(frame(len(record)) + record + frame(len(record)))
    for number, block in enumerate(blocks, start=1):
        size = block.nodes * (block.axes * _real(options).itemsize + 4 * int(block.iblank))
        if framed and size >= 1 << 31:
            dims = "x".join(map(str, block.dims))
            problem = (
                f"block {number} of {dims} nodes takes {size} bytes and a Fortran record less than 2 GiB"
            )
            raise InputError(problem, "write the stream form, plot3d:binary")
        stream.write(frame(size))
        for values in block.arrays():
            stream.write(values.data)
        if block.iblank:
            stream.write(np.ones(block.nodes, _order(options) + "i4").data)
        stream.write(frame(size))


def _order(options: Options) -> str:
    return ">" if "big" in options else "<"


def _real(options: Options) -> np.dtype[Any]:
    """Return the number type; text is written from float64."""
    if not options & {"binary", "fortran"}:
        return np.dtype(np.float64)
    return np.dtype(_order(options) + ("f4" if "float32" in options else "f8"))
