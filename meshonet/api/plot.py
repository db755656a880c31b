"""`meshonet.plot`."""

from collections.abc import Sequence
from pathlib import Path

from meshonet.api.quality import single_grid
from meshonet.formats.figure.picture import Picture
from meshonet.formats.output import whole_file
from meshonet.formats.registry import picture_format
from meshonet.geometry.blocks.grid import Grid


def plot(
    grid: Grid | str | Path,
    output: str | Path,
    *,
    metric: str | None = "max_angle",
    zoom: tuple[float, ...] | None = None,
    every: int | None = None,
    slice: str | None = None,  # noqa: A002
    seen_from: tuple[float, float] | None = None,
    up: str | None = None,
    span: float | Sequence[float] = (),
    meridional: bool = False,
    to_format: str | None = None,
) -> None:
    """Draw a grid, coloured by a quality metric.

    Parameters
    ----------
    grid : Grid, str or Path
        A grid, or a file with one.
    output : str or Path
        File to write: a picture (``.png``, ``.svg`` or ``.pdf``) or an interactive page (``.html``).
    metric : str, optional
        Quality metric that colours the cells; None draws lines only.
    zoom : tuple of float, optional
        Region to show: x0, x1, y0, y1, and for grids in space also z0, z1. For a slice, give
        six numbers for a box or four numbers for a rectangle in the plane of the slice. None: the whole grid.
    every : int, optional
        Draw every K-th grid line; None: as many lines as can be distinguished.
    slice : str, optional
        Slice of a volume: a grid surface such as ``i=10`` or ``k=-1``, or a plane such as ``x=.5``. None: the
        walls are drawn, or the whole boundary of a volume without walls.
    seen_from : tuple of 2 float, optional
        Direction from which a grid in space is seen: azimuth and elevation in degrees; None: -125, 25.
        Azimuth 0 is x if z is `up`, y if x is, and z if y is.
    up : str, optional
        Axis that points upwards in the view of a grid in space: ``x``, ``y`` or ``z`` (default).
    span : float or sequence of float, optional
        Fractions of the span of a blade row, from 0 at the hub to 1 at the shroud, at which sections are
        drawn.
    meridional : bool, optional
        Draw the meridional section of a blade row, in x and r.
    to_format : str, optional
        ``png``, ``svg``, ``pdf`` or ``html``; needed if the extension does not determine it.

    Raises
    ------
    InputError
        An unknown metric, slice or extension; a region without cells; a file that cannot be read or written.

    Examples
    --------
    >>> import meshonet
    >>> plot(meshonet.tfi("naca:2412", res=(41, 17)), "grid.png", metric=None)
    """
    spans = tuple(span) if isinstance(span, Sequence) else (span,)
    picture = Picture(zoom, every, slice, seen_from, up, spans, meridional, metric)
    kind = picture_format(str(output), to_format).name
    with whole_file(str(output)) as part:
        picture.draw(kind, part, [single_grid(grid)])
