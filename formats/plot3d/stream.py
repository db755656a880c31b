"""The numbers of a binary Plot3D file as one stream, whether Fortran framed them in records or not."""

from __future__ import annotations

import struct
from bisect import bisect_right
from collections.abc import Sequence
from itertools import accumulate

_MOST_RECORDS = 400_000
_LONGEST_HEADER = 1 << 21


class Stream:
    """Bytes of a file in their order, without the length words of records; what is taken is no copy."""

    def __init__(self, pieces: Sequence[memoryview], records: int = 0) -> None:
        self._pieces, self.records = pieces, records
        self._starts = list(accumulate(map(len, pieces), initial=0))

    def __len__(self) -> int:
        return self._starts[-1]

    def take(self, start: int, count: int) -> memoryview:
        """Return `count` bytes from `start` on; a copy only where they lie in several records."""
        k = bisect_right(self._starts, start) - 1
        at = start - self._starts[k]
        if at + count <= len(self._pieces[k]) or not count:
            return self._pieces[k][at : at + count]
        joined = bytearray()
        while len(joined) < count:
            joined += self._pieces[k][at : at + count - len(joined)]
            k, at = k + 1, 0
        return memoryview(joined)


def unframed(data: memoryview, order: str) -> Stream | None:
    """Return what is in the records of a Fortran file, None when the length words do not lead to its end.

    Each record stands between its length twice. gfortran splits one of more than 2 GiB: a negative first word
    says that more follows.
    """
    at = 0
    pieces: list[memoryview] = []
    word = struct.Struct(order + "i")
    records, more = 0, False
    while at < len(data):
        if at + 8 > len(data) or len(pieces) == _MOST_RECORDS:
            return None
        first = word.unpack_from(data, at)[0]
        length, records, more = abs(first), records + (not more), first < 0
        end = at + 4 + length
        if not length or end + 4 > len(data) or abs(word.unpack_from(data, end)[0]) != length:
            return None
        pieces.append(data[at + 4 : end])
        at = end + 4
    return Stream(pieces, records) if pieces else None


def broken_record(data: memoryview, order: str) -> str:
    """Return what is wrong with the first record that breaks off; nothing if the first is none of dims."""
    word, at, count = struct.Struct(order + "i"), 0, 1
    while at + 4 <= len(data):
        length = abs(word.unpack_from(data, at)[0])
        end = at + 4 + length
        if count == 1 and (length % 4 or not 0 < length <= _LONGEST_HEADER):
            return ""
        if end + 4 > len(data) or abs(word.unpack_from(data, end)[0]) != length:
            if count == 1:
                return ""
            left = max(len(data) - at - 8, 0)
            if left < length:
                return f"Fortran record {count}, at byte {at}, says {length} bytes and {left} are left"
            return f"Fortran record {count}, at byte {at}, says {length} bytes and does not end so"
        at, count = end + 4, count + 1
    return ""
