"""`meshonet.convert`."""

from collections.abc import Callable, Iterable, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from meshonet.api.files import inputs, put_whole
from meshonet.formats.convert import Conversion
from meshonet.formats.registry import Kind, format_for_output
from meshonet.geometry.blocks.revolve import AxisLine
from meshonet.geometry.errors import InputError


def convert(
    source: str | Path | Sequence[str | Path],
    output: str | Path,
    *,
    extrude: float | None = None,
    planes: int | None = None,
    swap: bool = False,
    normalise: bool = False,
    coarsen: int = 1,
    revolve: float | None = None,
    axis: Sequence[float] | None = None,
    copies: int | Sequence[int] = 1,
    scale: float = 1.0,
    from_format: str | None = None,
    to_format: str | None = None,
) -> None:
    """Convert a file, or the files of a folder, an archive or a list, from one format to another.

    If the first file contains grids, the output contains grids; otherwise it contains boundaries.

    Parameters
    ----------
    source : str, Path or list of these
        Input files, folders and archives, as for `inputs`.
    output : str or Path
        Output file; several grids need a format that can store several.
    extrude : float, optional
        Height of an extrusion along z; None: no extrusion.
    planes : int, optional
        Number of planes of nodes, one more than the number of cells. None: 2 planes with `extrude`, and with
        `revolve` up to 10 degrees; above 10 degrees, cells of at most 4 degrees.
    swap : bool, optional
        Exchange xi and eta of four-sided grids, which stay right-handed.
    normalise : bool, optional
        Scale and move the grid to unit chord, or unit length of four-sided grids, with the leading edge at
        (0, 0).
    coarsen : int, optional
        Keep only nodes whose indices along xi and eta are multiples of this number.
    revolve : float, optional
        Angle in degrees of a revolution about `axis`. Up to 10 degrees the result is a wedge of one cell,
        below 360 degrees a sector with periodic sides, and with 360 degrees a full ring.
    axis : sequence of float, optional
        Axis of the revolution in the plane: point and direction (x, y, dx, dy); None is the x axis.
    copies : int or sequence of int, optional
        Number of joined copies of a periodic grid, such as a passage of a blade row; one number for each
        periodic direction.
    scale : float, optional
        Factor by which all lengths are multiplied; 0.001 converts millimetres to metres.
    from_format, to_format : str, optional
        Formats of input and output; needed if extensions and content do not determine them.

    Raises
    ------
    InputError
        A format that cannot be read or written, or cannot store three-dimensional grids; a height that is not
        positive; an axis that intersects the grid; numbers of cells that are not multiples of `coarsen`;
        `copies` of a grid that is not periodic, or in more directions than it is periodic; a `scale` that is
        not positive.

    Examples
    --------
    >>> import meshonet
    >>> meshonet.tfi("naca:2412", res=(21, 9), refine=1).write("fine.vts")
    >>> convert("fine.vts", "coarse.cgns", coarsen=2)
    >>> meshonet.read("fine.vts").nodes.shape, meshonet.read("coarse.cgns").nodes.shape
    ((41, 17, 2), (21, 9, 2))
    """
    conversion = Conversion(
        extrude, planes, swap, normalise, coarsen, revolve, None if axis is None else AxisLine(*axis),
        copies if isinstance(copies, int) else tuple(copies), scale,
    )  # fmt: skip
    names = inputs(source)
    first = next(names, None)
    if first is None:
        raise InputError("there is nothing to convert", "name a file or a folder", parameter="source")
    boundaries = conversion.of_boundaries(first, str(output), from_format, to_format)
    kind: Kind = "boundaries" if boundaries else "grids"
    fmt = format_for_output(str(output), to_format, kind)
    write: Callable[[Path, Iterable[Any]], None] = conversion.extruder(str(output), to_format) or getattr(
        fmt, f"write_{kind}"
    )
    members = (
        conversion(member)
        for name in chain([first], names)
        for member in conversion.read(name, from_format, boundaries=boundaries)
    )
    put_whole(fmt, output, write, members)
