"""Plot3D grids: read in every variant, written as text, C binary or Fortran records.

https://www.grc.nasa.gov/WWW/wind/valid/plot3d.html
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from formats.format import Format, Heights
from formats.plot3d.read import read_grids, sniff
from formats.plot3d.write import Put, put_binary, put_fortran, put_text, write_blocks
from geometry.grid import Grid


def _format(
    name: str, suffixes: tuple[str, ...], description: str, put: Put, heights: tuple[float, ...] = ()
) -> Format:
    def write_grids(path: Path, grids: Iterable[Grid]) -> None:
        write_blocks(path, grids, put, heights)

    def write_extruded(path: Path, grids: Iterable[Grid], heights: Heights) -> None:
        write_blocks(path, grids, put, heights)

    return Format(
        name=name,
        suffixes=suffixes,
        description=description,
        read_grids=read_grids,
        write_grids=write_grids,
        write_extruded=write_extruded,
        sniff=sniff,
        many=True,
    )


FORMATS = (
    _format("plot3d-ascii", (".p3d", ".xyz", ".fmt", ".x", ".dat"), "Plot3D text, 2D", put_text),
    # with z and nk = 1: VTK takes a counted two-dimensional float64 file for a three-dimensional float32 one
    _format(
        "plot3d-binary", (".bin", ".xyz", ".p3d"), "Plot3D C binary, float64, nk = 1", put_binary, (0.0,)
    ),
    _format("plot3d-fortran", (".ufmt", ".unf"), "Plot3D Fortran records, float64, 2D", put_fortran),
)
