"""The ways a Plot3D grid file can be laid out, and which of them a file's numbers fit.

A file is a header of integers, ``[count] ni nj [nk]`` for every block, and then for every block all x,
all y, [all z] and [iblank], i fastest. Nothing in it says whether there is a count, a third direction or
an iblank array, so every layout is tried and those whose length is exactly the file's are kept; of these the
one is read whose cells are the most regular. https://www.grc.nasa.gov/WWW/wind/valid/plot3d.html
"""

from __future__ import annotations

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
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError

Dims = tuple[int, ...]
Header = Callable[[int], "int | None"]
"""Returns header integer k, or None past the end or where the number is no integer."""
_MOST_BLOCKS = 100_000
"""A header that counts more blocks is none of Plot3D."""
_MOST_FLAGS = 1000
"""An iblank array of more different values is none."""
_JUDGED = 100
"""Nodes along each index whose cells are looked at to tell readings apart."""
_LESS_LIKELY = 0.1
"""How much less regular a surface counts than a grid in the plane."""
MOST_INTEGERS = 1 + 3 * _MOST_BLOCKS
"""Integers of the longest header."""


@dataclass(frozen=True)
class FileLayout:
    """One way to read a file: whether a count stands first, 2 or 3 axes, whether iblank follows, all dims."""

    counted: bool
    axes: int
    iblank: bool
    dims: tuple[Dims, ...]

    @property
    def header(self) -> int:
        """Integers before the first coordinate."""
        return int(self.counted) + self.axes * len(self.dims)

    def starts(self, real: int = 1, integer: int = 1) -> list[int]:
        """Return where each block starts and the last one ends, of numbers of these sizes."""
        node = self.axes * real + integer * int(self.iblank)
        return list(
            itertools.accumulate((node * prod(dims) for dims in self.dims), initial=integer * self.header)
        )

    def length(self, real: int = 1, integer: int = 1) -> int:
        """Return the length of the file, of numbers of these sizes."""
        return self.starts(real, integer)[-1]


def layouts(integer: Header) -> Iterator[FileLayout]:
    """Yield the layouts whose header is plausible: a sensible count, every dimension at least 1."""
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
    """A layout that fits the file's length, and the numbers of the file in it.

    Parameters
    ----------
    stream : all numbers of the file.
    real, integer : number types of coordinates, and of dims and iblank.
    planes : whether the arrays of a block stand plane by plane.
    numbers, kind : the number type and byte order, for messages and as options of the format.
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
        """The options of the format that describe it."""
        count = "multi" if self.layout.counted else "single"
        iblank = "iblank" if self.layout.iblank else "no-iblank"
        return self.kind | {count, f"{self.layout.axes}d", iblank, "planes" if self.planes else "whole"}

    def arrays(self, block: int) -> list[NDArray[Any]]:
        """Return the coordinates of a block, flat; views of those that stand whole."""
        axes = self.layout.axes
        rows = [self._numbers(at, axes * n, self.real).reshape(axes, -1) for at, n in self._planes(block)]
        return list(rows[0] if len(rows) == 1 else np.concatenate(rows, axis=1))

    def flags(self, block: int) -> NDArray[Any]:
        """Return the iblank array of a block, flat."""
        size = self.layout.axes * self.real.itemsize
        flags = [self._numbers(at + size * n, n, self.integer) for at, n in self._planes(block)]
        return flags[0] if len(flags) == 1 else np.concatenate(flags)

    def _planes(self, block: int) -> list[tuple[int, int]]:
        """Return where the arrays of each plane of a block start, and its nodes; one entry for whole ones."""
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
        """The numbers of its blocks, from 0 on."""
        return range(len(self.layout.dims))

    def iblank(self, block: int) -> dict[str, int]:
        """Return how many nodes of a block have which value, nothing where there is no iblank array."""
        if not self.layout.iblank:
            return {}
        values, counts = _tallied(self.flags(block))
        if len(values) > _MOST_FLAGS:
            problem = f"iblank has {len(values)} different values"
            raise InputError(problem, "write 0, 1, 2 or numbers of blocks")
        return {f"{value:.0f}": int(count) for value, count in zip(values, counts, strict=True)}

    def size(self, block: int) -> tuple[int, int, int]:
        """Return the nodes of a block along all three indices."""
        ni, nj, nk = (*self.layout.dims[block], 1)[:3]
        return ni, nj, nk

    def coordinates(self, block: int) -> list[NDArray[Any]]:
        """Return x, y[, z] of a block, (ni, nj, nk) each."""
        return [values.reshape(self.size(block), order="F") for values in self.arrays(block)]

    def regularity(self) -> float:
        """Return the share of cells that lie as the others do; negative when it makes no sense.

        The right reading of a file has nearly all its cells one way round; a wrong one is noise. Of readings
        that are alike, one in the plane is the likelier: the iblank array of a plane grid makes a surface.
        Large volumes are judged by their first nodes along each index.
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
    """Return the most regular of some candidates (at least one), the earlier one among equals."""
    return candidates[0] if len(candidates) == 1 else max(candidates, key=Candidate.regularity)


