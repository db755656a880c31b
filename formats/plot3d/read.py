"""Reading Plot3D grids of any kind, told apart without being told."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import NoReturn

import numpy as np

from formats.edges import recovered
from formats.plot3d import binary, text
from formats.plot3d.layouts import Candidate, best
from formats.plot3d.variant import Variant
from formats.source import HEAD_BYTES, Source
from geometry.errors import InputError
from geometry.grid import Grid

ANY = Variant()

_INTEGER_LINE = re.compile(rb"\s*(?:\d+(?:\*\d+)?[ \t,]*)+\r?\n")
_INTEGER_FIRST = re.compile(rb"\s*\d+(?:\*\d+)?[\s,]")


def read_grids(source: Source, variant: Variant = ANY) -> Iterator[Grid]:
    """Yield the grid of every block, right-handed, its topology recovered from its nodes.

    Where there is an iblank array, the provenance says how many nodes have which value.

    Parameters
    ----------
    variant : what is known of the layout; the rest is found out.

    Raises
    ------
    InputError
        no layout fits the file's length, or none that is as told; a block is three-dimensional.
    """
    data = source.read_bytes()
    every = text.candidates(data) if _is_text(data[:HEAD_BYTES]) else binary.candidates(data)
    asked = variant.for_reading()
    found = best([candidate for candidate in every if asked <= candidate.traits] or _misfit(every, asked))
    blocks = len(found.layout.dims)
    for block in range(blocks):
        name = source.stem if blocks == 1 else f"{source.stem}-{block + 1}"
        try:
            grid = recovered(found.plane(block), name)
            flags = found.iblank(block)
            yield replace(grid, provenance={"iblank": flags}) if flags else grid
        except InputError as error:
            error.place = error.place or f"block {block + 1}, read as {found.told}"
            raise


def _misfit(every: list[Candidate], asked: frozenset[str]) -> NoReturn:
    fitting = " or ".join(" ".join(sorted(candidate.traits)) for candidate in every[:3])
    raise InputError(
        f"is not {' '.join(sorted(asked))}: it fits {fitting}",
        "correct or leave out the words of the variant",
    )


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
