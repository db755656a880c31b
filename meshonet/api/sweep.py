"""`meshonet.sweep`."""

from pathlib import Path as File
from typing import Any, TypeAlias

import numpy as np

from meshonet.api.files import only
from meshonet.api.grid import AnyShape, domain_parameters
from meshonet.formats.path import path_of
from meshonet.formats.section import read_sections
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.revolve import Revolution
from meshonet.geometry.curves.path import Path, SplinePath
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.geometry.shapes.outline import Outline
from meshonet.solvers.pipeline.parameters import Counts, grid_request
from meshonet.solvers.pipeline.sweeps import make_sweep
from meshonet.solvers.sweeping.sweep import Sweep

AnyPath: TypeAlias = str | File | Floats | Path | Revolution
"""A file, points (n, 3) that a smooth curve goes through, a path itself, or a turn about an axis."""


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
    """Return the volume of a cross-section carried along a curve in space.

    Parameters
    ----------
    outline : str, Path, array, Grid, Boundary or Domain
        ``circle:RADIUS``, a file with a closed curve, a domain or a planar grid, or what these are.
    path : str, Path, array (n, 3) or Revolution
        A file, points that a smooth curve goes through, a path itself, or a turn about an axis
        (`meshonet.Revolution`).
    planes : int, optional
        As of `meshonet.Sweep`, like the next three.
    up : tuple of 3 float, optional
        Direction that the section's y axis is nearest to where the path starts.
    twist : float, optional
        Degrees by which the section turns along the path.
    scale : float, optional
        Size of the last section over that of the first.
    res : int or tuple of int, optional
        Nodes along the sides of a four-sided section.
    around : int, optional
        Cells around a circle, a multiple of four; None: at least 88, with which its area is within 0.1 %.
    **parameters
        Of the section's grid: ``cells``, ``cell_size``, ``first_cell``, ``y_plus``, ``reynolds``, ``growth``,
        ``walls``, ``layout``, and ``allow_invalid``.

    Returns
    -------
    Grid

    Raises
    ------
    InputError
        A section, path or parameter that cannot be used, a bend too tight for the section.
    NoValidGridError
        Cells are folded, and `allow_invalid` was not given.

    Examples
    --------
    >>> bend = sweep("circle:0.5", np.array([[0, 0, 0], [1, 0, 0], [2, 1, 0], [2, 2, 0]]), around=32)
    >>> len(bend.blocks), sorted({patch.name for patch in bend.patches})
    (5, ['inlet', 'outlet', 'wall'])
    """
    request = grid_request(res=res, **domain_parameters(parameters))
    curve = SplinePath(path) if isinstance(path, np.ndarray) else path
    curve = path_of(str(curve)) if isinstance(curve, str | File) else curve
    return make_sweep(_section(outline), curve, request, Sweep(planes, up, twist, scale), around).grid


def _section(outline: AnyShape) -> Any:
    if isinstance(outline, str | File):
        return only(read_sections(str(outline)), outline, "a closed curve or a planar grid")
    if isinstance(outline, Domain):
        return DomainShape(outline)
    return Outline(outline) if isinstance(outline, np.ndarray) else outline
