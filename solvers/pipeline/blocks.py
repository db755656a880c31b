"""Decides which shapes become multi-block grids, and which options apply to multi-block grids."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from time import perf_counter
from typing import TYPE_CHECKING

from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.assembly import assembled, domain_of
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.blocking.request import BlockRequest
from meshonet.solvers.pipeline.first_cells import has_walls_on_sides
from meshonet.solvers.pipeline.methods import METHODS as TABLE
from meshonet.solvers.pipeline.uses import MANY, SMOOTHED, refuse
from meshonet.solvers.solution import Solution
from meshonet.solvers.stages import stage

if TYPE_CHECKING:
    from meshonet.geometry.blocks.grid import Grid
    from meshonet.geometry.layout.layout import Layout
    from meshonet.solvers.pipeline.request import GridRequest

SMOOTHERS = ("auto", "variational")  # methods that smooth the blocks of a given grid
METHODS = ("best", *SMOOTHERS)
"""Method names for which multi-block grids are made; their nodes minimise the variational functional."""


def as_blocks(shape: Shape, request: GridRequest) -> DomainShape | None:
    """Return the domain that `request` divides into blocks, or None if it makes a single-block grid.

    Raises InputError if the shape to divide is no domain, or if options do not apply to multi-block grids.
    """
    asks = request.asks_for_blocks or (() if has_walls_on_sides(shape, request) else request.names_walls)
    if _check_single(request, asks) or not (asks or getattr(shape, "many", False)):
        return None
    if not asks and request.method not in METHODS and getattr(shape, "one", None):
        return None  # a method of single blocks, as by the name
    domain = _domain(shape, request)
    _check_use(request, SMOOTHED if smooths(domain, request) else MANY)
    return domain


def smooths(shape: DomainShape, request: GridRequest) -> bool:
    """Return whether the request smooths the input grid, `shape.grid`, instead of making new blocks."""
    new_blocks = request.asks_for_blocks or request.sampling.ni or request.at_walls
    return shape.grid is not None and request.method in SMOOTHERS and not new_blocks


def smoothed(grid: Grid, request: GridRequest) -> Solution:
    """Smooth a multi-block grid, then refine and smooth it `request.refine` times; return the result.

    Raises InputError as `smooth`, or if a grid to refine has a connection that covers only a part of a side.
    """
    from meshonet.solvers.refinement.refine import refined
    from meshonet.solvers.smoothing.smooth import ITERATIONS, smooth

    begun = perf_counter()
    iterations = request.settings.get("max_cycles", ITERATIONS)
    solution = smooth(grid, slide=bool(request.slide), iterations=iterations)
    for _ in range(request.refine):
        solution = smooth(refined(solution.grid, 2), slide=bool(request.slide), iterations=iterations)
    seconds = {"grid": perf_counter() - begun}
    return replace(solution, seconds=seconds)


def check_asked(request: GridRequest) -> None:
    """Raise InputError if options of multi-block grids are invalid, or conflict with other options."""
    if not request.asks_for_blocks:  # names of walls alone, maybe of a single block of any counts
        _block_request(request, None)
        return
    block_request(request)
    _check_single(request, request.asks_for_blocks)


def make_layout(shape: Shape, request: GridRequest) -> tuple[Layout, Mapping[str, float]]:
    """Divide a shape into blocks; return their layout, and the seconds of each stage.

    Raises InputError as `as_blocks`. Raises SolverError if the domain cannot be divided.
    """
    seconds: dict[str, float] = {}
    with stage("load", seconds):
        from meshonet.solvers.blocking.make import find_layout
    with stage("layout", seconds):
        _check_use(request)
        layout = find_layout(_domain(shape, request), block_request(request))
    return layout, seconds


def block_request(request: GridRequest) -> BlockRequest:
    """Return the options of `request` for multi-block grids. Raises InputError: as `BlockRequest`."""
    sampling = request.sampling
    if sampling.nj not in (None, sampling.ni):
        problem = f"{sampling.ni} x {sampling.nj} nodes for many blocks"
        remedy = "give one number: cells along the longest extent"
        raise InputError(problem, remedy, parameter="res")
    return _block_request(request, sampling.ni)


def _block_request(request: GridRequest, res: int | None) -> BlockRequest:
    own = [each.name for each in fields(BlockRequest) if each.name != "res"]
    return BlockRequest(res=res, **{name: getattr(request, name) for name in own})


def _domain(shape: Shape, request: GridRequest) -> DomainShape:
    if request.pitch is not None:
        return _blade(shape, request.sampling)
    domain = domain_of(shape, request.sampling)
    if request.sampling.far_field is not None and not domain.far_field:
        raise InputError("a domain with a boundary of its own has no far field", "leave {far_field} out")
    return domain


def _blade(shape: Shape, sampling: Sampling) -> DomainShape:
    if sampling.far_field is not None:
        raise InputError("the passage of a cascade has no far field", "leave {far_field} out")
    around = assembled([shape], ["blade"], sampling, shape.name)
    if len(around.domain.loops) != 2 or not around.far_field:
        raise InputError("a cascade is made of one blade", "give one closed curve", parameter="pitch")
    return around


def _check_single(request: GridRequest, asks: tuple[str, ...]) -> bool:
    """Return whether an option asks for a single block. Raises InputError if others `asks` for many."""
    sampling = request.sampling
    uses = {
        "blocks": request.blocks == "single",
        "topology": sampling.topology != "auto",
        "corners": sampling.corners is not None,
    }
    single = [name for name, used in uses.items() if used]
    if single and asks:
        problem = f"{{{asks[0]}}} asks for many blocks and {{{single[0]}}} for one"
        raise InputError(problem, "give one of them")
    return bool(single)


def _check_use(request: GridRequest, way: str = MANY) -> None:
    """Raise InputError for the first option that does not apply to multi-block grids or their smoothing."""
    if request.method not in METHODS:
        of_one = TABLE.get(request.method)
        remedy = "drop {method}, or ask for {blocks} single"
        if of_one is not None and of_one.algebraic:  # whose command makes no blocks
            remedy = "let infer or solve-pde make the grid"
        raise InputError(f"method {request.method} makes single blocks", remedy)
    refuse(request.chosen, way)
