"""The ways a Plot3D grid file can be laid out, and which of them a file's numbers fit.

A file is a header of integers, ``[count] ni nj [nk]`` for every block, and then for every block all x,
all y, [all z] and [iblank], i fastest. Nothing in it says whether there is a count, a third direction or
an iblank array, so every layout is tried and those whose length is exactly the file's are kept.
https://www.grc.nasa.gov/WWW/wind/valid/plot3d.html
"""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np

from meshonet.formats.mesh.slices import plane_of
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError

Dims = tuple[int, ...]
Header = Callable[[int], "int | None"]
"""Returns header integer k, or None past the end or where the number is no integer."""
_MOST_BLOCKS = 100_000
_MOST_FLAGS = 1000


@dataclass(frozen=True)
class Layout:
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


def layouts(integer: Header) -> Iterator[Layout]:
    """Yield the layouts whose header is plausible: a sensible count, every dimension at least 1."""
    for counted, axes in itertools.product((True, False), (3, 2)):
        blocks = integer(0) if counted else 1
        if blocks is None or not 1 <= blocks <= _MOST_BLOCKS:
            continue
        dims = _dims(integer, blocks, axes, int(counted))
        if dims:
            for iblank in (False, True):
                yield Layout(counted, axes, iblank, dims)


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
    """A layout that fits the file's length, and how to get a block's arrays out of it.

    Parameters
    ----------
    arrays : returns for block k its coordinate arrays (ni nj nk,) flat, and iblank when there is one.
    numbers, kind : the number type and byte order, for messages and as options of the format.
    """

    layout: Layout
    arrays: Callable[[int], Sequence[Floats]]
    numbers: str = ""
    kind: frozenset[str] = frozenset()

    @property
    def traits(self) -> frozenset[str]:
        """The options of the format that describe it."""
        count = "multi" if self.layout.counted else "single"
        return self.kind | {count, f"{self.layout.axes}d", "iblank" if self.layout.iblank else "no-iblank"}

    def iblank(self, block: int) -> dict[str, int]:
        """Return how many nodes of a block have which value, nothing where there is no iblank array."""
        if not self.layout.iblank:
            return {}
        values, counts = np.unique(self.arrays(block)[-1], return_counts=True)
        if len(values) > _MOST_FLAGS:
            problem = f"iblank has {len(values)} different values"
            raise InputError(problem, "write 0, 1, 2 or numbers of blocks")
        return {f"{value:.0f}": int(count) for value, count in zip(values, counts, strict=True)}

    def size(self, block: int) -> tuple[int, int, int]:
        """Return the nodes of a block along all three indices."""
        ni, nj, nk = (*self.layout.dims[block], 1)[:3]
        return ni, nj, nk

    def plane(self, block: int) -> tuple[Floats, int]:
        """Return nodes (ni, nj, 2) of a block and the index left out; InputError where it is not plane."""
        arrays = self.arrays(block)[: self.layout.axes]
        return plane_of([np.asarray(values).reshape(self.size(block), order="F") for values in arrays])

    def regularity(self) -> float:
        """Return the share of cells whose area has the prevailing sign; negative when it makes no sense.

        The right reading of a file has nearly all its cells one way round; a wrong one is noise.
        """
        cells = good = 0
        for block in range(len(self.layout.dims)):
            values = self.arrays(block)[: self.layout.axes]
            if not all(_sane(v) for v in values):
                return -2.0
            if self.layout.iblank and not _is_iblank(self.arrays(block)[-1]):
                return -2.0
            try:
                nodes, _ = self.plane(block)
            except InputError:
                return -1.0
            area = _areas(nodes)
            cells += area.size
            good += max(int((area > 0).sum()), int((area < 0).sum()))
        return good / cells


def best(candidates: list[Candidate]) -> Candidate:
    """Return the most regular of some candidates (at least one), the earlier one among equals."""
    return candidates[0] if len(candidates) == 1 else max(candidates, key=Candidate.regularity)


def _sane(values: Floats) -> bool:
    """Say whether `values` can be coordinates: finite, and no specks as integers read as floats are."""
    largest = float(np.abs(values).max())
    return bool(np.isfinite(largest)) and (largest == 0 or 1e-30 < largest < 1e30)


def _is_iblank(values: Floats) -> bool:
    return bool((values == np.round(values)).all() and np.abs(values).max() <= _MOST_BLOCKS)


def _areas(nodes: Floats) -> Floats:
    rising, falling = nodes[1:, 1:] - nodes[:-1, :-1], nodes[:-1, 1:] - nodes[1:, :-1]
    return rising[..., 0] * falling[..., 1] - rising[..., 1] * falling[..., 0]
