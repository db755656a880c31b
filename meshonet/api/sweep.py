"""`meshonet.sweep`."""

from pathlib import Path as File
from typing import Any, TypeAlias

import numpy as np

from meshonet.api.files import only
from meshonet.api.grid import AnyShape, domain_parameters
from meshonet.api.notes import noted
from meshonet.formats.path import path_of
from meshonet.formats.registry import read_sections
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.revolve import Revolution
from meshonet.geometry.curves.path import Path, SplinePath
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.geometry.shapes.outline import Outline
from meshonet.solvers.pipeline.parameters import grid_request
from meshonet.solvers.pipeline.sweeps import make_sweep
from meshonet.solvers.pipeline.uses import Counts
from meshonet.solvers.sweeping.sweep import Sweep

AnyPath: TypeAlias = str | File | Floats | Path | Revolution
"""A file, points (n, 3) of a smooth curve, a path, or a revolution about an axis."""


def sweep(
    outline: AnyShape,
    path: AnyPath,
    *,
    planes: int | None = None,
    up: tuple[float, float, float] | None = None,
    twist: float = 0.0,
    scale: float = 1.0,
    res: Counts | None = None,
    around: int | None = None,
    **parameters: Any,
) -> Grid:
    """Return the volume grid of a cross-section swept along a curve in space.

    Parameters
    ----------
    outline : str, Path, array, Grid, Boundary or Domain
        Cross-section: ``circle:RADIUS``; a file with a closed curve, a domain or a planar grid; or one of
        these as an object.
    path : str, Path, array (n, 3) or Revolution
        Path: a file, an array of points on a smooth curve, or a `meshonet.Revolution` about an axis.
    planes : int, optional
        Number of planes of nodes along the path, as for `meshonet.Sweep`.
    up : tuple of 3 float, optional
        Direction in which the y axis of the section points at the start of the path, as closely as possible.
    twist : float, optional
        Rotation of the section from start to end in degrees.
    scale : float, optional
        Size of the last section relative to the first.
    res : int or tuple of int, optional
        Number of nodes along the sides of a four-sided section.
    around : int, optional
        Number of cells around a circle, a multiple of four. None: at least 88; the area is then accurate to
        0.1 %.
    **parameters
        Options for the grid of the section: ``cells``, ``cell_size``, ``first_cell``, ``y_plus``,
        ``reynolds``, ``growth``, ``walls``, ``layout``, and ``allow_invalid``.

    Returns
    -------
    Grid
        The volume grid, with `notes`.

    Raises
    ------
    InputError
        A section, path or parameter that cannot be used; a bend that is too tight for the section.
    NoValidGridError
        The grid has folded cells, and `allow_invalid` is not given.

    Examples
    --------
    >>> bend = sweep("circle:0.5", np.array([[0, 0, 0], [1, 0, 0], [2, 1, 0], [2, 2, 0]]), around=32)
    >>> len(bend.blocks), sorted({patch.name for patch in bend.patches})
    (5, ['inlet', 'outlet', 'wall'])
    """
    request = grid_request(res=res, **domain_parameters(parameters))
    curve = SplinePath(path) if isinstance(path, np.ndarray) else path
    curve = path_of(str(curve)) if isinstance(curve, str | File) else curve
    return noted(make_sweep(_section(outline), curve, request, Sweep(planes, up, twist, scale), around))


def _section(outline: AnyShape) -> Any:
    if isinstance(outline, str | File):
        return only(read_sections(str(outline)), outline, "a closed curve or a planar grid")
    if isinstance(outline, Domain):
        return DomainShape(outline)
    return Outline(outline) if isinstance(outline, np.ndarray) else outline
