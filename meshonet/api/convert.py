"""`meshonet.convert`."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from meshonet.formats.convert import Conversion
from meshonet.formats.output import whole_file
from meshonet.formats.registry import Kind, format_for_output
from meshonet.geometry.blocks.revolve import AxisLine


def convert(
    source: str | Path,
    output: str | Path,
    *,
    extrude: float | None = None,
    planes: int | None = None,
    swap: bool = False,
    normalise: bool = False,
    coarsen: int = 1,
    revolve: float | None = None,
    axis: Sequence[float] | None = None,
    from_format: str | None = None,
    to_format: str | None = None,
) -> None:
    """Turn a file from one format into another.

    Grids stay grids; a file that holds boundaries and no grids gives boundaries.

    Parameters
    ----------
    source, output : str or Path
        The files; several grids need a format that holds many.
    extrude : float, optional
        Height in z of the 3D grid to make; None leaves grids plane.
    planes : int, optional
        With `extrude`, planes of nodes in z, one more than cells; None is 2. With `revolve`, those about the
        axis; None is 2 up to 10 degrees, then cells of up to 4 degrees.
    swap : bool, optional
        Exchange the directions of xi and eta (four-sided grids), keeping grids right-handed.
    normalise : bool, optional
        Scale to unit chord, leading edge at (0, 0); four-sided grids to unit length.
    coarsen : int, optional
        Keep the nodes whose indices along xi and eta are multiples of this number.
    revolve : float, optional
        Degrees by which the 3D grid to make turns about `axis`: up to 10 a wedge, less than 360 a sector with
        periodic sides, 360 a whole turn.
    axis : sequence of float, optional
        Point and direction (x, y, dx, dy) of that line in the plane; None is the x axis.
    from_format, to_format : str, optional
        Formats, when endings and content do not say.

    Raises
    ------
    InputError
        A format that cannot be read, or written, or cannot hold 3D grids; a height that is not positive;
        an axis that runs through the grid; numbers of cells that `coarsen` does not divide.

    Examples
    --------
    >>> import meshonet
    >>> meshonet.tfi("naca:2412", res=(21, 9), refine=1).write("fine.vts")
    >>> convert("fine.vts", "coarse.cgns", coarsen=2)
    >>> meshonet.read("fine.vts").nodes.shape, meshonet.read("coarse.cgns").nodes.shape
    ((41, 17, 2), (21, 9, 2))
    """
    conversion = Conversion(
        extrude, planes, swap, normalise, coarsen, revolve, None if axis is None else AxisLine(*axis)
    )
    boundaries = conversion.of_boundaries(str(source), str(output), from_format, to_format)
    kind: Kind = "boundaries" if boundaries else "grids"
    fmt = format_for_output(str(output), to_format, kind)
    write: Callable[[Path, Iterable[Any]], None] = conversion.extruder(str(output), to_format) or getattr(
        fmt, f"write_{kind}"
    )
    members = conversion.read(str(source), from_format, boundaries=boundaries)
    folder = fmt.fills_folder
    with whole_file(fmt.file_at(str(output)), make_folder=folder, beside=folder or fmt.beside) as part:
        write(part, (conversion(member) for member in members))
