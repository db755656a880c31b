"""Three-dimensional grids: selects the method for a shape, and checks which options apply."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module

from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import SpatialShape
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.pipeline.request import Volume
from meshonet.solvers.pipeline.uses import INSIDE, JOINED, OFF_SURFACE, refuse
from meshonet.solvers.solution import Solution

_OPEN = ("best", "auto")  # method names that leave the choice to the program


@dataclass(frozen=True)
class _VolumeMethod:
    """A way to make volume grids: name in the table of options, methods, and function of a shape."""

    what: str
    methods: tuple[str, ...]
    make: Callable[[SpatialShape, Volume], Solution]


def make_volume(shape: SpatialShape, request: Volume) -> Solution:
    """Return the volume grid of a shape: marched from a surface, filled inside six faces, or smoothed.

    Raises InputError if parameters and shape do not suit each other, or if the shape encloses no volume.
    Raises NoValidGridError if the grid has folded cells.
    """
    way = _way(shape, request)
    if request.method not in (*_OPEN, *way.methods):
        problem = f"method {request.method} makes no volumes of {way.what}"
        raise InputError(problem, f"use {' or '.join(way.methods)}", parameter="method")
    refuse(request.chosen, way.what)
    return way.make(shape, request)


def _way(shape: SpatialShape, request: Volume) -> _VolumeMethod:
    if request.method == "hyperbolic":
        return _MARCH
    if not shape.is_surface and len(shape.grid.blocks) > 1:
        return _SMOOTH
    if shape.is_surface and request.method in _OPEN and request.at_walls:
        return _MARCH
    return _FILL


def _march(shape: SpatialShape, request: Volume) -> Solution:
    from meshonet.geometry.surface.surface import surface_of
    from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface

    if not shape.is_surface:
        raise InputError("marching starts from a surface and this is a volume", "give its wall alone")
    height = request.height()
    if height is None:
        raise InputError("{method} hyperbolic without a first cell", "give {first_cell} or {y_plus} as well")
    settings = VolumeMarch(
        first_cell=height, layers=request.layers, far_field=request.sampling.far_field,
        symmetry=request.symmetry, growth=request.growth,
    )  # fmt: skip
    solution = march_surface(surface_of(shape.grid, poles=request.poles), settings)
    return _noted(solution, *request.height_notes("on a length of 1"))


def _fill(shape: SpatialShape, request: Volume) -> Solution:
    from meshonet.geometry.blocks.six_patches import six_faces

    faces = six_faces(shape.grid)
    counts = _counts(request.sampling)
    if counts is not None:
        faces = faces.resampled(counts)
    settings = {each: value for each, value in request.settings.items() if each in request.chosen}
    if "model" in settings:
        from meshonet.solvers.neural.volumes.network import infer_volume

        refuse(request.chosen, "a network in space")
        return _noted(infer_volume(faces, **settings), *faces.notes)
    name = "variational" if request.method in _OPEN else request.method
    refuse(request.chosen, f"{name} in space")
    if request.coarse != "auto":
        settings["coarse"] = request.coarse
    if request.energy is not None:
        settings["energy"] = request.energy
    fill = getattr(import_module(f"meshonet.solvers.volumes.{name}"), name)
    return _noted(fill(faces, **settings), *faces.notes)


def _counts(sampling: Sampling) -> tuple[int, int, int] | None:
    ni, nj, nk = sampling.ni, sampling.nj, sampling.nk
    if ni is None or nj is None:
        return None
    if nk is None and ni != nj:
        problem = f"{ni} x {nj} nodes for three directions"
        raise InputError(problem, "give NIxNJxNK, or N", parameter="res")
    return ni, nj, ni if nk is None else nk


def _smooth(shape: SpatialShape, request: Volume) -> Solution:
    from meshonet.solvers.smoothing.volumes import smooth_volumes

    iterations = request.settings.get("max_cycles")
    more = {} if iterations is None else {"iterations": iterations}
    return smooth_volumes(shape.grid, slide=bool(request.slide), **more)


def _noted(solution: Solution, *notes: str) -> Solution:
    return replace(solution, notes=(*(note for note in notes if note), *solution.notes))


_MARCH = _VolumeMethod(OFF_SURFACE, ("hyperbolic",), _march)
_FILL = _VolumeMethod(INSIDE, ("variational", "winslow", "tfi"), _fill)
_SMOOTH = _VolumeMethod(JOINED, ("variational",), _smooth)
