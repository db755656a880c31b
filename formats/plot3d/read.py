"""Reading Plot3D grids of any layout, which their length and their cells tell."""

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import NoReturn

import numpy as np

from meshonet.formats.format import Options
from meshonet.formats.mesh.gather import Piece, grids_of
from meshonet.formats.mesh.recover_topology import usable
from meshonet.formats.plot3d import binary, text
from meshonet.formats.plot3d.layouts import Candidate, best
from meshonet.formats.plot3d.nmf_read import read_map
from meshonet.formats.source import HEAD_BYTES, Source
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

_WRITTEN_ONLY = {"span-i", "span-j", "span-k"}
_INTEGER_LINE = re.compile(rb"\s*(?:\d+(?:\*\d+)?[ \t,]*)+\r?\n")
_INTEGER_FIRST = re.compile(rb"\s*\d+(?:\*\d+)?[\s,]")


def read_grids(source: Source, *, options: Options = frozenset()) -> Iterator[Grid]:
    """Yield the grids of the blocks, right-handed: those that touch are one, others one each.

    Where blocks join, and what their sides are, stands in a neutral map file beside the file, or else is
    found by position; of a block alone the topology is recovered from its nodes. Where there is an iblank
    array, the provenance says how many nodes have which value. `options` say what is known of the layout.
    Raises InputError where none fits the file's length, or a block is not plane.
    """
    data = source.read_bytes()
    every = text.candidates(data) if is_text(data[:HEAD_BYTES]) else binary.candidates(data)
    wanted = options - _WRITTEN_ONLY
    reading = best([candidate for candidate in every if wanted <= candidate.traits] or _misfit(every, wanted))
    pieces, dropped = [], []
    for block in range(len(reading.layout.dims)):
        try:
            nodes, axis = reading.plane(block)
            pieces.append(Piece(usable(nodes), iblank=reading.iblank(block)))
            dropped.append(axis)
        except InputError as error:
            error.place = error.place or f"block {block + 1}, read as {reading.numbers}"
            raise
    beside = source.path.with_suffix(".nmf") if source.path else None
    if beside is None or not beside.is_file():
        return grids_of(pieces, [], source.stem)
    known = read_map(beside, [reading.size(k) for k in range(len(pieces))], dropped)
    named = [replace(piece, patches=tuple(own)) for piece, own in zip(pieces, known.patches, strict=True)]
    return grids_of(named, known.joints, source.stem)


def _misfit(every: list[Candidate], wanted: Options) -> NoReturn:
    fitting = " or ".join(" ".join(sorted(candidate.traits)) for candidate in every[:3])
    problem = f"is not {' '.join(sorted(wanted))}: it fits {fitting}"
    raise InputError(problem, "correct or leave out the options")


def sniff(head: bytes) -> bool:
    """Say whether `head` starts with the dims of a Plot3D grid; a whole file must also fit them."""
    textual = is_text(head)
    if textual and not _INTEGER_FIRST.match(head):
        return False
    if len(head) == HEAD_BYTES:
        return bool(_INTEGER_LINE.match(head)) if textual else _could_be_binary(head)
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
