"""The planar grid of a cross-section that is swept or stacked."""

from dataclasses import replace
from typing import Any

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import may_be_wall
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop, turns_sharply
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.circle import Circle
from meshonet.geometry.shapes.domain_shape import DomainShape, four_sided
from meshonet.geometry.shapes.outline import Outline, sides_departure
from meshonet.geometry.shapes.shape import Shape, edges_of
from meshonet.geometry.spacing.first_cell import FirstCell
from meshonet.solvers.layers.first_cells import Heights, cells_needed
from meshonet.solvers.pipeline.make_grid import make_grid
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.uses import GIVEN_SECTION, refuse
from meshonet.solvers.pipeline.wall_facts import growth_note, wall_facts
from meshonet.solvers.sweeping.butterfly import GROWTH
from meshonet.solvers.sweeping.disc import Disc, butterfly

_SIDES = 65, 33  # default number of nodes along the sides of a four-sided section


def section_grid(
    shape: Shape | Grid, request: GridRequest, around: int | None = None
) -> tuple[Grid, tuple[str, ...]]:
    """Return the planar grid inside a closed curve or domain, and notes; a given grid is returned unchanged.

    A circle gets five blocks, with `around` cells along the circle. A four-sided outline gets one block. A
    first-cell height applies at all sides, or at the sides that the request names. Raises InputError if
    parameters do not suit the shape; see also `make_grid`.
    """
    five_blocks = isinstance(shape, Circle) and not (
        request.cell_size or request.layout or request.walls or request.by_wall
    )
    if around is not None and not five_blocks:
        problem = "cells around are counted in circles of five blocks"
        raise InputError(problem, "give {cells} or {res} instead", parameter="around")
    if isinstance(shape, Grid):
        refuse(request.chosen, GIVEN_SECTION)
        return shape, ()
    request, notes = _with_height(shape, request)
    if isinstance(shape, Circle) and five_blocks:
        disc = _disc(shape, request, around)
        grid = butterfly(disc)
        facts: tuple[str, ...] = ()
        if disc.first_cell:
            facts = *wall_facts(grid), *growth_note(grid, request.growth or GROWTH)
        return grid, (*notes, *[disc.note] * bool(disc.note), *facts)
    inside = _inside(shape)
    if isinstance(inside, DomainShape) and inside.many:
        request = _walled(inside, request)
    elif request.at_walls and not (request.asks_for_blocks or request.names_walls):
        request = _four_walls(inside, request)
    elif isinstance(inside, Outline) and request.sampling.ni is None and not request.asks_for_blocks:
        request = replace(request, sampling=replace(request.sampling, ni=_SIDES[0], nj=_SIDES[1]))
    result = make_grid(inside, request)
    return result.grid, (*notes, *result.notes)


def extent(shape: Shape | Grid) -> float:
    """Return the longer side of the bounding box of a cross-section."""
    if isinstance(shape, Grid):
        points = np.concatenate([block.nodes.reshape(-1, 2) for block in shape.blocks])
    elif isinstance(shape, DomainShape):
        return shape.domain.extent
    elif isinstance(shape, Boundary):
        points = shape.outline()
    else:
        points = shape.curve.points  # type: ignore[attr-defined]
    return float(np.ptp(points, axis=0).max())


def _with_height(shape: Shape, request: GridRequest) -> tuple[GridRequest, tuple[str, ...]]:
    """Return the request with the first-cell height of its y+, based on the section's extent, and a note."""
    if request.y_plus is None:
        return request, ()
    unit = extent(shape)
    notes = request.height_notes(f"on a length of {unit:.6g}", unit)
    plain = FirstCell(first_cell=request.heights(unit))
    return replace(request, **vars(plain)), notes


def _disc(shape: Circle, request: GridRequest, around: int | None) -> Disc:
    if request.sampling.ni is not None:
        problem = "a circle is made of five blocks"
        raise InputError(problem, "give {around} or {cells} instead", parameter="res")
    return Disc(shape.radius, request.cells, request.height(), request.growth, around)


def _inside(shape: Shape) -> Shape:
    """Return the domain inside a closed curve, as one block if it has four sides."""
    if not isinstance(shape, Outline | Airfoil):
        return shape
    loop = _loop(shape.curve)
    domain = Domain((loop,), shape.name, shape.notes)
    if isinstance(shape, Airfoil):
        return DomainShape(domain)
    if shape.topology == "quad" and four_sided(domain):
        return shape
    return DomainShape(domain).noted(*sides_departure(loop.curve))


def _four_walls(inside: Shape, request: GridRequest) -> GridRequest:
    """Return the request with layers at the sides that may be walls by their names."""
    h, sampling, growth = request.height() or 0.0, request.sampling, request.growth
    if sampling.ni is None and isinstance(inside, Outline):
        growth = growth or GROWTH
        edges = edges_of(inside, sampling)
        across = max(Curve(side).length for side in (edges.south, edges.north))
        needed = cells_needed(1.001 * across, h, h, Heights(growth=growth)) + 1
        sampling = replace(sampling, ni=max(_SIDES[0], needed))
    patches = edges_of(inside, sampling).patches
    walls: dict[str, Any] = {f"spacing_{patch.side}": h for patch in patches if patch.may_be_wall}
    return replace(request, first_cell=None, slide=False, growth=growth, sampling=sampling, **walls)


def _loop(curve: Curve) -> Loop:
    if polygon_area(curve.points) < 0:
        curve = curve.reversed()
    turn = turning(curve.points, closed=True)[curve.corner_index]
    return Loop(curve, tuple(int(k) for k in curve.corner_index[turns_sharply(turn)]), ("wall",))


def _walled(shape: DomainShape, request: GridRequest) -> GridRequest:
    """Return the request with layers along loops that may be walls by name, unless it names walls."""
    loops = shape.domain.loops
    if not request.at_walls or request.walls or request.by_wall or (loops[0].corner_cells < 2).any():
        return request
    names = filter(may_be_wall, (name for loop in loops for name in loop.names))
    return replace(request, walls=tuple(dict.fromkeys(names)))
