"""A look at an HDF5 file's texts of variable length before the library takes one.

The library (1.14 and before) trusts two numbers of a damaged file too much. It walks a heap of texts by the
sizes written there, and a free object of size 0 keeps it there for ever, out of reach of any signal; and it
takes as much memory as a text's length says, up to 4 GiB, before it looks for the text. h5py makes texts
of variable length by default. Layout: HDF5 File Format Specification, III.E,
https://support.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from meshonet.formats.source import Source
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    import h5py

_HEAP = b"GCOL\x01\0\0\0"
_HEADER, _OBJECT = struct.Struct("<8sQ"), struct.Struct("<HH4xQ")
_TEXT = np.dtype([("length", "<u4"), ("heap", "<u8"), ("index", "<u4")])
_MOST_BYTES = 1 << 28
"""Larger files are not looked through: a scan must stay a small part of reading."""


def check_heaps(source: Source) -> None:
    """Raise InputError when a heap's sizes do not lead from its start to its end.

    Files whose lengths are not 8 bytes wide, which h5py never writes, are passed over.
    """
    if source.size > _MOST_BYTES:
        return
    with source.open() as stream:
        if source.data is not None:
            _check(source.data)
            return
        with mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
            _check(data)


def check_texts(data: h5py.Dataset, source: Source) -> None:
    """Raise InputError when a text of a (n,) dataset of them claims to be longer than the file."""
    if data.id.get_type().is_variable_str() and not data.id.get_create_plist().get_nfilters():
        with source.open() as stream:
            for offset, size in _stored(data):
                stream.seek(offset)
                raw = stream.read(size)
                texts = np.frombuffer(raw, _TEXT, len(raw) // _TEXT.itemsize)
                if (texts["length"] > source.size).any():
                    told = f"dataset {data.name.lstrip('/')!r} claims a text longer than the file"
                    raise InputError(told, "write the file again")


def _stored(data: h5py.Dataset) -> Iterator[tuple[int, int]]:
    """Yield offset and length in bytes of each piece of the file that holds a dataset's rows."""
    if data.chunks is not None:
        for k in range(data.id.get_num_chunks()):
            chunk = data.id.get_chunk_info(k)
            yield chunk.byte_offset, chunk.size
    elif data.id.get_offset() is not None:
        yield data.id.get_offset(), data.id.get_storage_size()


def _check(data: bytes | mmap.mmap) -> None:
    if not _wide_lengths(data):
        return
    at = data.find(_HEAP)
    while at >= 0:
        if not _walks(data, at):
            raise InputError(
                "HDF5 data is damaged (a heap of texts)", "write the file again", place=f"byte {at}"
            )
        at = data.find(_HEAP, at + 1)


def _wide_lengths(data: bytes | mmap.mmap) -> bool:
    """Say whether the superblock gives lengths 8 bytes; it stands first in files that h5py makes."""
    version = data[8] if len(data) > 16 else 255
    return data[14 if version < 2 else 10] == 8 if version < 4 else False


def _walks(data: bytes | mmap.mmap, at: int) -> bool:
    """Say whether the objects of the collection at `at` fill it: each a header and data padded to 8 bytes."""
    if at + _HEADER.size > len(data):
        return False
    end = at + _HEADER.unpack_from(data, at)[1]
    at += _HEADER.size
    if end > len(data):
        return False
    while at + _OBJECT.size <= end:
        index, _, size = _OBJECT.unpack_from(data, at)
        step = _OBJECT.size + (size + 7) // 8 * 8 if index else size
        if step < _OBJECT.size or at + step > end:
            return False
        at += step
    return True
