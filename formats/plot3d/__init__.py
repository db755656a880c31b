"""Plot3D grids: read in every variant, written as text, C binary or Fortran records.

https://www.grc.nasa.gov/WWW/wind/valid/plot3d.html
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from meshonet.formats.format import Format, Heights
from meshonet.formats.plot3d.sniff import sniff
from meshonet.formats.plot3d.variant import ANY, Variant, parse_variant
from meshonet.formats.source import Source
from meshonet.geometry.blocks.grid import Grid

_SUFFIXES = {
    "ascii": (".p3d", ".xyz", ".fmt", ".x", ".dat"),
    "binary": (".bin", ".xyz", ".p3d"),
    "fortran": (".ufmt", ".unf"),
}
_TOLD = {
    "ascii": "Plot3D text, 2D",
    "binary": "Plot3D C binary, float64, nk = 1",
    "fortran": "Plot3D Fortran records, float64, 2D",
}


def _read(source: Source, variant: Variant = ANY) -> Iterator[Grid]:
    from meshonet.formats.plot3d.read import read_grids  # loaded when there is a grid to read

    return read_grids(source, variant)


def _format(kind: str, given: Variant | None = None) -> Format:
    """Return the format of a kind, all that `given` says of it on top."""
    variant = Variant((given or ANY).words | {kind})
    # with z and nk = 1: VTK takes a counted two-dimensional float64 file for a three-dimensional float32 one
    solid = variant.one_of("2d", "3d", default="3d" if kind == "binary" else "2d") == "3d"

    def read_as_told(source: Source) -> Iterator[Grid]:
        return _read(source, given or ANY)

    def write_grids(path: Path, grids: Iterable[Grid]) -> None:
        from meshonet.formats.plot3d.write import write_blocks

        write_blocks(path, grids, variant.for_writing(), (0.0,) if solid else ())

    def write_extruded(path: Path, grids: Iterable[Grid], heights: Heights) -> None:
        from meshonet.formats.plot3d.write import write_blocks

        write_blocks(path, grids, variant.for_writing(), heights)

    return Format(
        name=f"plot3d-{kind}",
        suffixes=_SUFFIXES[kind],
        description=_TOLD[kind],
        read_grids=read_as_told if given else _read,
        write_grids=write_grids,
        write_extruded=write_extruded,
        sniff=sniff,
        many=True,
    )


def variant_of(found: Format, text: str) -> Format:
    """Return a Plot3D format in the variant of comma-separated words (`meshonet.formats.plot3d.variant`)."""
    given = parse_variant(text)
    return _format(
        given.one_of("ascii", "binary", "fortran", default=found.name.removeprefix("plot3d-")), given
    )


FORMATS = tuple(_format(kind) for kind in _SUFFIXES)
