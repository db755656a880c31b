"""First-cell heights of a request: at a body, or at the walls of a four-sided domain."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from meshonet.geometry.arrays import SIDES, Side
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.first_cell import check_names
from meshonet.solvers.layers.first_cells import Heights

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.request import GridRequest, OneBlock


def heights_of(request: OneBlock, boundary: Boundary) -> Heights:
    """Return the first-cell heights that a request prescribes, in the unit of `boundary`.

    Raises InputError if the request names no walls, and names such as ``inlet`` exclude all sides.
    """
    off: dict[str, Any] = {}
    if request.at_walls and boundary.around_body:
        off = {"south": (request.height() or 0.0) * boundary.chord}
    elif request.at_walls:
        heights = request.heights(boundary.chord)
        if isinstance(heights, Mapping):
            off = {side: heights[name] for name in heights for side in sides_called(boundary, name)}
        elif heights is not None:
            named = [side for name in request.walls for side in sides_called(boundary, name)]
            off = dict.fromkeys(named or wall_sides(boundary), heights)
    rows = request.rows_at_walls
    del rows["multiple"]
    return Heights(**off | request.sides, **rows)


def y_plus_notes(request: OneBlock, boundary: Boundary) -> tuple[str, ...]:
    """Return a note that explains how the heights follow from y+; () if the request has no y+."""
    if boundary.around_body:
        return request.height_notes(f"and x/c {request.chord_fraction:g}", in_unit=" chords")
    where = f"on a length of {boundary.chord:.6g}, the extent of south,"
    return request.height_notes(where, boundary.chord)


def sides_called(boundary: Boundary, name: str) -> list[Side]:
    """Return the sides of a four-sided boundary that have a patch called `name`."""
    return [side for side in SIDES if any(p.name == name for p in boundary.patches if p.side == side)]


def wall_sides(boundary: Boundary) -> list[Side]:
    """Return the sides of a four-sided boundary that get layers if the request names no walls.

    South and north get layers if any of their patches may be a wall, west and east if all their patches are
    walls. If no side meets its condition, all sides with a patch that may be a wall get layers. A patch with
    a name or kind such as ``inlet`` is no wall. Raises InputError if no side may be a wall.
    """
    patches = {side: [p for p in boundary.patches if p.side == side] for side in SIDES}
    possible = [side for side in SIDES if any(patch.may_be_wall for patch in patches[side])]
    walls: list[Side] = [
        side
        for side in possible
        if side in ("south", "north") or all(patch.kind == "wall" for patch in patches[side])
    ]
    if not possible:
        names = ", ".join(dict.fromkeys(patch.name for patch in boundary.patches))
        raise InputError(f"no side is a wall by its name: {names}", "name the walls with {walls}")
    return walls or possible


def along_walls(boundary: Boundary, request: OneBlock) -> bool:
    """Return whether south or north of a four-sided boundary gets layers, so that xi runs along a wall."""
    names = request.by_wall or request.walls
    sides = [side for name in names for side in sides_called(boundary, name)] or wall_sides(boundary)
    return not {"south", "north"}.isdisjoint(sides)


def has_walls_on_sides(shape: Shape, request: GridRequest) -> bool:
    """Return whether the walls that a request names are whole sides of a four-sided domain of one block.

    If the request leaves the number of blocks open, these walls must also be opposite each other, and the
    request must not refine. Raises InputError if no wall has a requested name, or if walls on the same side
    of one block have different first-cell heights.
    """
    heights = request.first_cell if request.y_plus is None else request.y_plus
    off = heights if isinstance(heights, Mapping) else dict.fromkeys(request.walls, 0.0)
    sides = names_of_sides(shape)
    one = request.blocks == "single" or request.sampling.nj not in (None, request.sampling.ni)
    if not sides or (request.refine and not one):
        return False
    known = dict.fromkeys(name for names in sides for name in names)
    check_names(off, known, request.names_walls[0])
    for names in sides:
        if off.keys().isdisjoint(names) or len(set(map(off.get, names))) == 1:
            continue
        if one:
            problem = f"{', '.join(names)} are one side of the block, whose first cells are equally high"
            raise InputError(problem, "give all the same", parameter=request.names_walls[0])
        return False
    with_layers = {k % 2 for k, names in enumerate(sides) if not off.keys().isdisjoint(names)}
    return one or len(with_layers) == 1


def names_of_sides(shape: Shape) -> list[list[str]]:
    """Return the names of boundary parts on each side of a four-sided shape; [] for shapes of other kinds."""
    if isinstance(shape, Boundary):
        return [] if shape.around_body else [[p.name for p in shape.patches if p.side == s] for s in SIDES]
    from meshonet.geometry.shapes.domain_shape import DomainShape, convex_corners, four_sided

    if not isinstance(shape, DomainShape) or shape.many or not four_sided(shape.domain):
        return []
    loop = shape.domain.loops[0]
    if len(loop.names) == 1:
        return []
    begins = [loop.corners.index(point) for point in convex_corners(loop)]
    ends = [*begins[1:], begins[0] + len(loop.corners)]
    names = [*loop.names, *loop.names]
    return [names[begin:end] for begin, end in zip(begins, ends, strict=True)]
