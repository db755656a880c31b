"""The numbers of a binary Plot3D file as one stream, whether Fortran framed them in records or not."""

from __future__ import annotations

import struct
from bisect import bisect_right
from collections.abc import Sequence
from itertools import accumulate

_MOST_RECORDS = 400_000


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
