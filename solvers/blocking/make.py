"""From a domain to a grid of blocks, as it was asked for."""

from __future__ import annotations

import math
from time import perf_counter

import numpy as np

from meshonet.geometry.domain.check import check_domain
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.around_body import around_body
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.solvers.blocking.block_grid import fine_layout
from meshonet.solvers.blocking.decompose import Timings, decompose
from meshonet.solvers.blocking.request import CELLS, MOST_CELLS, BlockRequest
from meshonet.solvers.blocking.reuse import carried_over
from meshonet.solvers.solution import Solution

METHOD = "blocks"
GROWTH = 1.2
"""Ratio of neighbouring layers where nobody asked for one."""
CUT_OFF = 1e-3
"""Part of the area that cells along walls may cut off before it is said."""
LAYERED_CELLS = 20_000
"""Cells where nobody asked for a count and there are layers."""


def make_blocks(shape: DomainShape, request: BlockRequest) -> Solution:
    """Return the grid of blocks of a domain, with layers where a first cell is asked for.

    Raises InputError: loops that cross or touch, names of walls that it does not have, a layout of another
    domain; SolverError: no blocks are found; NoValidGridError: cells are folded.
    """
    begun, timings = perf_counter(), Timings()
    domain = _checked(shape.domain, request)
    layout = _given(shape, domain, request)
    cells, size = _wanted(domain, request)
    height = request.height(shape.unit)
    about: tuple[str, ...] = ()
    if request.pitch is not None:
        fine = _passage(domain, request, height, timings)
    elif height is None:
        layout = layout or decompose(domain, timings=timings)
        fine = fine_layout(layout, cells=cells, cell_size=size, timings=timings)
    else:
        fine, about = _with_layers(domain, request, height, layout, timings)
    grid = to_grid(around_body(fine)).with_provenance(method=METHOD, cells=fine.cells)
    said = (request.note(shape.unit), *about, _cut_off(fine))
    notes = (*domain.notes, *(note for note in said if note))
    return Solution(grid, METHOD, seconds=_stages(timings, perf_counter() - begun), notes=notes)


def _cut_off(fine: Layout) -> str:
    """Return a note where cells along walls cut off, or add, more than `CUT_OFF` of the area."""
    (x, y), area = fine.mesh.nodes[fine.mesh.quads].transpose(2, 0, 1), fine.mesh.domain.area
    covered = 0.5 * float((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum())
    off = abs(covered / area - 1.0)
    if off <= CUT_OFF:
        return ""
    return (
        f"cells along curved walls differ from the domain by {100 * off:.2g} % of its area: more cells help"
    )


def find_layout(shape: DomainShape, request: BlockRequest) -> Layout:
    """Return the blocks of a domain, with as many cells as are asked for, else those they were found with.

    Raises InputError: as `make_blocks`; SolverError: no blocks are found.
    """
    domain = _checked(shape.domain, request)
    if request.pitch is not None:
        raise InputError("the blocks of a cascade are always the same", "make the grid", parameter="pitch")
    layout = _given(shape, domain, request) or decompose(domain)
    if request.cells is None and request.cell_size is None and request.res is None:
        return layout
    cells, size = _wanted(domain, request)
    return fine_layout(layout, cells=cells, cell_size=size)


def _given(shape: DomainShape, domain: Domain, request: BlockRequest) -> Layout | None:
    """Return the layout that was asked for, or that the input has."""
    if request.layout is None:
        return shape.layout
    return carried_over(request.layout, domain)


def _with_layers(
    domain: Domain, request: BlockRequest, height: float, layout: Layout | None, timings: Timings
) -> tuple[Layout, tuple[str, ...]]:
    """Return a fine layout with layers at the walls that were named, or around all holes, and notes."""
    from meshonet.solvers.blocking.c_layered import bodies_with_layers
    from meshonet.solvers.blocking.layer_rows import LayerSettings
    from meshonet.solvers.blocking.layered import layered

    numbers = [
        k for k, loop in enumerate(domain.loops) if (request.walls and set(loop.names) & set(request.walls))
    ] or list(range(1, len(domain.loops)))
    if not numbers:
        remedy = "name the walls that layers are to be at with {walls}"
        raise InputError("a first cell in a domain without holes", remedy)
    for number in numbers if request.walls else ():
        others = sorted(set(domain.loops[number].names) - set(request.walls))
        if others:
            problem = f"layers at a part of a loop, which is {', '.join(others)} too"
            raise InputError(problem, "name all of its parts", parameter="walls")
    settings = LayerSettings(height, request.growth or GROWTH, request.constant_layers or 1)
    if request.cell_size is not None or request.res is not None:
        raise InputError("a size of cells beside layers", "give {cells}: sizes follow from the layers")
    cells = request.cells or LAYERED_CELLS
    if layout is not None:
        return layered(domain, numbers, settings, cells=cells, layout=layout, timings=timings), ()
    return bodies_with_layers(domain, numbers, settings, cells=cells, timings=timings)


def _passage(domain: Domain, request: BlockRequest, height: float | None, timings: Timings) -> Layout:
    """Return the passage of a cascade, whose blade is the only hole of a domain."""
    from meshonet.solvers.blocking.cascade import Cascade
    from meshonet.solvers.blocking.cascade_layout import cascade_layout
    from meshonet.solvers.blocking.layer_rows import LayerSettings

    if request.layout is not None:
        problem = "{layout} beside {pitch}"
        raise InputError(problem, "drop {layout}: the blocks of a cascade are always the same")
    settings, size = None, request.cell_size
    if height is not None:
        settings = LayerSettings(height, request.growth or GROWTH, request.constant_layers or 1)
        if size is not None or request.res is not None:
            raise InputError("a size of cells beside layers", "give {cells}: sizes follow from the layers")
    inlet, outlet = (1.0 if each is None else each for each in (request.inlet, request.outlet))
    assert request.pitch is not None  # noqa: S101 - the caller looked
    cascade = Cascade(domain.loops[1], request.pitch, inlet, outlet, settings, domain.name)
    if request.res is not None:
        size = cascade.extent / request.res
    cells = request.cells or (CELLS if height is None else LAYERED_CELLS)
    return cascade_layout(cascade, cells=cells, cell_size=size, timings=timings)


def _checked(domain: Domain, request: BlockRequest) -> Domain:
    check_domain(domain)
    known = list(dict.fromkeys(name for loop in domain.loops for name in loop.names))
    for name in request.walls:
        if name not in known:
            raise InputError(f"there is no wall {name!r}", "use " + ", ".join(known), parameter="walls")
    return domain


def _wanted(domain: Domain, request: BlockRequest) -> tuple[int | None, float | None]:
    """Return how many cells there are to be, or else how long their edges."""
    if request.res is not None:
        return None, domain.extent / request.res
    if request.cell_size is not None:
        least = math.sqrt(domain.area / MOST_CELLS)
        if request.cell_size < least:
            problem = f"edges of {request.cell_size:g} are more than {MOST_CELLS} cells"
            raise InputError(problem, f"use {least:.2g} or more", parameter="cell_size")
        return None, request.cell_size
    return request.cells or CELLS, None


def _stages(timings: Timings, spent: float) -> dict[str, float]:
    """Return seconds for finding blocks, and for the grid."""
    stages = timings.seconds
    found = sum(seconds for stage, seconds in stages.items() if stage not in ("refine", "optimum", "layers"))
    return {"layout": found, "grid": max(spent - found, 0.0)}
