"""The sections of Gmsh meshes as arrays; every count is checked before memory is allocated."""

from collections.abc import Iterator
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.mesh.unstructured import Indices
from meshonet.formats.text.number_table import parsed
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError

SIZES = {1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 8: 3, 9: 6, 10: 9, 11: 10, 12: 27, 15: 1, 16: 8, 17: 20}
"""Nodes of each kind of element."""
_CUT = "the file is cut short: write it again"  # remedy for a file that ends too soon
Elements: TypeAlias = "list[tuple[int, int, Indices]]"
"""Kind, physical group (0: none) and node tags (n, nodes) of blocks of elements."""


class NumberedNodes(NamedTuple):
    """Nodes of a Gmsh mesh: their tags (n,) and points (n, 3)."""

    tags: Indices
    points: Floats


class _Stream:
    """A sequential reader of the numbers of a section, text or binary."""

    def __init__(self, section: bytes, binary: bool, order: str) -> None:
        self._binary, self._order, self._at = binary, order, 0
        numbers = None if binary else parsed(section)
        if not binary and numbers is None:
            raise InputError("has a word that is no number among its nodes or elements", "write it again")
        self._data: Any = section if binary else numbers

    def take(self, kind: str, count: int) -> NDArray[Any]:
        """Return the next `count` numbers of a kind: ``i4``, ``u8`` or ``f8``."""
        dtype = np.dtype(self._order + kind)
        length = count * (dtype.itemsize if self._binary else 1)
        if not 0 <= length <= self.left:
            raise InputError(f"should have {count} more numbers and is too short", _CUT)
        piece = self._data[self._at : self._at + length]
        self._at += length
        if self._binary:
            return np.frombuffer(piece, dtype)
        return np.asarray(piece if kind == "f8" else _whole(piece))

    def one(self, kind: str) -> int:
        """Return the next whole number."""
        return int(self.take(kind, 1)[0])

    def line(self) -> int:
        """Return the number on the first line, which is text even in binary files of version 2.2."""
        if not self._binary:
            return self.one("u8")
        end = self._data.find(b"\n")
        word = self._data[: max(end, 0)]
        self._at = end + 1
        if not word.strip().isdigit() or len(word) > 18:
            raise InputError("has no count of its nodes or elements", "write the file again")
        return int(word)

    @property
    def left(self) -> int:
        """Numbers or bytes that are left."""
        return len(self._data) - self._at

    def bounded(self, count: int) -> int:
        """Return `count`, a number of blocks that the section can hold."""
        if not 0 <= count <= self.left:
            raise InputError(f"should have {count} blocks and is too short", _CUT)
        return count


def nodes(section: bytes, version: str, binary: bool, order: str) -> NumberedNodes:
    """Return the nodes in the section ``$Nodes``; `order` is the byte order if it is `binary`."""
    stream = _Stream(section, binary, order)
    if version == "4.1":
        return _blocks_of_nodes(stream)
    count = stream.line()
    if not binary:
        rows = stream.take("f8", 4 * count).reshape(-1, 4)
        return NumberedNodes(_whole(rows[:, 0]), rows[:, 1:])
    raw = stream.take("i1", 28 * count)
    rows = raw.view(np.dtype([("tag", order + "i4"), ("point", order + "f8", 3)]))
    return NumberedNodes(rows["tag"].astype(np.int64), rows["point"].astype(np.float64).reshape(-1, 3))


def _blocks_of_nodes(stream: _Stream) -> NumberedNodes:
    tags, points = [np.empty(0, np.int64)], [np.empty((0, 3))]
    for _ in range(stream.bounded(int(stream.take("u8", 4)[0]))):
        dimension, _, parametric = stream.take("i4", 3).tolist()
        count = stream.one("u8")
        tags.append(stream.take("u8", count).astype(np.int64))
        width = 3 + (dimension if parametric else 0)
        if not 3 <= width <= 6:
            raise InputError("has nodes of an unknown kind", "write the file again", place="$Nodes")
        points.append(stream.take("f8", width * count).reshape(count, width)[:, :3].astype(np.float64))
    return NumberedNodes(np.concatenate(tags), np.concatenate(points))


