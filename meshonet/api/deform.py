"""`meshonet.deform`."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np

from meshonet.api.files import read
from meshonet.api.notes import noted
from meshonet.api.quality import single_grid
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.errors import InputError
from meshonet.solvers.deformation.targets import NewWall
from meshonet.solvers.pipeline.deformations import DeformRequest, make_deformed

AnyWall: TypeAlias = NewWall | str | Path
"""A file with an outline or a grid, its content, a designation such as ``naca:2412``, nodes, or a motion."""


def deform(
    grid: Grid | str | Path,
    wall: AnyWall | Mapping[str, AnyWall],
    *,
    allow_invalid: bool = False,
    threads: int | None = None,
) -> Grid:
    """Deform a grid to a changed boundary and keep its boundary layers.

    Parameters
    ----------
    grid : Grid, str or Path
        A planar grid or a volume, or a file with one.
    wall : str, Path, Grid, Boundary, Motion or array, or dict of these by name
        New shape of the wall; for several walls, a dict from names to shapes. If the shape is an outline,
        each wall node moves to the same fraction of the arc length between corners. If it is a grid, a
        boundary or an array of nodes (n, d), each wall node moves to the node of the same index. A
        `meshonet.Motion` moves the wall as a rigid body. A single grid, not in a dict, gives new shapes to
        all parts of the boundary whose names occur in both grids.
    allow_invalid : bool, optional
        Return the grid even if cells are folded.
    threads : int, optional
        Number of threads; None is one per core.

    Returns
    -------
    Grid
        The deformed grid.

    Raises
    ------
    InputError
        A file, wall or shape that cannot be used; an initial grid with folded cells.
    NoValidGridError
        The deformed grid has folded cells; the attribute ``worst`` of the error lists the worst cells.

    Examples
    --------
    >>> import meshonet
    >>> start = meshonet.grid("naca:0012", res=(81, 31), te="wedge")
    >>> moved = deform(start, "naca:2412")
    >>> moved.quality().folded
    0
    """
    request = DeformRequest(allow_invalid, threads=threads)
    return noted(make_deformed(single_grid(grid), read_walls(wall), request))


def read_walls(wall: AnyWall | Mapping[str, AnyWall]) -> NewWall | dict[str, NewWall]:
    """Return new walls, after reading those that are given as files."""
    return {name: _read(new) for name, new in wall.items()} if isinstance(wall, Mapping) else _read(wall)


def _read(wall: AnyWall) -> NewWall:
    return read(wall) if isinstance(wall, str | Path) else wall


def rotation(degrees: float, about: Sequence[float] = (0.0, 0.0)) -> Motion:
    """Return the rotation of the plane about a point, counter-clockwise.

    Parameters
    ----------
    degrees : float
        Angle in degrees, counter-clockwise.
    about : tuple of 2 float, optional
        Centre of the rotation.

    Returns
    -------
    Motion
        The rotation.

    Raises
    ------
    InputError
        An angle or point that is not finite; a point that is not (x, y).

    Examples
    --------
    >>> rotation(90, about=(1, 0))(np.array([[2.0, 0.0]])).round(12).tolist()
    [[1.0, 1.0]]
    """
    if not np.isfinite([degrees, *about]).all() or len(about) != 2:
        raise InputError(f"a turn of {degrees} about {tuple(about)}", "give an angle and a point (x, y)")
    sine, cosine = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    x, y = about
    shift = x - cosine * x + sine * y, y - sine * x - cosine * y
    return Motion(shift, ((cosine, -sine), (sine, cosine)))
