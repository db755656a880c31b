"""The record that describes a file format; every format module ends in one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from meshonet.formats.source import Source
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import Shape

Heights: TypeAlias = tuple[float, ...]
"""z of each plane of a grid that is repeated in z, increasing from 0."""


@dataclass(frozen=True)
class Format:
    """What a format is called, how it is recognised and what it can hold.

    Parameters
    ----------
    name : what ``--from`` and ``--to`` call it.
    suffixes : file endings, lower case with the dot.
    description : a few words for help texts and tables.
    read_shapes : yields what can be sampled into a boundary; None when the format holds grids (whose
        outer edges then serve) or cannot be read.
    read_grids, write_grids, write_boundaries : None when the format cannot.
    write_extruded : writes grids as layers of cells between planes at the given heights, two or more.
    sniff : says from the first `HEAD_BYTES` bytes (all of a shorter file) whether a file looks like this.
    names_patches : whether names of parts and the topology survive in it.
    many : whether one file holds several grids or boundaries.
    one_size : whether all that one file holds must have the same counts of nodes and the same topology.
    beside : whether other files are written beside the file, so that a stream holds none.
    fills_folder : whether the file is the mark of a folder whose other files are written with it, so that a
        folder holds one and a stream none.
    """

    name: str
    suffixes: tuple[str, ...]
    description: str
    read_shapes: Callable[[Source], Iterator[Shape]] | None = None
    read_grids: Callable[[Source], Iterator[Grid]] | None = None
    write_grids: Callable[[Path, Iterable[Grid]], None] | None = None
    write_boundaries: Callable[[Path, Iterable[Boundary]], None] | None = None
    write_extruded: Callable[[Path, Iterable[Grid], Heights], None] | None = None
    sniff: Callable[[bytes], bool] | None = None
    names_patches: bool = False
    many: bool = False
    one_size: bool = False
    beside: bool = False
    fills_folder: bool = False


def only_one(grids: Iterable[Grid], what: str) -> Grid:
    """Return the single grid of `grids`, for a format whose files hold one.

    Raises
    ------
    InputError
        there is none, or more than one.
    """
    given = iter(grids)
    first = next(given, None)
    if first is None:
        raise InputError("there is no grid to write", "check the input")
    if next(given, None) is not None:
        raise InputError(
            f"{what} holds one grid and there are several",
            "write one file each ({output} 'name-{{index}}'), or one .h5",
        )
    return first
