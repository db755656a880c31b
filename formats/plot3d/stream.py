"""The numbers of a binary Plot3D file as one stream, with or without Fortran's record lengths."""

import struct
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import accumulate

_MOST_RECORDS = 400_000  # largest plausible number of records, several per block
_LONGEST_HEADER = 1 << 21  # largest first record in bytes, which has the node counts


class Stream:
    """Content of a file, without the length marks of Fortran records; it is accessed without copying."""

    def __init__(self, pieces: Sequence[memoryview], records: int = 0) -> None:
        self._pieces, self.records = pieces, records
        self._starts = list(accumulate(map(len, pieces), initial=0))

    def __len__(self) -> int:
        return self._starts[-1]

    def take(self, start: int, count: int) -> memoryview:
        """Return `count` bytes from position `start`; they are copied only if they span several records."""
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
    """Return the content of the Fortran records of a file; None if it does not consist of such records.

    The length of a record stands before and after it; `order` is its byte order. gfortran splits records
    above 2 GiB and marks the pieces by negative lengths.
    """
    pieces: list[memoryview] = []
    records, more, end = 0, False, 0
    for at, length, split, whole in _records(data, order):
        if not length or not whole or len(pieces) == _MOST_RECORDS:
            return None
        pieces.append(data[at + 4 : at + 4 + length])
        records, more, end = records + (not more), split, at + length + 8
    return Stream(pieces, records) if pieces and end == len(data) else None


def broken_record(data: memoryview, order: str) -> str:
    """Return a message on the first incomplete Fortran record, else an empty text; `order`: byte order."""
    for count, (at, length, _, whole) in enumerate(_records(data, order), start=1):
        if count == 1 and (length % 4 or not 0 < length <= _LONGEST_HEADER or not whole):
            return ""
        if not whole:
            left = max(len(data) - at - 8, 0)
            rest = f"{left} are left" if left < length else "does not end so"
            return f"Fortran record {count}, at byte {at}, says {length} bytes and {rest}"
    return ""


def _records(data: memoryview, order: str) -> Iterator[tuple[int, int, bool, bool]]:
    """Yield start and length of records, whether they continue, and whether lengths agree."""
    word, at = struct.Struct(order + "i"), 0
    while at + 4 <= len(data):
        first = word.unpack_from(data, at)[0]
        length = abs(first)
        end = at + 4 + length
        whole = end + 4 <= len(data) and abs(word.unpack_from(data, end)[0]) == length
        yield at, length, first < 0, whole
        if not whole:
            return
        at = end + 4
