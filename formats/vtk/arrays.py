"""Data arrays of VTK XML files: ascii, base64 inline, appended raw or base64, compressed by zlib or LZMA."""

import base64
import binascii
import re
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.source import printable
from meshonet.geometry.errors import InputError

_KINDS = {
    "Float32": "f4", "Float64": "f8", "Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2",
    "Int32": "i4", "UInt32": "u4", "Int64": "i8", "UInt64": "u8",
}  # fmt: skip
"""NumPy's number types by VTK's names."""
CUT = "the file is cut short or its sizes are wrong: write it again"  # remedy for a truncated file
_MOST_SHRINKING = 1 << 15  # largest plausible compression ratio; of zeros, LZMA reaches 1e4, zlib 1e3


@dataclass(frozen=True)
class Encoding:
    """Encoding of the arrays of a VTK file: byte order, headers and compression."""

    order: str  # < or >
    header: str  # u4 or u8, the type of the length words before an array
    compressor: str  # the file's attribute of that name, empty for none
    appended: memoryview  # what stands behind the mark _
    base64: bool  # whether that is base64
    offsets: tuple[int, ...]  # where the arrays in it start, and its end, sorted


@dataclass(frozen=True)
class Encoded:
    """An array of a VTK file: type, expected number of values (None: any number), and position."""

    kind: str
    count: int | None
    form: str
    text: str
    offset: int


def decode(array: Encoded, encoding: Encoding) -> NDArray[Any]:
    """Return the values (count,) of an array of a VTK file, as a view of the file's bytes if possible.

    Raises InputError if its type or form is unknown, its number of values is wrong, or it is LZ4-compressed.
    """
    if array.kind not in _KINDS:
        raise InputError(f"number type {array.kind[:40]!r} is not known", "write Float64 or Float32")
    dtype = np.dtype(encoding.order + _KINDS[array.kind])
    size = None if array.count is None else array.count * dtype.itemsize
    if array.form == "ascii":
        return _ascii(array, dtype)
    if array.form == "binary":
        raw = memoryview(_unbase64(array.text.encode("ascii", "replace")))
    elif array.form == "appended" and array.offset < len(encoding.appended):
        raw = encoding.appended[array.offset :]
        if encoding.base64:
            end = next(stop for stop in encoding.offsets if stop > array.offset)
            raw = memoryview(_unbase64(bytes(encoding.appended[array.offset : end])))
    else:
        raise InputError(f"format {array.form[:40]!r} at offset {array.offset} cannot be read", CUT)
    data = _decompressed(raw, size, encoding) if encoding.compressor else _sized(raw, size, encoding)
    return np.frombuffer(data, dtype)


def _ascii(array: Encoded, dtype: np.dtype[Any]) -> NDArray[Any]:
    if array.count is not None and array.count > len(array.text):
        raise InputError(f"should have {array.count} numbers and has fewer", CUT)
    words = array.text.split()
    if array.count not in (None, len(words)):
        raise InputError(f"should have {array.count} numbers and has {len(words)}", CUT)
    try:
        return np.array(words, dtype=np.float64 if dtype.kind == "f" else np.int64)
    except (ValueError, OverflowError) as error:
        raise InputError(printable(str(error))[:120], "write the file again") from None


def _unbase64(text: bytes) -> bytes:
    """Decode base64 text of perhaps several pieces, each with its padding."""
    text = b"".join(text.split())
    try:
        return b"".join(base64.b64decode(piece, validate=True) for piece in re.findall(rb"[^=]+=*", text))
    except (binascii.Error, ValueError):
        raise InputError("its base64 data is damaged", "write the file again") from None


def _words(raw: memoryview, first: int, count: int, encoding: Encoding) -> list[int]:
    """Return the length words `first` to `first + count` at the start of an array."""
    dtype = np.dtype(encoding.order + encoding.header)
    if len(raw) < (first + count) * dtype.itemsize:
        raise InputError("its length words are missing", CUT)
    return [int(word) for word in np.frombuffer(raw, dtype, count, first * dtype.itemsize)]


def _sized(raw: memoryview, size: int | None, encoding: Encoding) -> memoryview:
    (claimed,) = _words(raw, 0, 1, encoding)
    start = int(encoding.header[1])
    if size not in (None, claimed) or len(raw) < start + claimed:
        left = len(raw) - start
        raise InputError(f"should be {size} bytes, is said to be {claimed}, and {left} are left", CUT)
    return raw[start : start + claimed]


def _decompressed(raw: memoryview, size: int | None, encoding: Encoding) -> bytearray:
    """Return `size` decompressed bytes; header: block count, sizes of block and last, compressed sizes."""
    inflate = _inflater(encoding.compressor)
    count, block, last = _words(raw, 0, 3, encoding)
    claimed = (count - 1 if last else count) * block + last
    if count > len(raw) or size not in (None, claimed) or claimed > _MOST_SHRINKING * len(raw):
        raise InputError(f"should be {size} bytes and its blocks say {claimed}", CUT)
    sizes = _words(raw, 3, count, encoding)
    at = (3 + count) * int(encoding.header[1])
    data = bytearray()
    for k, packed in enumerate(sizes):
        wanted = last if last and k == count - 1 else block
        try:
            piece = inflate(raw[at : at + packed], wanted)
        except Exception as error:  # zlib.error and lzma.LZMAError share no base of their own
            raise InputError(f"block {k} cannot be decompressed ({error})", "write the file again") from error
        if len(piece) != wanted:
            raise InputError(f"block {k} has {len(piece)} bytes instead of {wanted}", CUT)
        data += piece
        at += packed
    return data


def _inflater(compressor: str) -> Callable[[memoryview, int], bytes]:
    """Return the decompression function of a compressor: (compressed bytes, largest result) -> bytes."""
    if compressor == "vtkZLibDataCompressor":
        return lambda packed, most: zlib.decompressobj().decompress(packed, most)
    if compressor == "vtkLZMADataCompressor":
        from lzma import LZMADecompressor

        return lambda packed, most: LZMADecompressor().decompress(packed, most)
    remedy = "write it with zlib (vtkZLibDataCompressor) or none"
    raise InputError(f"compressor {compressor[:60]!r} cannot be read", remedy)
