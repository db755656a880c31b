"""From a domain to a grid of blocks, as it was asked for."""

from __future__ import annotations

from time import perf_counter

from meshonet.geometry.domain.check import check_domain

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.solvers.blocking.block_grid import BlockFacts, block_grid, fine_layout
from meshonet.solvers.blocking.decompose import decompose
from meshonet.solvers.blocking.request import CELLS, BlockRequest
from meshonet.solvers.blocking.reuse import carried_over
from meshonet.solvers.solution import Solution

METHOD = "blocks"


def make_blocks(shape: DomainShape, request: BlockRequest) -> Solution:
    """Return the grid of blocks of a domain.

    Raises InputError: loops that cross or touch, names of walls that it does not have, a layout of another
    domain; SolverError: no blocks are found; NoValidGridError: cells are folded.
    """
    begun = perf_counter()
    domain = _checked(shape.domain, request)
    layout = _given(shape, domain, request)
    cells, size = _wanted(domain, request)
    grid, _, facts = block_grid(domain, cells=cells, cell_size=size, layout=layout)
    note = request.note(shape.unit)
    notes = (*domain.notes, *([note] if note else []))
    grid = grid.with_provenance(method=METHOD, cells=facts.cells, irregular=facts.irregular)
    return Solution(grid, METHOD, seconds=_stages(facts, perf_counter() - begun), notes=notes)


def find_layout(shape: DomainShape, request: BlockRequest) -> Layout:
    """Return the blocks of a domain, with as many cells as are asked for, else those they were found with.

    Raises InputError: as `make_blocks`; SolverError: no blocks are found.
    """
    domain = _checked(shape.domain, request)
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
        return None, request.cell_size
    return request.cells or CELLS, None


def _stages(facts: BlockFacts, spent: float) -> dict[str, float]:
    """Return seconds for finding blocks, and for the grid."""
    stages = facts.timings.seconds
    found = sum(seconds for stage, seconds in stages.items() if stage not in ("refine", "optimum", "grid"))
    return {"layout": found, "grid": max(spent - found, 0.0)}
