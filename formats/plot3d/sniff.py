"""Telling Plot3D from the first bytes; most `.dat` files are airfoils, and told without the readers."""

from __future__ import annotations

import re

import numpy as np

from meshonet.formats.source import HEAD_BYTES
from meshonet.geometry.errors import InputError

_INTEGER_LINE = re.compile(rb"\s*(?:\d+(?:\*\d+)?[ \t,]*)+\r?\n")
_INTEGER_FIRST = re.compile(rb"\s*\d+(?:\*\d+)?[\s,]")


def sniff(head: bytes) -> bool:
    """Say whether `head` starts with the dims of a Plot3D grid and, when it is a whole file, fits one."""
    textual = is_text(head)
    if textual and not _INTEGER_FIRST.match(head):
        return False
    if len(head) == HEAD_BYTES:
        return bool(_INTEGER_LINE.match(head)) if textual else _could_be_binary(head)
    from meshonet.formats.plot3d import binary, text

    try:
        return bool(text.candidates(head) if textual else binary.candidates(head))
    except InputError:
        return False


def is_text(head: bytes) -> bool:
    """Say whether `head` is text; binary integers below 2^24 always have a zero byte."""
    return b"\0" not in head[:64]


def _could_be_binary(head: bytes) -> bool:
    """Say whether the first integers of a long file can be dims, or the length of a record of them."""
    words = np.frombuffer(head, "<i4", 3), np.frombuffer(head, ">i4", 3)
    return any(bool(((first >= 1) & (first <= 100_000)).all()) for first in words)
