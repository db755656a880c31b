"""The possible layouts of a Plot3D grid file, and the selection of the one that fits.

A file does not state whether it has a block count, z or iblank: of all layouts with its length, the one
with the most regular cells is used. https://www.grc.nasa.gov/WWW/wind/valid/plot3d.html
"""

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.mesh.slices import lattices
from meshonet.formats.plot3d.stream import Stream
from meshonet.geometry.arrays import Floats, cross2
from meshonet.geometry.errors import InputError

Dims = tuple[int, ...]
Header = Callable[[int], "int | None"]
"""Function that returns header integer k; None beyond the end, or for a number that is not an integer."""
_MOST_BLOCKS = 100_000  # largest plausible number of blocks
_MOST_FLAGS = 1000  # largest plausible number of different iblank values
_JUDGED = 100  # number of nodes along each index that are used to compare layouts
_LESS_LIKELY = 0.1  # by how much a surface's regularity is reduced when compared with a planar grid's
MOST_INTEGERS = 1 + 3 * _MOST_BLOCKS  # number of integers in the longest header


@dataclass(frozen=True)
class FileLayout:
    """Layout of a file: number of coordinates, node counts, and whether it has block count and iblank."""

    counted: bool
    axes: int
    iblank: bool
    dims: tuple[Dims, ...]

    @property
    def header(self) -> int:
        """Number of integers before the coordinates of the first block."""
        return int(self.counted) + self.axes * len(self.dims)

    def starts(self, real: int = 1, integer: int = 1) -> list[int]:
        """Return the start of each block and the end of the file, if numbers have these sizes in bytes."""
        node = self.axes * real + integer * int(self.iblank)
        return list(
            itertools.accumulate((node * prod(dims) for dims in self.dims), initial=integer * self.header)
        )

    def length(self, real: int = 1, integer: int = 1) -> int:
        """Return the length of the file, with `real` bytes per coordinate and `integer` per integer."""
        return self.starts(real, integer)[-1]


def layouts(integer: Header) -> Iterator[FileLayout]:
    """Yield the layouts for which the first integers of the file are a plausible header."""
    for counted, axes in itertools.product((True, False), (3, 2)):
        blocks = integer(0) if counted else 1
        if blocks is None or not 1 <= blocks <= _MOST_BLOCKS:
            continue
        dims = _dims(integer, blocks, axes, int(counted))
        if dims:
            for iblank in (False, True):
                yield FileLayout(counted, axes, iblank, dims)


def _dims(integer: Header, blocks: int, axes: int, start: int) -> tuple[Dims, ...]:
    dims = []
    for block in range(blocks):
        at = start + axes * block
        sizes = [integer(at + k) for k in range(axes)]
        if any(size is None or size < 1 for size in sizes):
            return ()
        dims.append(tuple(size for size in sizes if size is not None))
    return tuple(dims)


