"""Reads ``.vts`` files: the XML; its arrays are decoded by `meshonet.formats.vtk.arrays`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from meshonet.formats.mesh.metadata import Facts
from meshonet.formats.mesh.structured import grid_of_block
from meshonet.formats.source import Source, printable, reason_of
from meshonet.formats.vtk.arrays import CUT, Encoded, Encoding, decode
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, in_place

if TYPE_CHECKING:
    from mmap import mmap
    from xml.etree.ElementTree import Element

Extent = tuple[int, int, int, int, int, int]
_MOST_NODES = 1 << 40  # largest plausible number of nodes; their coordinates would take 24 TB


def read_grids(source: Source) -> Iterator[Grid]:
    """Yield the grid of a ``.vts`` file; `meshonet.formats.mesh.slices` decides whether it is planar.

    Raises InputError if the file has another format, is damaged, or is LZ4-compressed.
    """
    coordinates, facts = read_block(source)
    yield grid_of_block(coordinates, facts, source.stem)


def read_block(source: Source) -> tuple[list[Floats], Facts]:
    """Return x, y, z, each (ni, nj, nk), and the metadata of a ``.vts`` file; errors as `read_grids`."""
    raw = source.buffer()
    root, start, end = _parsed(raw)
    dataset = _child(root, "StructuredGrid")
    pieces = dataset.findall("Piece")
    if not pieces:
        raise InputError("has no element Piece", "write the file again")
    encoding = _encoding(root, dataset, raw, start, end)
    whole = _extent(dataset, "WholeExtent")
    if len(pieces) == 1 and _extent(pieces[0], "Extent") == whole:
        points = _points(pieces[0], encoding)
    else:
        points = _assembled(pieces, whole, encoding)
    facts = {array.get("Name", ""): _texts(array, encoding) for array in dataset.iterfind("FieldData/Array")}
    return [points[..., k].T for k in range(3)], facts


def vtk_root(text: bytes, kind: str) -> Element:
    """Return the root of a VTK file. Raises InputError if it is no XML of this `kind` or has a DOCTYPE."""
    from xml.etree.ElementTree import ParseError, fromstring

    if b"<!" in text.replace(b"<!--", b"") or b"\0" in text:
        # a document type can define entities that expand without bound; no VTK file has one
        raise InputError("its XML has a document type or zero bytes", "write the file again")
    try:
        root = fromstring(text)  # noqa: S314  (no document type, so no entities)
    except (ParseError, ValueError, LookupError) as error:
        raise InputError(f"is not well-formed XML ({reason_of(error)})", "write the file again") from error
    if root.tag != "VTKFile" or root.get("type") != kind:
        problem = f"is a VTK file of type {printable(root.get('type', '?'))[:60]}"
        raise InputError(problem, f"give one of type {kind}")
    return root


def _parsed(raw: bytes | mmap) -> tuple[Element, int, int]:
    """Return the XML, and start and end of the appended bytes."""
    tag = raw.find(b"<AppendedData")
    start = end = len(raw)
    if tag >= 0:
        mark = raw.find(b"_", raw.find(b">", tag))
        if mark < 0 or raw.find(b">", tag) < 0:
            raise InputError("its appended data has no start mark '_'", CUT)
        start, end = mark + 1, raw.rfind(b"</AppendedData")
        if end < start:
            raise InputError("its appended data has no end", CUT)
    head = raw[:start] + raw[end:]
    return vtk_root(head, "StructuredGrid"), start, end


def _encoding(root: Element, dataset: Element, raw: bytes | mmap, start: int, end: int) -> Encoding:
    header = root.get("header_type", "UInt32")
    if header not in ("UInt32", "UInt64"):
        raise InputError(f"header_type {header[:40]!r} is not known", "write UInt32 or UInt64")
    appended = root.find("AppendedData")
    words = [array.get("offset", "") for array in dataset.iter("DataArray")]
    offsets = [int(word) for word in words if word.isdecimal()]
    return Encoding(
        order=">" if root.get("byte_order") == "BigEndian" else "<",
        header="u4" if header == "UInt32" else "u8",
        compressor=root.get("compressor", ""),
        appended=memoryview(raw)[start:end],
        base64=appended is not None and appended.get("encoding") == "base64",
        offsets=tuple(sorted({*offsets, end - start})),
    )


def _points(piece: Element, encoding: Encoding) -> Floats:
    """Return the points (nk, nj, ni, 3) of a piece, in the file's number type."""
    dims = _dims(_extent(piece, "Extent"))
    array = _child(_child(piece, "Points"), "DataArray")
    if array.get("NumberOfComponents", "1") != "3":
        raise InputError("Points do not have three components", "write x, y, z for every node")
    offset = array.get("offset", "0")
    if not offset.isdecimal():
        raise InputError(f"offset {offset[:40]!r} is not a number", "write the file again")
    kind, form, count = array.get("type", ""), array.get("format", "ascii"), 3 * math.prod(dims)
    encoded = Encoded(kind, count, form, array.text or "", int(offset))
    with in_place("Points"):
        return decode(encoded, encoding).reshape(*dims, 3)