def elements(
    section: bytes, version: str, binary: bool, order: str, tags: dict[tuple[int, int], int]
) -> Elements:
    """Return the elements in ``$Elements``; `tags` has the physical group of each entity (dimension, tag)."""
    stream = _Stream(section, binary, order)
    if version == "4.1":
        blocks = _blocks_of_elements(stream, tags)
    else:
        blocks = _blocks_22(stream) if binary else _lines_22(stream)
    merged: dict[tuple[int, int], list[Indices]] = {}
    for kind, group, rows in blocks:
        merged.setdefault((kind, group), []).append(rows)
    return [(kind, group, np.concatenate(rows)) for (kind, group), rows in merged.items()]


def _blocks_of_elements(
    stream: _Stream, tags: dict[tuple[int, int], int]
) -> Iterator[tuple[int, int, Indices]]:
    for _ in range(stream.bounded(int(stream.take("u8", 4)[0]))):
        dimension, entity, kind = stream.take("i4", 3).tolist()
        count = stream.one("u8")
        width = _size(kind)
        rows = stream.take("u8", (width + 1) * count).reshape(count, width + 1)
        yield kind, tags.get((dimension, entity), 0), rows[:, 1:].astype(np.int64)


def _blocks_22(stream: _Stream) -> Iterator[tuple[int, int, Indices]]:
    total = stream.line()
    while total > 0:
        kind, count, tag_count = stream.take("i4", 3).tolist()
        if count < 1 or tag_count < 0:
            raise InputError("has a block of no elements", "write the file again", place="$Elements")
        width = 1 + tag_count + _size(kind)
        rows = stream.take("i4", width * count).reshape(count, width)
        total -= count
        groups = rows[:, 1] if tag_count else np.zeros(count, np.int64)
        for group in np.unique(groups).tolist():
            yield kind, group, rows[groups == group][:, 1 + tag_count :].astype(np.int64)


def _lines_22(stream: _Stream) -> Iterator[tuple[int, int, Indices]]:
    """Yield elements of text: number, kind, count of tags, tags, nodes; of different lengths."""
    count = stream.bounded(stream.line())
    flat = stream.take("i8", stream.left)
    numbers, at = flat.tolist(), 0
    starts: dict[tuple[int, int, int], list[int]] = {}
    for _ in range(count):
        kind, tag_count = numbers[at + 1 : at + 3] if at + 3 <= len(numbers) else (15, -1)
        end = at + 3 + tag_count + _size(kind)
        if tag_count < 0 or end > len(numbers):
            raise InputError(f"should have {count} elements and is too short", _CUT)
        group = numbers[at + 3] if tag_count else 0
        starts.setdefault((kind, group, tag_count), []).append(end - _size(kind))
        at = end
    if at != len(numbers):
        raise InputError("has elements with another count of nodes", "write it again", place="$Elements")
    for (kind, group, _), places in starts.items():
        yield kind, group, flat[np.array(places)[:, None] + np.arange(_size(kind))]


def physical_tags(section: bytes, binary: bool, order: str) -> dict[tuple[int, int], int]:
    """Return the first physical group of each entity in ``$Entities``, by the entity's (dimension, tag)."""
    groups_of: dict[tuple[int, int], int] = {}
    if not section:
        return groups_of
    stream = _Stream(section, binary, order)
    counts = stream.take("u8", 4).tolist()
    for dimension, count in enumerate(counts):
        for _ in range(stream.bounded(count)):
            tag = stream.one("i4")
            stream.take("f8", 3 if dimension == 0 else 6)
            groups = stream.take("i4", stream.one("u8")).tolist()
            if dimension:
                stream.take("i4", stream.one("u8"))
            if groups:
                groups_of[dimension, tag] = abs(groups[0])
    return groups_of


def _whole(values: Floats) -> Indices:
    """Return counts and tags that text gave as floats."""
    if not (np.abs(values) < 2**53).all():
        raise InputError("has no number that can be a count or a tag in its place", "write the file again")
    return values.astype(np.int64)


def _size(kind: int) -> int:
    if kind not in SIZES:
        raise InputError(f"has elements of kind {kind}", "give lines, triangles and quads", place="$Elements")
    return SIZES[kind]
