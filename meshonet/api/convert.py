"""`meshonet.convert`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from meshonet.formats.convert import Conversion
from meshonet.formats.output import whole_file
from meshonet.formats.registry import Kind, format_for_output


def convert(
    source: str | Path,
    output: str | Path,
    *,
    extrude: float | None = None,
    planes: int | None = None,
    swap: bool = False,
    normalise: bool = False,
    coarsen: int = 1,
    from_format: str | None = None,
    to_format: str | None = None,
) -> None:
    """Turn a file from one format into another.

    Grids stay grids; what holds boundaries only becomes boundaries.

    Parameters
    ----------
    source, output : the files; several grids need a format that holds many.
    extrude : height in z of a 3D grid, one cell; None leaves grids flat.
    planes : with `extrude`, planes of nodes in z.
    swap : have xi run where eta ran (four-sided grids), still right-handed.
    normalise : scale to unit chord, leading edge at (0, 0); four-sided grids to unit length.
    coarsen : keep every so many-th node along xi and eta.
    from_format, to_format : formats, when endings and content do not say.

    Raises InputError: a format that cannot be read or written, or not in 3D; a height that is not positive;
    nodes that `coarsen` does not divide.
    """
    conversion = Conversion(extrude, planes, swap, normalise, coarsen)
    boundaries = conversion.of_boundaries(str(source), str(output), from_format, to_format)
    kind: Kind = "boundaries" if boundaries else "grids"
    fmt = format_for_output(str(output), to_format, kind)
    write: Callable[[Path, Iterable[Any]], None] = conversion.extruder(str(output), to_format) or getattr(
        fmt, f"write_{kind}"
    )
    members = conversion.read(str(source), from_format, boundaries=boundaries)
    with whole_file(str(output), make_folder=fmt.fills_folder, beside=fmt.fills_folder or fmt.beside) as part:
        write(part, (conversion(member) for member in members))
