"""From shapes to valid grids: sample, solve, check, measure; several at a time if that is faster."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from typing import TYPE_CHECKING, TypeVar

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.notes import ExactHeights
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.shape import Shape, SpatialShape
from meshonet.geometry.threads import limited_to
from meshonet.solvers.pipeline.choose_method import method_of
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.result import Result, judged
from meshonet.solvers.pipeline.sample_shape import sampled
from meshonet.solvers.solution import Solution
from meshonet.solvers.stages import reached, stage

if TYPE_CHECKING:
    from meshonet.geometry.shapes.airfoil.base_wake import BaseWake
    from meshonet.geometry.shapes.domain_shape import DomainShape
    from meshonet.solvers.pipeline.methods import Method
    from meshonet.solvers.progress import HistoryRow

K = TypeVar("K")
MOST_TOGETHER = 64  # shapes that are solved together at the most
MOST_NODES = 1 << 22  # nodes of grids from which no more are solved together: some hundred MB
_OTHER_METHODS = "try {method} variational, or {allow_invalid}"  # where cells of a volume fold
_OTHER_NODES = "try another {res}, or {allow_invalid}"  # where they do by that method
_NOT_REPAIRED = "use {repair}, an elliptic method or {allow_invalid}"  # where cells of one block do


def make_grid(shape: Shape, request: GridRequest) -> Result:
    """Return the grid of a shape, with its quality and the times of the computation.

    Parameters
    ----------
    shape : shape
        Shape to sample, such as an airfoil or a `Boundary`.
    request : GridRequest
        The options of the grid, made by `grid_request`.

    Returns
    -------
    Result
        The grid, its quality and the times of the stages.

    Raises
    ------
    InputError
        The request does not suit the shape.
    NoValidGridError
        The grid has folded cells, and `allow_invalid` is not given.
    SolverError
        The method diverged.

    Examples
    --------
    >>> from meshonet.geometry.shapes.airfoil.naca import naca
    >>> from meshonet.solvers.pipeline.parameters import grid_request
    >>> result = make_grid(naca("2412"), grid_request(res=(41, 17)))
    >>> result.grid.nodes.shape, result.solution.method
    ((41, 17, 2), 'conformal')
    """
    result = next(make_grids([shape], request))
    if isinstance(result, Exception):
        raise result
    return result


def make_grids(shapes: Iterable[Shape], request: GridRequest) -> Iterator[Result | Exception]:
    """Yield the grid of each shape, or the error that occurred, in the order of the shapes.

    Some methods solve several shapes together. They then read a limited number of shapes ahead, and their
    grids differ from the grids of separate calls in the last digits.

    Parameters
    ----------
    shapes : iterable of shape
        Shapes to sample; they are read while results are requested.
    request : GridRequest
        The options of all grids, made by `grid_request`.

    Yields
    ------
    Result or Exception
        The grid of a shape, or the error that ended its computation.

    Raises
    ------
    InputError
        The request has settings that the method does not have.

    Examples
    --------
    >>> from meshonet.geometry.shapes.airfoil.naca import naca
    >>> from meshonet.solvers.pipeline.parameters import grid_request
    >>> results = make_grids(map(naca, ("0012", "2412")), grid_request("tfi", res=(41, 17)))
    >>> [result.grid.name for result in results]
    ['NACA 0012', 'NACA 2412']
    """
    return (result for _, result in make_grids_of(shapes, request, lambda shape: shape))


def make_grids_of(
    keys: Iterable[K], request: GridRequest, shape_of: Callable[[K], Shape]
) -> Iterator[tuple[K, Result | Exception]]:
    """Yield each of the `keys` with the grid of its shape, or with the error that occurred.

    `shape_of` returns the shape of a key. Raises InputError if the request has settings that the method does
    not have. See also `make_grids`.
    """
    method = method_of(request)
    keys = iter(keys)
    while group := _group(keys, request, MOST_TOGETHER if method.together else 1, shape_of):
        if len(group) > 1:
            with limited_to(request.threads):
                _solve_together([member for _, member in group], method)
        while group:
            key, member = group.popleft()
            result: Result | Exception
            try:
                with limited_to(request.threads):
                    result = _finished(member, method, request)
            except Exception as error:
                result = error
            yield key, result


@dataclass
class _Member:
    """A shape in progress: its boundary or an error, and its solution if it was solved in a group."""

    boundary: Boundary | BaseWake | DomainShape | SpatialShape | Exception
    seconds: dict[str, float]
    solution: Solution | None = None


def _group(
    keys: Iterator[K], request: GridRequest, most: int, shape_of: Callable[[K], Shape]
) -> deque[tuple[K, _Member]]:
    group: deque[tuple[K, _Member]] = deque()
    nodes = 0
    for key in islice(keys, most):
        seconds: dict[str, float] = {}
        boundary: Boundary | BaseWake | DomainShape | SpatialShape | Exception
        try:
            with stage("boundary", seconds):
                boundary = sampled(shape_of(key), request)
        except Exception as error:
            boundary = error
        group.append((key, _Member(boundary, seconds)))
        nodes += boundary.ni * boundary.nj if isinstance(boundary, Boundary) else 0
        if nodes >= MOST_NODES:
            break
    return group


def _solve_together(group: Iterable[_Member], method: Method) -> None:
    """Solve the members that the method solves in one call; after an error they follow one by one."""
    alike = [
        (member, member.boundary)
        for member in group
        if isinstance(member.boundary, Boundary) and member.boundary.topology == method.together
    ]
    if len(alike) < 2:
        return
    begun = time.perf_counter()
    try:
        solutions = method.solve([boundary for _, boundary in alike])
    except (MeshonetError, MemoryError):
        return
    except Exception as error:
        for member, _ in alike:
            member.boundary = error
        return
    share = (time.perf_counter() - begun) / len(alike)
    for (member, _), solution in zip(alike, solutions, strict=True):
        member.solution = solution
        _add_times(member.seconds, solution, share)


def _finished(member: _Member, method: Method, request: GridRequest) -> Result:
    boundary, solution, seconds = member.boundary, member.solution, member.seconds
    if isinstance(boundary, Exception):
        raise boundary
    if isinstance(boundary, SpatialShape):
        return _of_volume(boundary, request, seconds)
    if not isinstance(boundary, Boundary):
        return _of_many(boundary, request, seconds)
    rows: tuple[HistoryRow, ...] = ()
    if solution is None:
        reached("grid")
        begun = time.perf_counter()
        start = None if request.initial is None else [request.initial]
        if request.history:
            solution, rows = _with_history(lambda: method.solve([boundary], start)[0])
        else:
            solution = method.solve([boundary], start)[0]
        _add_times(seconds, solution, time.perf_counter() - begun)
    elif request.history:
        made = solution
        _, rows = _with_history(lambda: made)
    notes = (*boundary.notes, *solution.notes)
    with stage("guard", seconds):
        if count_folded(solution.grid.nodes) and request.repairs():
            solution, more = _repaired(solution, boundary, request)
            kept = (note for note in notes if not (more and isinstance(note, ExactHeights)))
            notes = (*kept, *more)
    grid = replace(solution.grid, origin=boundary.origin)
    solution = replace(solution, grid=grid, notes=notes, growth=request.growth or math.inf)
    return judged(solution, seconds, request, remedy=_NOT_REPAIRED, history=rows)


def _with_history(solve: Callable[[], Solution]) -> tuple[Solution, tuple[HistoryRow, ...]]:
    from meshonet.solvers.progress import History, listening

    history = History()
    with listening(history):
        solution = solve()
    return solution, history.of(solution)


def _of_many(shape: BaseWake | DomainShape, request: GridRequest, seconds: dict[str, float]) -> Result:
    from meshonet.geometry.shapes.airfoil.base_wake import BaseWake

    if isinstance(shape, BaseWake):
        return _of_base(shape, request, seconds)
    return _of_blocks(shape, request, seconds)


def _of_blocks(shape: DomainShape, request: GridRequest, seconds: dict[str, float]) -> Result:
    from meshonet.solvers.pipeline.blocks import block_request, smoothed, smooths

    reached("grid")
    begun = time.perf_counter()
    if shape.grid is not None and smooths(shape, request):
        solution = smoothed(shape.grid, request)
        seconds |= {"load": time.perf_counter() - begun - solution.seconds["grid"], **solution.seconds}
        solution = replace(solution, notes=(*shape.notes, *solution.notes))
        return judged(solution, seconds, request, remedy="find other blocks with {cells}, or {allow_invalid}")
    if request.pitch is None:
        from meshonet.solvers.blocking.make import make_blocks as make
    else:
        from meshonet.solvers.cascade.make import make_passage as make

    loaded = time.perf_counter()
    solution = make(shape, block_request(request))
    seconds |= {"load": loaded - begun, **solution.seconds}
    return judged(solution, seconds, request, remedy="use more {cells}")


def _of_base(lines: BaseWake, request: GridRequest, seconds: dict[str, float]) -> Result:
    from meshonet.solvers.hyperbolic.around_base import around_base

    reached("grid")
    begun = time.perf_counter()
    solution = around_base(lines, first=lines.first, **request.rows_at_walls)
    _add_times(seconds, solution, time.perf_counter() - begun)
    of_heights = request.height_notes(f"and x/c {request.chord_fraction:g}", in_unit=" chords")
    solution = replace(solution, notes=(*of_heights, *solution.notes), growth=request.growth or math.inf)
    return judged(solution, seconds, request, remedy="use another {res}, or {te} wedge")


def _of_volume(shape: SpatialShape, request: GridRequest, seconds: dict[str, float]) -> Result:
    from meshonet.solvers.pipeline.volumes import make_volume

    reached("grid")
    begun = time.perf_counter()
    solution = make_volume(shape, request)
    _add_times(seconds, solution, time.perf_counter() - begun)
    remedy = _OTHER_NODES if solution.method == "variational" else _OTHER_METHODS
    return judged(solution, seconds, request, remedy=remedy)


def _add_times(seconds: dict[str, float], solution: Solution, spent: float) -> None:
    """Add the times of a solution; of the `spent` seconds, those beyond its own are the time of loading."""
    rest = "load" if "grid" in solution.seconds else "grid"
    for name in ("grid", "guard"):
        if name in solution.seconds:
            seconds[name] = solution.seconds[name]
            spent -= seconds[name]
    seconds[rest] = max(spent, 0.0)


def _repaired(
    solution: Solution, boundary: Boundary, request: GridRequest
) -> tuple[Solution, tuple[str, ...]]:
    from meshonet.solvers.layers.redistribute import worst_first_cell
    from meshonet.solvers.pipeline.fallback import guard

    valid = guard(solution, boundary, allow_invalid=request.allow_invalid, margin=request.repair_margin)
    if valid.path == solution.path or not solution.first_cells or worst_first_cell(valid) < 1e-8:
        return valid, ()
    off = f"their heights are off by up to {worst_first_cell(valid):.1g} of what was asked"
    return valid, (f"the guard changed first cells: {off}",)
