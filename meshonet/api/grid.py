"""`meshonet.grid`, and the functions of the commands that make grids and boundaries."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np

from meshonet.api.files import read
from meshonet.api.notes import noted
from meshonet.formats.layout.read import layout_of
from meshonet.formats.mesh.recover_topology import boundary_of
from meshonet.formats.registry import read_shapes
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import InputError, meant
from meshonet.geometry.families.draw import draws
from meshonet.geometry.shapes.assembly import assembled
from meshonet.geometry.shapes.closed_curve import closed_curve
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.geometry.shapes.polygon_shape import domain_or_body
from meshonet.geometry.shapes.shape import Shape, SpatialShape, edges_of
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.pipeline.make_grid import make_grid
from meshonet.solvers.pipeline.parameters import SAMPLED, grid_request, sampling_of
from meshonet.solvers.pipeline.uses import Counts

AnyShape: TypeAlias = str | Path | Floats | Shape | Grid | Domain
"""A path, a designation such as ``naca:2412``, points of an outline, nodes in space, or such an object."""


def grid(
    shape: AnyShape | Sequence[AnyShape],
    *,
    res: Counts | None = None,
    method: str = "best",
    assemble: bool = False,
    **parameters: Any,
) -> Grid:
    """Return a valid grid inside a boundary, around a body, in a multi-block domain, or in a volume.

    The grid has the methods `write`, `quality` and `to_pyvista`, and the attribute `notes`.
    `meshonet.make_grid` also returns quality and times.

    Parameters
    ----------
    shape : str, Path, array, Grid, Boundary or Domain, or a list of these
        A plane shape: a file, a designation such as ``naca:0012``, points (n, 2) of a closed outline, a
        boundary, a `meshonet.Domain`, or a grid, of which only the boundary is used; with `assemble` a list
        of these. A shape in space: nodes (ni, nj, nk, 3) of a volume, of which only the six faces are used,
        or a list of surface patches (ni, nj, 3).
    assemble : bool, optional
        Combine all shapes in the list into one domain.
    res : int or tuple of int, optional
        Number of nodes along xi (around a body), eta (away from it) and, for volumes, zeta; one number for
        all directions. For multi-block grids, number of cells along the longest extent.
    method : str, optional
        ``best`` for the default method of the kind of shape, ``auto`` for the default among elliptic methods
        and marching, a key of `meshonet.METHODS`, or ``operator:NAME`` for a neural operator.
    **parameters
        Fields of `meshonet.Sampling` and `meshonet.GridRequest`, such as ``topology``, ``far_field``,
        ``y_plus``, ``reynolds``, ``growth``, ``repair``, ``cells``, ``cell_size``, ``walls``, ``layout`` (a
        `meshonet.Layout` or a file) and ``periodic`` (pairs of names); also settings of the method, such as
        ``tol``.

    Returns
    -------
    Grid
        A grid without folded cells, unless `allow_invalid` is given.

    Raises
    ------
    InputError
        A shape or parameter that cannot be used.
    NoValidGridError
        The grid has folded cells, and `allow_invalid` is not given.
    SolverError
        The method diverged.

    Examples
    --------
    >>> made = grid("naca:2412", res=(81, 31))
    >>> made.ni, made.nj, made.topology, made.quality().folded
    (81, 31, 'o', 0)
    """
    request = grid_request(method, res=res, **domain_parameters(parameters))
    if request.of_surface and isinstance(shape, str | Path):
        shape = next(read_shapes(str(shape), surfaces=True))
    return noted(make_grid(shape_of(shape, assembled_by=request.sampling if assemble else None), request))


def domain_parameters(parameters: dict[str, Any]) -> dict[str, Any]:
    """Return `parameters` with the layout of a file read, and the names of walls and sides as tuples."""
    layout, walls = parameters.get("layout"), parameters.get("walls", ())
    if isinstance(layout, str | Path):
        parameters = parameters | {"layout": layout_of(str(layout))}
    if not isinstance(walls, tuple):
        parameters = parameters | {"walls": tuple(walls.split(",") if isinstance(walls, str) else walls)}
    if parameters.get("periodic"):
        pairs = [tuple(pair.split(",") if isinstance(pair, str) else pair) for pair in parameters["periodic"]]
        parameters = parameters | {"periodic": tuple(pairs)}
    return parameters


def tfi(shape: AnyShape, *, res: Counts | None = None, method: str = "tfi", **parameters: Any) -> Grid:
    """Return a grid by transfinite interpolation.

    Parameters
    ----------
    shape, res, method, **parameters
        As for `grid`; also ``blending``, a setting of ``tfi``: ``arclength`` or ``linear``.

    Returns
    -------
    Grid
        The grid.

    Raises
    ------
    InputError, NoValidGridError, SolverError
        As for `grid`.

    Examples
    --------
    >>> tfi("naca:2412", res=(41, 17), blending="linear").nodes.shape
    (41, 17, 2)
    """
    return grid(shape, res=res, method=method, **parameters)


def solve_pde(shape: AnyShape, *, res: Counts | None = None, method: str = "auto", **parameters: Any) -> Grid:
    """Return a grid by elliptic equations, a variational method or marching.

    Parameters
    ----------
    shape, res, method, **parameters
        As for `grid`.

    Returns
    -------
    Grid
        The grid.

    Raises
    ------
    InputError, NoValidGridError, SolverError
        As for `grid`.

    Examples
    --------
    >>> solve_pde("naca:2412", res=(41, 17), method="winslow").quality().folded
    0
    """
    return grid(shape, res=res, method=method, **parameters)


def infer(shape: AnyShape, *, res: Counts | None = None, model: str | None = None, **parameters: Any) -> Grid:
    """Return a grid by the default method of the kind of shape, or by a neural operator.

    Parameters
    ----------
    shape, res, **parameters
        As for `grid`.
    model : str, optional
        Name of a shipped neural operator, a ``.safetensors`` file, or ``base`` for the conformal solver.
        None: the default method of the kind of shape.

    Returns
    -------
    Grid
        The grid.

    Raises
    ------
    InputError, NoValidGridError, SolverError
        As for `grid`.

    Examples
    --------
    >>> infer("naca:2412", res=(41, 17)).quality().folded
    0
    """
    return grid(shape, res=res, method="best", model=model, **parameters)


def sample_boundary(
    shape: AnyShape, *, res: Counts | None = None, sensors: int | None = None, **parameters: Any
) -> Boundary:
    """Return the four edges of a shape.

    Parameters
    ----------
    shape, res
        As for `grid`.
    sensors : int, optional
        Number of boundary nodes that are also stored as sensors, the input of some neural operators.
    **parameters
        Fields of `meshonet.Sampling`, such as ``topology``, ``te_spacing``, ``far_field``.

    Returns
    -------
    Boundary
        The edges.

    Raises
    ------
    InputError
        A shape or parameter that cannot be used.

    Examples
    --------
    >>> edges = sample_boundary("naca:0012", res=(61, 21), far_field=20)
    >>> edges.south.shape, edges.topology
    ((61, 2), 'o')
    """
    edges = edges_of(shape_of(shape), sampling_of(res, parameters))
    for name in parameters:
        near = meant(name, ("res", "sensors", *SAMPLED))
        raise InputError(f"a boundary has no {{{name}}}", f"{near}leave {{{name}}} out")
    return edges if sensors is None else edges.with_sensors(sensors)


def sample_family(
    family: str,
    count: int = 1,
    *,
    res: Counts | None = None,
    range: tuple[float, float] | None = None,  # noqa: A002 - called as the option is
    seed: int = 0,
    split: str | None = None,
) -> list[Boundary]:
    """Return random boundaries of a family of shapes, like ``sample-boundary --family``.

    Parameters
    ----------
    family : str
        ``arch``, ``hexagon``, ``wrench``, ``semicircle``, ``airfoil``, ``hole``, ``procedural``,
        ``four-sided`` or ``bodies``.
    count : int, optional
        Number of boundaries.
    res : int or tuple of int, optional
        Numbers of nodes, as for `grid`; None: 101 along xi and eta.
    range : tuple of 2 float, optional
        Interval from which the family's parameter is drawn; None: its whole range.
    seed : int, optional
        Seed of the random numbers.
    split : str, optional
        Rule that selects one sixth of the shapes for tests: ``interpolation``, ``extrapolation``, ``random``.

    Returns
    -------
    list of Boundary
        The boundaries.

    Raises
    ------
    InputError
        An unknown family; an interval outside of the family's range; a family that cannot be split.

    Examples
    --------
    >>> [edges.south.shape for edges in sample_family("arch", 2, res=(31, 11), seed=1)]
    [(31, 2), (31, 2)]
    """
    spread = None if range is None else "{!r}:{!r}".format(*range)
    sampling = sampling_of(res, {})
    return [member.boundary(sampling) for member in draws(family, count, spread, seed, split)]


def shape_of(shape: AnyShape | Sequence[AnyShape], *, assembled_by: Sampling | None = None) -> Shape:
    """Return a shape that can be sampled; with `assembled_by`, the domain formed by several shapes.

    Raises InputError: a file that cannot be read; an array with a shape other than (n, 2).
    """
    if assembled_by is not None:
        members = [shape] if isinstance(shape, str | Path) else list(cast(Sequence[AnyShape], shape))
        names = [Path(each).stem if isinstance(each, str | Path) else "" for each in members]
        shapes = [shape_of(each) for each in members]
        names = [name or each.name or "body" for name, each in zip(names, shapes, strict=True)]
        return assembled(shapes, names, assembled_by, "+".join(names))
    if isinstance(shape, Domain):
        return DomainShape(shape)
    if isinstance(shape, str | Path):
        shape = cast(AnyShape, read(shape))
    if isinstance(shape, Grid):
        return boundary_of(shape)
    if hasattr(shape, "boundary"):
        return cast(Shape, shape)
    if isinstance(shape, list | tuple) and any(map(_is_shape, shape)):
        remedy = "make one domain of them by grid(..., {assemble}=True), or call this for each"
        raise InputError(f"a list of {len(shape)} shapes", remedy, parameter="shape")
    if isinstance(shape, list | tuple) and all(np.ndim(each) == 3 for each in shape):
        return SpatialShape(Grid(tuple(Block(np.asarray(each)) for each in shape)))
    try:
        points = np.asarray(cast(Floats, shape), dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(
            f"this {type(shape).__name__} is no array", "give (n, 2)", parameter="shape"
        ) from None
    if points.ndim == 4:
        return SpatialShape(Grid((Block(points),)))
    if points.ndim != 2 or points.shape[1] != 2:
        raise InputError(f"points of shape {points.shape}", "give (n, 2)", parameter="shape")
    return domain_or_body(closed_curve(points, ""))


def _is_shape(each: Any) -> bool:
    return isinstance(each, str | Path | Grid | Domain) or hasattr(each, "boundary")
