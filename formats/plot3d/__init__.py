"""Plot3D grids in all layouts, and NASA's neutral map files next to them.

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
"""Properties that a Plot3D file does not state, one word from each row, by default the first.

``single`` files have no count of blocks, ``iblank`` files an integer per node after the coordinates. With
``planes``, x, y and z of one plane k follow each other. ``span-i`` and ``span-j`` put planes of a grid
repeated in z along the first (as for FUN3D and NASA) or the second index.
"""

_INTEGER_LINE = re.compile(rb"\s*(?:\d+(?:\*\d+)?[ \t,]*)+\r?\n")
"""First line of a text file: the number of blocks, or node counts."""
_INTEGER_FIRST = re.compile(rb"\s*\d+(?:\*\d+)?[\s,]")  # first word: an integer, possibly with a repeat count


def sniff(head: bytes) -> bool:
    """Return whether a file that begins with the bytes `head` can be a Plot3D grid."""
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
    """Return whether the first bytes of a file, `head`, are text."""
    return b"\0" not in head[:64]
