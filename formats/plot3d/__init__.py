"""Plot3D grids, read in every layout, and NASA's neutral map file beside them.

https://www.grc.nasa.gov/WWW/wind/valid/plot3d.html
"""

import re

import numpy as np

from meshonet.formats.source import HEAD_BYTES
from meshonet.geometry.errors import InputError

CHOICES = (
    ("ascii", "binary", "fortran"),
    ("multi", "single"),
    ("2d", "3d"),
    ("no-iblank", "iblank"),
    ("little", "big"),
    ("float64", "float32"),
    ("whole", "planes"),
    ("span-k", "span-i", "span-j"),
)
"""What a Plot3D file does not say of itself, of each row one word; the first is what is written by default.

``single`` has no count of blocks in front; ``iblank`` an integer a node behind the coordinates; ``planes`` x,
y and z of one k after the other in place of all x, all y, all z; ``span-i`` the planes of a grid that is
repeated in z along the first index, as FUN3D and NASA have it, ``span-j`` along the second.
"""

_INTEGER_LINE = re.compile(rb"\s*(?:\d+(?:\*\d+)?[ \t,]*)+\r?\n")
"""The first line of a text: the count of blocks, or dims."""
_INTEGER_FIRST = re.compile(rb"\s*\d+(?:\*\d+)?[\s,]")
"""The first word of a text: a whole number, perhaps repeated."""


def sniff(head: bytes) -> bool:
    """Say whether `head` starts with the dims of a Plot3D grid; a whole file must also fit them."""
    textual = is_text(head)
    if textual and not _INTEGER_FIRST.match(head):
        return False
    if len(head) == HEAD_BYTES:
        if textual:
            return bool(_INTEGER_LINE.match(head))
        # dims, or the length of a record of them
        words = np.frombuffer(head, "<i4", 3), np.frombuffer(head, ">i4", 3)
        return any(bool(((first >= 1) & (first <= 100_000)).all()) for first in words)
    from meshonet.formats.plot3d import binary, text  # which most files that are no Plot3D do not need

    try:
        return bool(text.candidates(head) if textual else binary.candidates(memoryview(head)))
    except InputError:
        return False


def is_text(head: bytes) -> bool:
    """Say whether `head` is text; binary integers below 2^24 always have a zero byte."""
    return b"\0" not in head[:64]