def _assembled(pieces: list[Element], whole: Extent, encoding: Encoding) -> Floats:
    """Return the points of a grid stored in pieces, which overlap in their shared nodes."""
    dims = _dims(whole)
    parts = [(_extent(piece, "Extent"), _points(piece, encoding)) for piece in pieces]
    if math.prod(dims) > sum(points.size for _, points in parts):
        raise InputError("its pieces do not cover WholeExtent", "write the whole grid in one file")
    points, missing = np.empty((*dims, 3)), np.ones(dims, bool)
    for extent, values in parts:
        at = [(extent[2 * k] - whole[2 * k], extent[2 * k + 1] - whole[2 * k] + 1) for k in (2, 1, 0)]
        if any(a < 0 or b > n for (a, b), n in zip(at, dims, strict=True)):
            raise InputError("a piece lies outside WholeExtent", "write the file again")
        (k0, k1), (j0, j1), (i0, i1) = at
        points[k0:k1, j0:j1, i0:i1] = values
        missing[k0:k1, j0:j1, i0:i1] = False
    if missing.any():
        raise InputError("its pieces do not cover WholeExtent", "write the whole grid in one file")
    return points


def _extent(element: Element, name: str) -> Extent:
    words = element.get(name, "").split()
    shown = f"{name} {' '.join(words)[:60]!r}"
    try:
        i0, i1, j0, j1, k0, k1 = (int(word) for word in words)
    except ValueError:
        raise InputError(f"{shown} is not six integers", "write the file again") from None
    if i1 < i0 or j1 < j0 or k1 < k0 or (i1 - i0 + 1) * (j1 - j0 + 1) * (k1 - k0 + 1) > _MOST_NODES:
        raise InputError(f"{shown} is empty or absurdly large", "write the file again")
    return i0, i1, j0, j1, k0, k1


def _dims(extent: Extent) -> tuple[int, int, int]:
    """Return (nk, nj, ni), the slowest index first."""
    i0, i1, j0, j1, k0, k1 = extent
    return k1 - k0 + 1, j1 - j0 + 1, i1 - i0 + 1


def _child(element: Element, name: str) -> Element:
    child = element.find(name)
    if child is None:
        raise InputError(f"element {printable(element.tag)} has no {name}", "write the file again")
    return child


def _texts(array: Element, encoding: Encoding) -> list[str]:
    """Return the strings of an array, each ended by 0; empty for a damaged array."""
    try:
        if array.get("format") == "ascii":
            codes = bytes(int(word) % 256 for word in (array.text or "").split())
        else:
            offset = int(array.get("offset", "0"))
            encoded = Encoded("Int8", None, array.get("format", ""), array.text or "", offset)
            codes = decode(encoded, encoding).tobytes()
    except (ValueError, InputError):
        return []
    return [text.decode("utf-8", "replace") for text in codes.split(b"\0")[:-1]]