def _sane(values: NDArray[Any]) -> bool:
    """Say whether `values` can be coordinates: finite, and no specks as integers read as floats are."""
    with np.errstate(invalid="ignore"):  # a wrong reading meets signalling NaN
        largest = max(abs(float(values.min())), abs(float(values.max())))
    return bool(np.isfinite(largest)) and (largest == 0 or 1e-30 < largest < 1e30)


def _is_iblank(values: NDArray[Any]) -> bool:
    most = max(abs(float(values.min())), abs(float(values.max())))
    return most <= _MOST_BLOCKS and (values.dtype.kind == "i" or bool((values == np.round(values)).all()))


def _tallied(flags: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the values of an iblank array in ascending order, and how often each stands."""
    low, high = float(flags.min()), float(flags.max())
    if not high - low <= _MOST_BLOCKS:
        return np.unique(flags, return_counts=True)
    counts = np.bincount(np.asarray(flags - flags.min(), np.int64))
    values = np.flatnonzero(counts)
    return values + low, counts[values]


def regular_cells(nodes: Floats) -> tuple[int, int]:
    """Return how many cells lie as most others do, and how many there are, of (ni, nj, 2) or in space.

    In the plane and in volumes these are the cells of the prevailing sign of area or volume; on a surface the
    pairs of neighbours whose normals differ by less than a right angle.
    """
    if nodes.shape[2:] == (3,):
        normal = _cross(*_diagonals(nodes))
        pairs = (normal[1:], normal[:-1]), (normal[:, 1:], normal[:, :-1])
        signs = np.concatenate([np.ones(1), *((a * b).sum(axis=-1).ravel() for a, b in pairs)])
        return int((signs > 0).sum()), len(signs)
    if nodes.ndim == 3:
        (x, y), (u, v) = (np.moveaxis(d, -1, 0) for d in _diagonals(nodes))
        signs = x * v - y * u
    else:
        u, v, w = (nodes[1:, :-1, :-1], nodes[:-1, 1:, :-1], nodes[:-1, :-1, 1:])
        corner = nodes[:-1, :-1, :-1]
        signs = (_cross(u - corner, v - corner) * (w - corner)).sum(axis=-1)
    return max(int((signs > 0).sum()), int((signs < 0).sum())), signs.size


def _diagonals(nodes: Floats) -> tuple[Floats, Floats]:
    return nodes[1:, 1:] - nodes[:-1, :-1], nodes[:-1, 1:] - nodes[1:, :-1]


def _cross(a: Floats, b: Floats) -> Floats:
    (x, y, z), (u, v, w) = np.moveaxis(a, -1, 0), np.moveaxis(b, -1, 0)
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)
