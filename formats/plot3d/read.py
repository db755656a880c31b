"""Reading Plot3D grids of any kind, told apart without being told."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from formats.edges import recovered
from formats.plot3d import binary, text
from formats.plot3d.layouts import best
from formats.source import HEAD_BYTES, Source
from geometry.errors import InputError
from geometry.grid import Grid

_INTEGER_LINE = re.compile(rb"\s*(?:\d+(?:\*\d+)?[ \t,]*)+\r?\n")
_INTEGER_FIRST = re.compile(rb"\s*\d+(?:\*\d+)?[\s,]")


def read_grids(source: Source) -> Iterator[Grid]:
    """Yield the grid of every block, right-handed, its topology recovered from its nodes.

    Raises
    ------
    InputError
        no layout fits the file's length; a block is three-dimensional.
    """
    data = source.read_bytes()
    found = best(text.candidates(data) if _is_text(data[:HEAD_BYTES]) else binary.candidates(data))
    blocks = len(found.layout.dims)
    for block in range(blocks):
        name = source.stem if blocks == 1 else f"{source.stem}-{block + 1}"
        try:
            yield recovered(found.plane(block), name)
        except InputError as error:
            error.place = error.place or f"block {block + 1}, read as {found.told}"
            raise


def sniff(head: bytes) -> bool:
    """Say whether `head` starts with the dims of a Plot3D grid and, when it is a whole file, fits one."""
    is_text = _is_text(head)
    if is_text and not _INTEGER_FIRST.match(head):
        return False
    if len(head) == HEAD_BYTES:
        return bool(_INTEGER_LINE.match(head)) if is_text else _could_be_binary(head)
    try:
        return bool(text.candidates(head) if is_text else binary.candidates(head))
    except InputError:
        return False


def _is_text(head: bytes) -> bool:
    """Say whether `head` is text; binary integers below 2^24 always have a zero byte."""
    return b"\0" not in head[:64]


def _could_be_binary(head: bytes) -> bool:
    """Say whether the first integers of a long file can be dims, or the length of a record of them."""
    words = np.frombuffer(head, "<i4", 3), np.frombuffer(head, ">i4", 3)
    return any(bool(((first >= 1) & (first <= 100_000)).all()) for first in words)
