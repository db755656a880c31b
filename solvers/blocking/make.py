"""Makes a multi-block grid of a domain."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.domain.check import check_domain
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.kinks import with_kinks
from meshonet.geometry.domain.periodic import with_periodic_sides
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.lattice import around_body
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.reach import MOST_CELLS
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.geometry.spacing.first_cell import AtWalls, check_names
from meshonet.solvers.blocking.block_grid import cut_off, fine_layout
from meshonet.solvers.blocking.decomposition.decompose import decompose
from meshonet.solvers.blocking.decomposition.reuse import carried_over
from meshonet.solvers.blocking.request import BlockRequest
from meshonet.solvers.blocking.wall_note import sharp_edge_notes, wall_note, without_layers
from meshonet.solvers.solution import Solution
from meshonet.solvers.stages import Timings

if TYPE_CHECKING:
    from meshonet.solvers.layers.layer_settings import LayerSettings

METHOD = "blocks"
GROWTH = 1.2  # default ratio of neighbouring layers
MORE = 1.2  # ratio of the number of cells to the requested one above which a note says so
CUT_OFF = 1e-3  # fraction of the area that cells may cut off along walls without a note
HOLE_CUT_OFF = 0.02  # fraction of a hole's area by which that of its cells may differ without a note


def make_blocks(shape: DomainShape, request: BlockRequest) -> Solution:
    """Return the multi-block grid of a domain, with layers if a first cell is given.

    Raises InputError if loops cross or touch, a wall has an unknown name, or the layout is of another domain.
    Raises SolverError if the decomposition fails. Raises NoValidGridError if cells are folded.
    """

    def fine(domain: Domain, timings: Timings) -> Layout:
        layout, height = _given(shape, domain, request), request.heights(shape.unit)
        if height is not None:
            return _with_layers(domain, request, height, layout, timings)
        cells, size = _wanted(domain, request)
        layout = layout or decompose(domain, timings=timings)
        return fine_layout(layout, cells=cells, cell_size=size, halved=request.refine, timings=timings)

    return grid_of(shape, request, fine)


def grid_of(
    shape: DomainShape, request: BlockRequest, fine_of: Callable[[Domain, Timings], Layout]
) -> Solution:
    """Return the grid of the blocks that `fine_of` makes of the domain. Raises errors as `make_blocks`."""
    begun = perf_counter()
    timings: Timings = {}
    domain, height = _checked(shape.domain, request), request.heights(shape.unit)
    fine = fine_of(domain, timings)
    grid = to_grid(around_body(fine), walls=request.layered).with_provenance(method=METHOD, cells=fine.cells)
    said = (
        *request.height_notes(f"on a length of {shape.unit:.6g}", shape.unit),
        _fewer_cells(request, len(domain.loops) - 1),
        _more_cells(fine.cells, request),
        *_at_walls(grid, domain, request.walls, height),
        *(sharp_edge_notes(fine) if height is not None else ()),
        _cut_off(fine) or _cut_off_of_holes(fine),
        *_folded_coarser(grid, request.refine),
    )
    notes = (*domain.notes, *(note for note in said if note))
    growth = math.inf if height is None else request.growth or GROWTH
    layout = sum(part for name, part in timings.items() if name not in ("refine", "optimum", "layers"))
    seconds = {"layout": layout, "grid": max(perf_counter() - begun - layout, 0.0)}
    return Solution(grid, METHOD, seconds=seconds, notes=notes, growth=growth)


def _at_walls(grid: Grid, domain: Domain, walls: tuple[str, ...], height: AtWalls | None) -> list[str]:
    """Return notes on the first cells at walls, one for each height that is prescribed."""
    from meshonet.solvers.blocking.layers.stretches import continued_notes

    if isinstance(height, Mapping):
        at_walls = [wall_note(grid, domain, (name,), each) for name, each in height.items()]
        return [*at_walls, *continued_notes(domain, tuple(height))]
    if height is None:
        return []
    others = [] if walls else without_layers(domain)
    return [wall_note(grid, domain, walls, height), *others, *continued_notes(domain, walls)]


def _cut_off(fine: Layout) -> str:
    """Return a note if cells along walls cut off, or add, more than `CUT_OFF` of the area."""
    off = abs(cut_off(fine))
    if off <= CUT_OFF or abs(cut_off(fine, sum(fine.mesh.domain.curved_areas))) <= CUT_OFF:
        return ""
    return (
        f"cells along curved walls differ from the domain by {100 * off:.2g} % of its area: more cells help"
    )


def _cut_off_of_holes(fine: Layout) -> str:
    """Return a note on the hole whose area differs most between cells, if by more than `HOLE_CUT_OFF`."""
    mesh, changes = fine.mesh, dict[str, float]()
    for number, (loop, area) in enumerate(zip(mesh.domain.loops, mesh.domain.curved_areas, strict=True)):
        wall = np.flatnonzero(mesh.places.loop == number)
        change = abs(
            polygon_area(mesh.nodes[wall[np.argsort(mesh.places.arc[wall], kind="stable")]]) / area - 1.0
        )
        if number and change > HOLE_CUT_OFF:
            changes[loop.names[0]] = change
    if not changes:
        return ""
    worst = max(changes, key=lambda name: changes[name])
    return f"cells along {worst} change its area by {100 * changes[worst]:.2g} %: more cells help"


def find_layout(shape: DomainShape, request: BlockRequest) -> Layout:
    """Return the blocks of a domain; if no number of cells is requested, `decompose` determines it.

    Raises InputError as `make_blocks`; SolverError if the decomposition fails.
    """
    domain = _checked(shape.domain, request)
    if request.pitch is not None:
        raise InputError("the blocks of a cascade are always the same", "make the grid", parameter="pitch")
    layout = _given(shape, domain, request)
    height = request.heights(shape.unit)
    if height is not None:
        return _outside_layers(domain, request, height, layout)
    layout = layout or decompose(domain)
    if not (request.cells or request.cell_size or request.res or request.refine or request.count):
        return layout
    if domain.periodic:
        problem = "a count or size of cells for the layout of a domain with periodic sides"
        raise InputError(problem, "drop it: nodes are matched when the grid is made")
    cells, size = _wanted(domain, request)
    return fine_layout(layout, cells=cells, cell_size=size, halved=request.refine)


def _given(shape: DomainShape, domain: Domain, request: BlockRequest) -> Layout | None:
    """Return the layout of the request, or that of the input; a layout for layers is checked later.

    Raises InputError: a layout with room for layers in a request without; another kind of domain.
    """
    if shape.layout is not None and shape.layout.fronts:
        problem = "is a layout of what layers leave of a domain"
        raise InputError(problem, "give the domain, and this with {layout}")
    if request.layout is None or request.at_walls:
        return request.layout or shape.layout
    if request.layout.fronts:
        problem = "the layout leaves room for layers"
        raise InputError(problem, "give {first_cell} or {y_plus}", parameter="layout")
    return carried_over(request.layout, domain)


def _with_layers(
    domain: Domain, request: BlockRequest, height: AtWalls, layout: Layout | None, timings: Timings
) -> Layout:
    """Return a fine layout with layers at the named walls, or around all holes."""
    from meshonet.solvers.blocking.layers.layered import layered
    from meshonet.solvers.blocking.layers.stretches import layered_walls

    numbers, stretches = layered_walls(domain, request.layered)
    cells, size = _wanted(domain, request)
    return layered(
        domain, numbers, settings_of(request, height), stretches=stretches,
        cells=(cells or 0) * request.multiple**2, cell_size=(size or 0.0) / request.multiple, layout=layout,
        timings=timings,
    )  # fmt: skip


def settings_of(request: BlockRequest, height: AtWalls) -> LayerSettings:
    """Return the settings of the layers; `height` is the first-cell height, or one height for each wall."""
    from meshonet.solvers.layers.layer_settings import LayerSettings

    heights = height if isinstance(height, Mapping) else {}
    first = min(heights.values()) if isinstance(height, Mapping) else height
    constant = request.constant_layers or 1
    return LayerSettings.limited(
        first, request.growth or GROWTH, constant=constant, multiple=request.multiple, heights=heights
    )


def _outside_layers(domain: Domain, request: BlockRequest, height: AtWalls, layout: Layout | None) -> Layout:
    from meshonet.solvers.blocking.layers.outside import found_outside, taken_outside
    from meshonet.solvers.blocking.layers.stretches import layered_walls
    from meshonet.solvers.blocking.layers.wall_layers import WallLayers

    for name in ("cells", "cell_size", "res", "refine", "count"):
        if getattr(request, name):
            problem = f"{{{name}}} for the blocks outside of layers, which have no cells yet"
            raise InputError(problem, f"give {{{name}}} when the grid is made, beside {{layout}}")
    loops, stretches = layered_walls(domain, request.layered)
    walls = WallLayers.of(domain, loops, settings_of(request, height), stretches)
    if layout is None:
        return found_outside(walls.rest, walls.rings)
    return taken_outside(layout, walls.rest, walls.rings)


def _checked(domain: Domain, request: BlockRequest) -> Domain:
    check_domain(domain)
    known = list(dict.fromkeys(name for loop in domain.loops for name in loop.names))
    for name in request.count:
        if name not in known:
            raise InputError(f"there is no side {name!r}", "use " + ", ".join(known), parameter="count")
    domain = replace(with_kinks(domain) if request.at_walls else domain, counts=request.count)
    option = "walls" if request.walls else "first_cell" if request.y_plus is None else "y_plus"
    check_names(request.layered, known, option)
    heights = request.heights()
    if isinstance(heights, Mapping):
        domain = replace(domain, heights=heights)
    return with_periodic_sides(domain, request.periodic)


def _wanted(domain: Domain, request: BlockRequest) -> tuple[int | None, float | None]:
    """Return the requested number of cells, or else their edge length. Raises InputError: too many cells."""
    cells = request.cells or request.default_cells(len(domain.loops) - 1)
    size = domain.extent / request.res if request.res is not None else request.cell_size
    if size is not None:
        size = min(size, domain.extent)
        least = math.sqrt(domain.area / MOST_CELLS)
        if size < least:
            problem = f"edges of {size:.6g} are more than {MOST_CELLS} cells"
            remedy = f"use {least:.2g} or more"
            if request.res is not None:
                remedy = f"use at most {math.floor(domain.extent / least)}"
            raise InputError(problem, remedy, parameter="cell_size" if request.res is None else "res")
        cells = math.ceil(domain.area / size**2)
    if cells * 4**request.refine > MOST_CELLS:
        made = f"{cells} cells halved {request.refine} times are {cells * 4**request.refine:.3g}"
        raise InputError(made, f"use fewer: {MOST_CELLS} are the most", parameter="refine")
    return (cells, None) if size is None else (None, size)


def _fewer_cells(request: BlockRequest, bodies: int) -> str:
    """Return a note if refinement leaves room for fewer cells than are the default."""
    cells, usual = request.default_cells(bodies), request.usual_cells(bodies)
    if cells == usual or request.cells or request.cell_size or request.res or request.pitch:
        return ""
    return f"{cells} cells before {{refine}} instead of {usual}: {MOST_CELLS} are the most after it"


def _more_cells(made: int, request: BlockRequest) -> str:
    """Return a note if layers need many more cells than requested."""
    wanted = (request.cells or 0) * 4**request.refine
    if not wanted or not request.at_walls or made <= MORE * wanted:
        return ""
    return f"{made} cells instead of {wanted}: a higher {{first_cell}} or {{growth}} needs fewer rows of them"


def _folded_coarser(grid: Grid, halvings: int) -> list[str]:
    """Return a note for each coarser nested grid with folded cells."""
    notes = []
    for times in (2**k for k in range(1, halvings + 1)):
        folded = sum(count_folded(block.nodes[::times, ::times]) for block in grid.blocks)
        if folded:
            notes.append(f"every {times}th node makes a grid of which {folded} cells are folded")
    return notes