@dataclass(frozen=True)
class Candidate:
    """A layout that fits the length of a file, and the content of the file.

    Parameters
    ----------
    stream : content of the file.
    real, integer : number types of coordinates, and of node counts or other integers.
    planes : whether the arrays of a block are stored plane by plane.
    numbers : text for messages, with the type of coordinates and the byte order.
    kind : the same, as a set of Plot3D options.
    """

    layout: FileLayout
    stream: Stream
    real: np.dtype[Any]
    integer: np.dtype[Any]
    planes: bool
    numbers: str
    kind: frozenset[str]

    @property
    def traits(self) -> frozenset[str]:
        """The Plot3D options that describe this layout."""
        count = "multi" if self.layout.counted else "single"
        iblank = "iblank" if self.layout.iblank else "no-iblank"
        return self.kind | {count, f"{self.layout.axes}d", iblank, "planes" if self.planes else "whole"}

    def arrays(self, block: int) -> list[NDArray[Any]]:
        """Return the coordinates of a block as flat arrays, without copying if it is stored whole."""
        axes = self.layout.axes
        rows = [self._numbers(at, axes * n, self.real).reshape(axes, -1) for at, n in self._planes(block)]
        return list(rows[0] if len(rows) == 1 else np.concatenate(rows, axis=1))

    def flags(self, block: int) -> NDArray[Any]:
        """Return the flat iblank array of a block."""
        size = self.layout.axes * self.real.itemsize
        flags = [self._numbers(at + size * n, n, self.integer) for at, n in self._planes(block)]
        return flags[0] if len(flags) == 1 else np.concatenate(flags)

    def _planes(self, block: int) -> list[tuple[int, int]]:
        """Return start and node count of each plane of a block; one entry if stored whole."""
        start, end = self._starts[block : block + 2]
        planes = self.layout.dims[block][2] if self.planes else 1
        nodes = prod(self.layout.dims[block]) // planes
        return [(start + k * ((end - start) // planes), nodes) for k in range(planes)]

    @cached_property
    def _starts(self) -> list[int]:
        return self.layout.starts(self.real.itemsize, self.integer.itemsize)

    def _numbers(self, at: int, count: int, kind: np.dtype[Any]) -> NDArray[Any]:
        return np.frombuffer(self.stream.take(at, count * kind.itemsize), kind)

    @property
    def blocks(self) -> range:
        """Indices of the blocks."""
        return range(len(self.layout.dims))

    def iblank(self, block: int) -> dict[str, int]:
        """Return the number of nodes of a block with each iblank value; empty if the file has no iblank."""
        if not self.layout.iblank:
            return {}
        values, counts = _tallied(self.flags(block))
        if len(values) > _MOST_FLAGS:
            problem = f"iblank has {len(values)} different values"
            raise InputError(problem, "write 0, 1, 2 or numbers of blocks")
        return {f"{value:.0f}": int(count) for value, count in zip(values, counts, strict=True)}

    def size(self, block: int) -> tuple[int, int, int]:
        """Return the node counts of a block along three indices; the third is 1 in a planar block."""
        ni, nj, nk = (*self.layout.dims[block], 1)[:3]
        return ni, nj, nk

    def coordinates(self, block: int) -> list[NDArray[Any]]:
        """Return the coordinates x, y[, z] of a block, an array (ni, nj, nk) each."""
        return [values.reshape(self.size(block), order="F") for values in self.arrays(block)]

    def regularity(self) -> float:
        """Return the fraction of cells with the prevailing orientation; negative if values are impossible.

        Orientations are random if the assumed file layout is wrong. For a surface the result is reduced by
        0.1, as its z may in truth be iblank of a planar grid. Only the first 100 nodes of each index count.
        """
        for block in self.blocks:
            if not all(_sane(values) for values in self.arrays(block)):
                return -2.0
            if self.layout.iblank and not _is_iblank(self.flags(block)):
                return -2.0
        some = slice(None, _JUDGED)
        try:
            blocks = lattices([[v[some, some, some] for v in self.coordinates(k)] for k in self.blocks])
        except InputError:
            return -1.0
        good, cells = np.sum([regular_cells(block.nodes) for block in blocks], axis=0)
        return float(good / cells) - (_LESS_LIKELY if blocks[0].nodes.shape[2:] == (3,) else 0.0)


def best(candidates: list[Candidate]) -> Candidate:
    """Return the candidate with the highest `regularity`; of equal candidates, the first."""
    return candidates[0] if len(candidates) == 1 else max(candidates, key=Candidate.regularity)


def _sane(values: NDArray[Any]) -> bool:
    """Return whether `values` can be coordinates: finite, and not tiny like integers read as floats."""
    with np.errstate(invalid="ignore"):  # a wrong reading meets signalling NaN
        largest = max(abs(float(values.min())), abs(float(values.max())))
    return bool(np.isfinite(largest)) and (largest == 0 or 1e-30 < largest < 1e30)


def _is_iblank(values: NDArray[Any]) -> bool:
    most = max(abs(float(values.min())), abs(float(values.max())))
    return most <= _MOST_BLOCKS and (values.dtype.kind == "i" or bool((values == np.round(values)).all()))


def _tallied(flags: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the values of an iblank array in ascending order, and the number of occurrences of each."""
    low, high = float(flags.min()), float(flags.max())
    if not high - low <= _MOST_BLOCKS:
        return np.unique(flags, return_counts=True)
    counts = np.bincount(np.asarray(flags - flags.min(), np.int64))
    values = np.flatnonzero(counts)
    return values + low, counts[values]


def regular_cells(nodes: Floats) -> tuple[int, int]:
    """Return the number of cells with the prevailing orientation (sign of area or volume), and of all cells.

    On surfaces, pairs of neighbouring normals with a positive scalar product are counted instead.
    """
    if nodes.shape[2:] == (3,):
        normal = np.cross(*_diagonals(nodes))
        pairs = (normal[1:], normal[:-1]), (normal[:, 1:], normal[:, :-1])
        signs = np.concatenate([np.ones(1), *((a * b).sum(axis=-1).ravel() for a, b in pairs)])
        return int((signs > 0).sum()), len(signs)
    if nodes.ndim == 3:
        signs = cross2(*_diagonals(nodes))
    else:
        u, v, w = (nodes[1:, :-1, :-1], nodes[:-1, 1:, :-1], nodes[:-1, :-1, 1:])
        corner = nodes[:-1, :-1, :-1]
        signs = (np.cross(u - corner, v - corner) * (w - corner)).sum(axis=-1)
    return max(int((signs > 0).sum()), int((signs < 0).sum())), signs.size


def _diagonals(nodes: Floats) -> tuple[Floats, Floats]:
    return nodes[1:, 1:] - nodes[:-1, :-1], nodes[:-1, 1:] - nodes[1:, :-1]
