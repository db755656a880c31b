"""Legacy VTK structured grids, ``.vtk``, binary (big endian) or text.

Topology, name, parts and provenance go into a FIELD of bytes, which VTK and meshio pass over.
https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import BinaryIO

import numpy as np

from meshonet.formats.format import Format, Heights, only_one
from meshonet.formats.mesh.metadata import facts_of
from meshonet.formats.text.number_table import write_rows
from meshonet.formats.vtk.legacy_read import read_grids, sniff
from meshonet.geometry.blocks.grid import Grid

_BLOCK_NODES = 1 << 15


def write(path: Path, grid: Grid, heights: tuple[float, ...] = (0.0,), *, text: bool = False) -> None:
    """Write one grid; `heights` is z of each plane, `text` asks for ASCII with 17 significant digits."""
    with path.open("wb") as stream:
        form = "ASCII" if text else "BINARY"
        stream.write(
            f"# vtk DataFile Version 3.0\nstructured grid\n{form}\nDATASET STRUCTURED_GRID\n".encode()
        )
        _write_facts(stream, grid, text=text)
        stream.write(f"DIMENSIONS {grid.ni} {grid.nj} {len(heights)}\n".encode())
        stream.write(f"POINTS {grid.ni * grid.nj * len(heights)} double\n".encode())
        for height in heights:
            _write_points(stream, grid, height, text=text)
        stream.write(b"\n")


def write_grids(path: Path, grids: Iterable[Grid], *, text: bool = False) -> None:
    """Write the one grid of `grids`."""
    write(path, only_one(grids, "a .vtk file"), text=text)


def write_extruded(path: Path, grids: Iterable[Grid], heights: Heights, *, text: bool = False) -> None:
    """Write the one grid of `grids`, repeated in z."""
    write(path, only_one(grids, "a .vtk file"), heights, text=text)


def _write_points(stream: BinaryIO, grid: Grid, height: float, *, text: bool) -> None:
    """Write a plane's points, i fastest, some rows at a time."""
    rows = max(1, _BLOCK_NODES // grid.ni)
    for start in range(0, grid.nj, rows):
        part = grid.nodes[:, start : start + rows].swapaxes(0, 1).reshape(-1, 2)
        block = np.empty((len(part), 3), ">f8")
        block[:, :2], block[:, 2] = part, height
        if text:
            write_rows(stream, "%e %e %e", block)
        else:
            stream.write(block.data)


def _write_facts(stream: BinaryIO, grid: Grid, *, text: bool) -> None:
    """Write topology, name and parts as a FIELD of UTF-8 bytes, one text a line.

    VTK has strings here too, but meshio cannot read a file that holds them.
    """
    facts = {name: "\n".join(texts).encode() for name, texts in facts_of(grid).items()}
    stream.write(f"FIELD FieldData {len(facts)}\n".encode())
    for name, codes in facts.items():
        stream.write(f"{name} 1 {len(codes)} unsigned_char\n".encode())
        stream.write(" ".join(map(str, codes)).encode() if text else codes)
        stream.write(b"\n")


FORMATS = (
    Format(
        name="vtk",
        suffixes=(".vtk",),
        description="legacy VTK structured grid, binary",
        read_grids=read_grids,
        write_grids=write_grids,
        write_extruded=write_extruded,
        sniff=sniff,
        names_patches=True,
    ),
    Format(
        name="vtk-ascii",
        suffixes=(".vtk",),
        description="legacy VTK structured grid, text",
        read_grids=read_grids,
        write_grids=partial(write_grids, text=True),
        write_extruded=partial(write_extruded, text=True),
        sniff=sniff,
        names_patches=True,
    ),
)
