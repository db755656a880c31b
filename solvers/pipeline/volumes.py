"""Grids in space: which way a shape is made a volume, and what of a request is of use to it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from importlib import import_module

from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.spatial_shape import SpatialShape
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.geometry.spacing.y_plus import first_cell, height_note
from meshonet.solvers.pipeline.parameters import COUNTED
from meshonet.solvers.pipeline.request import OF_VOLUMES, GridRequest
from meshonet.solvers.solution import Solution

_ALWAYS = ("method", "settings", "allow_invalid", "percentiles", "history", "threads", "sampling", "repair")
_OPEN = ("best", "auto")
"""Names that leave the method open."""
_FILLERS = {
    "variational": ("max_cycles", "coarse", "energy"),
    "winslow": ("tol", "max_cycles"),
    "tfi": ("blending",),
}
"""Methods that fill six faces, in `meshonet.solvers.volumes`, and their settings."""


@dataclass(frozen=True)
class _Way:
    """A way to volumes.

    Parameters
    ----------
    what : what it does, for messages.
    methods : names of the methods that are made in this way.
    uses : parameters of the request, its sampling and settings that it has a use for.
    make : the solution of a shape.
    """

    what: str
    methods: tuple[str, ...]
    uses: tuple[str, ...]
    make: Callable[[SpatialShape, GridRequest], Solution]


def make_volume(shape: SpatialShape, request: GridRequest) -> Solution:
    """Return the volume grid that `request` makes of a shape: marched, filled from its faces, or smoothed.

    Raises InputError: method, parameters and shape do not go together; the shape bounds no volume;
    NoValidGridError: cells stay folded.
    """
    way = _way(shape, request)
    if request.method not in (*_OPEN, *way.methods):
        problem = f"method {request.method} makes no volumes of {way.what}"
        raise InputError(problem, f"use {' or '.join(way.methods)}", parameter="method")
    for name in _chosen(request):
        if name not in way.uses:
            raise InputError(f"{{{name}}} is of no use to {way.what}", f"leave {{{name}}} out")
    return way.make(shape, request)


def check_plane(request: GridRequest) -> None:
    """Raise InputError for parameters that only grids in space have a use for."""
    for name in OF_VOLUMES:
        if getattr(request, name) is not None:
            raise InputError(f"{{{name}}} is of no use to a grid in the plane", f"leave {{{name}}} out")
    if request.sampling.nk is not None:
        problem = f"{request.sampling.nk} nodes along a third direction of a grid in the plane"
        raise InputError(problem, "give NI x NJ", parameter="res")


def _way(shape: SpatialShape, request: GridRequest) -> _Way:
    if request.method == "hyperbolic":
        return _MARCH
    if not shape.is_surface and len(shape.grid.blocks) > 1:
        return _SMOOTH
    if shape.is_surface and request.method in _OPEN and request.at_walls:
        return _MARCH
    return _FILL


def _chosen(request: GridRequest) -> Iterator[str]:
    """Yield names of what was chosen and is not so by default."""
    plain, sampling = GridRequest(), request.sampling
    for each in fields(Sampling):
        if getattr(sampling, each.name) != getattr(plain.sampling, each.name):
            yield "res" if each.name in COUNTED else each.name
    for each in fields(GridRequest):
        if each.name not in _ALWAYS and getattr(request, each.name) != getattr(plain, each.name):
            yield each.name
    yield from (name for name in request.settings if name in request.chosen)


def _march(shape: SpatialShape, request: GridRequest) -> Solution:
    from meshonet.geometry.surface.surface import surface_of
    from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface

    if not shape.is_surface:
        raise InputError("marching starts from a surface and this is a volume", "give its wall alone")
    height, note = _height(request)
    settings = VolumeMarch(
        first_cell=height, layers=request.layers, far_field=request.sampling.far_field,
        symmetry=request.symmetry, growth=request.growth,
    )  # fmt: skip
    solution = march_surface(surface_of(shape.grid), settings)
    return _noted(solution, note)


def _height(request: GridRequest) -> tuple[float, str]:
    """Return the height of the first cell in the surface's unit, and where it comes from."""
    if request.first_cell is not None:
        return request.first_cell, ""
    if request.y_plus is None or request.reynolds is None:
        raise InputError("{method} hyperbolic without a first cell", "give {first_cell} or {y_plus} as well")
    height = first_cell(request.y_plus, request.reynolds, request.chord_fraction)
    return height, height_note(request.y_plus, request.reynolds, "on a length of 1", f"{height:.6g}")


def _fill(shape: SpatialShape, request: GridRequest) -> Solution:
    from meshonet.geometry.blocks.six_patches import six_faces

    faces = six_faces(shape.grid)
    counts = _counts(request.sampling)
    if counts is not None:
        faces = faces.resampled(counts)
    name = "variational" if request.method in _OPEN else request.method
    settings = {each: value for each, value in request.settings.items() if each in request.chosen}
    if request.coarse != "auto":
        settings["coarse"] = request.coarse
    if request.energy is not None:
        settings["energy"] = request.energy
    for each in settings:
        if each not in _FILLERS[name]:
            raise InputError(f"{{{each}}} is of no use to {name} in space", f"leave {{{each}}} out")
    fill = getattr(import_module(f"meshonet.solvers.volumes.{name}"), name)
    return _noted(fill(faces, **settings), *faces.notes)


def _counts(sampling: Sampling) -> tuple[int, int, int] | None:
    """Return the nodes along each direction that are asked for."""
    ni, nj, nk = sampling.ni, sampling.nj, sampling.nk
    if ni is None or nj is None:
        return None
    if nk is None and ni != nj:
        problem = f"{ni} x {nj} nodes for three directions"
        raise InputError(problem, "give NIxNJxNK, or N", parameter="res")
    return ni, nj, ni if nk is None else nk


def _smooth(shape: SpatialShape, request: GridRequest) -> Solution:
    from meshonet.solvers.smoothing.volumes import smooth_volumes

    iterations = request.settings.get("max_cycles")
    more = {} if iterations is None else {"iterations": iterations}
    return smooth_volumes(shape.grid, slide=bool(request.slide), **more)


def _noted(solution: Solution, *notes: str) -> Solution:
    return replace(solution, notes=(*(note for note in notes if note), *solution.notes))


_MARCH = _Way(
    "marching from a surface", ("hyperbolic",),
    ("first_cell", "y_plus", "reynolds", "chord_fraction", "growth", "far_field", "layers", "symmetry"),
    _march,
)  # fmt: skip
_FILL = _Way(
    "six faces", tuple(_FILLERS), ("res", "coarse", "blending", "tol", "max_cycles", "energy"), _fill
)  # fmt: skip
_SMOOTH = _Way("blocks that are there already", ("variational",), ("max_cycles", "slide"), _smooth)
