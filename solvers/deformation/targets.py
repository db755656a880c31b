"""New positions of wall nodes from what a user gives: outlines, grids, rigid motions or nodes."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Bools, Floats, extent_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.self_intersection import find_crossings
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.shape import Shape
from meshonet.solvers.deformation.outer import NodeTable, Piece, lines_of
from meshonet.solvers.deformation.outline import on_line, on_outline

NewWall: TypeAlias = Shape | Grid | Motion | Floats | Sequence[Floats]
"""An outline, another grid whose boundary nodes are taken one by one, a rigid motion, or nodes.

Nodes are one array (n, 2) for each polyline of the wall, in either direction, or one array (m, n, 3) for each
patch in space. An array (n, 2) of another length is an outline.
"""

SAME = 1e-9  # largest difference of the positions that two pieces give a shared node, over the wall's extent


@dataclass(frozen=True, eq=False)
class NodeTargets:
    """New positions of the wall nodes of a grid."""

    moved: Bools  # (n,) mask of the nodes of moved walls
    nodes: Floats  # (n, d) all nodes, those of moved walls in their new positions
    names: tuple[str, ...]  # names of the moved walls
    notes: tuple[str, ...] = ()


def targets_of(table: NodeTable, walls: Mapping[str, NewWall] | NewWall) -> NodeTargets:
    """Return the new positions of the nodes of walls.

    `walls` maps names of walls to their new shapes. If a grid has one wall, its new shape is enough. A `Grid`
    or `Boundary` is also enough: its patches are the new shapes of the walls with the same names. Raises
    InputError if the grid has no wall of a given name, or if a new shape is unsuitable.
    """
    moved, nodes = np.zeros(len(table.nodes), dtype=bool), table.nodes.copy()
    notes: list[str] = []
    named = list(_named(table, walls))
    for name, new, pieces in named:
        for numbers, places in _placed(table, pieces, name, new, notes):
            at, to = numbers.ravel(), places.reshape(-1, nodes.shape[1])
            _check(name, table.nodes[at], nodes[at], to, moved[at])
            moved[at], nodes[at] = True, to
    for piece in table.pieces:
        own = piece.numbers
        if not piece.patch.name and (nodes[own] != table.nodes[own]).any():
            problem = "a wall is moved where it ends on a periodic side"
            raise InputError(problem, "keep its ends, or make the grid anew", parameter="wall")
    names = dict.fromkeys(piece.patch.name for _, _, pieces in named for piece in pieces)
    return NodeTargets(moved, nodes, tuple(names), tuple(dict.fromkeys(notes)))


def _named(
    table: NodeTable, walls: Mapping[str, NewWall] | NewWall
) -> Iterator[tuple[str, NewWall, list[Piece]]]:
    """Yield names, new shapes and pieces of the walls that are moved."""
    if isinstance(walls, Mapping):
        if not walls:
            raise InputError("no wall is named", "give the new shape of one", parameter="wall")
        for name, new in walls.items():
            yield name, new, _pieces(table, name)
        return
    own = list(dict.fromkeys(patch.name for patch in table.grid.walls()))
    whole = isinstance(walls, Boundary) and not walls.around_body
    if whole or (isinstance(walls, Grid) and walls.form != "surface"):
        patches = walls.outer_patches() if isinstance(walls, Grid) else walls.patches  # type: ignore[union-attr]
        theirs = {patch.name for patch in patches}
        for name in dict.fromkeys(piece.patch.name for piece in table.pieces):
            if name in theirs:
                yield name, walls, _pieces(table, name)
        return
    if len(own) == 1 or (own and isinstance(walls, Grid)):
        yield own[0], walls, [piece for piece in table.pieces if piece.patch.name in own]
        return
    count = f"the grid has {len(own)} walls: {', '.join(own)}" if own else "no part of the boundary is a wall"
    raise InputError(count, "name one: {wall} NAME=FILE", parameter="wall")


def _pieces(table: NodeTable, name: str) -> list[Piece]:
    pieces = [piece for piece in table.pieces if piece.patch.name == name]
    if not pieces:
        names = ", ".join(dict.fromkeys(piece.patch.name for piece in table.pieces if piece.patch.name))
        raise InputError(f"the grid has no {name!r}", f"name one of its boundary: {names}", parameter="wall")
    return pieces


def _placed(
    table: NodeTable, pieces: Sequence[Piece], name: str, new: NewWall, notes: list[str]
) -> Iterator[tuple[NDArray[np.intp], Floats]]:
    """Yield indices (...) and new positions (..., d) of the nodes of the pieces of a wall."""
    if isinstance(new, Motion):
        dimension = table.nodes.shape[1]
        if len(new.shift) not in (0, dimension) or len(new.turn) not in (0, dimension):
            where, remedy = "plane", "give 2 coordinates"
            if dimension == 3:
                where, remedy = "space", "translate it by 3 coordinates, or give a grid with its new nodes"
            problem = f"the motion of {name!r} is not in the {where} of the grid"
            raise InputError(problem, remedy, parameter="wall")
        for piece in pieces:
            yield piece.numbers, new(table.nodes[piece.numbers])
        return
    if isinstance(new, Grid) or table.nodes.shape[1] == 3:
        arrays = _of_grid(new, name) if isinstance(new, Grid) else _arrays(new, name)
        had, sizes = ([piece.numbers.shape for piece in pieces], [array.shape[:-1] for array in arrays])
        if had != sizes or arrays[0].shape[-1] != table.nodes.shape[1]:
            own, other = (", ".join(" x ".join(map(str, size)) for size in each) for each in (had, sizes))
            problem = f"{name!r} has patches of {own} nodes, and its new shape {other or 'none'}"
            raise InputError(problem, "give as many nodes, in order", parameter="wall")
        yield from ((piece.numbers, array) for piece, array in zip(pieces, arrays, strict=True))
        return
    lines = lines_of(pieces)
    shapes = _arrays(new, name) if isinstance(new, np.ndarray | Sequence) else [new] * len(lines)
    if len(lines) != len(shapes) or (len(lines) > 1 and not isinstance(new, np.ndarray | Sequence)):
        problem = f"{name!r} consists of {len(lines)} separate lines, and {len(shapes)} new ones are given"
        raise InputError(problem, "give the nodes of each", parameter="wall")
    for line, shape in zip(lines, shapes, strict=True):
        wall = table.nodes[line]
        places, more = _on(wall, shape, name)
        notes += more
        _check_outline(places, name)
        yield line, places


def _arrays(new: Any, name: str) -> list[Floats]:
    arrays = [new] if isinstance(new, np.ndarray) else list(new) if isinstance(new, Sequence) else []
    if not arrays or any(not isinstance(array, np.ndarray) for array in arrays):
        problem = f"{type(new).__name__} is no new shape of {name!r} in space"
        raise InputError(problem, "give a grid or surface with as many nodes", parameter="wall")
    arrays = [np.asarray(array, dtype=np.float64) for array in arrays]
    for array in arrays:
        if not np.isfinite(array).all():
            raise InputError(f"a new node of {name!r} is not finite", "give numbers", parameter="wall")
    return arrays


def _of_grid(new: Grid, name: str) -> list[Floats]:
    if new.form == "surface":
        return [block.nodes for block in new.blocks]
    theirs = NodeTable.of(new)
    return [theirs.nodes[each.numbers] for each in theirs.pieces if each.patch.name == name]


def _on(wall: Floats, shape: Any, name: str) -> tuple[Floats, tuple[str, ...]]:
    """Return the nodes of one polyline of a wall (n, 2) on its new shape, and notes."""
    closed = bool((wall[0] == wall[-1]).all())
    if isinstance(shape, np.ndarray):
        if shape.ndim != 2 or shape.shape[1] != 2 or len(shape) < 2:
            problem = f"nodes of shape {shape.shape} for {name!r}"
            raise InputError(problem, "give (n, 2) points", parameter="wall")
        if len(shape) == len(wall):
            return _in_order(wall, shape, closed=closed), ()
        if not closed:
            return on_line(wall, shape)
        from meshonet.geometry.shapes.closed_curve import closed_curve

        return on_outline(wall, closed_curve(shape, name))
    if isinstance(shape, Boundary):
        return _on_boundary(wall, shape, name, closed=closed)
    if isinstance(shape, DomainShape):
        return _on_loops(wall, shape, name, closed=closed)
    if not isinstance(shape, Airfoil | Outline):
        raise InputError(f"{type(shape).__name__} is no outline", "give a closed curve", parameter="wall")
    return on_outline(wall, shape) if closed else on_line(wall, shape.curve.points)


def _in_order(wall: Floats, nodes: Floats, *, closed: bool) -> Floats:
    """Return `nodes` (n, 2) in the direction of the wall; a closed polyline repeats its first node."""
    if closed:
        nodes = np.concatenate([nodes[:-1], nodes[:1]])
        backwards = (polygon_area(wall[:-1]) > 0) != (polygon_area(nodes[:-1]) > 0)
    else:
        apart = [float(np.abs(wall[[0, -1]] - ends).sum()) for ends in (nodes[[0, -1]], nodes[[-1, 0]])]
        backwards = apart[1] < apart[0]
    return np.ascontiguousarray(nodes[::-1]) if backwards else nodes


def _on_loops(wall: Floats, shape: DomainShape, name: str, *, closed: bool) -> tuple[Floats, tuple[str, ...]]:
    loops: Sequence[Loop] = shape.domain.loops
    if len(loops) != 1:
        problem = f"the new shape of {name!r} has {len(loops)} closed curves"
        raise InputError(problem, "give a file with one", parameter="wall")
    points = loops[0].curve.points
    return on_outline(wall, Outline(points, name)) if closed else on_line(wall, points)


def _on_boundary(wall: Floats, new: Boundary, name: str, *, closed: bool) -> tuple[Floats, tuple[str, ...]]:
    """Return the nodes of a wall on the edge of `new` that has the wall's name, or on its body."""
    parts = [patch for patch in new.patches if patch.name == name]
    if new.around_body:
        line = new.south[new.wake : len(new.south) - new.wake]
    elif len(parts) == 1:
        line = getattr(new, parts[0].side)[parts[0].start : parts[0].stop + 1]
        line = line[::-1] if parts[0].side in ("north", "west") else line
    else:
        names = ", ".join(patch.name for patch in new.patches)
        raise InputError(f"the new boundary has no {name!r}", f"it has {names}", parameter="wall")
    return _on(wall, np.ascontiguousarray(line), name) if closed or len(line) else (wall, ())


def _check(name: str, old: Floats, before: Floats, after: Floats, known: Bools) -> None:
    """Raise InputError where two pieces give a shared node different positions."""
    extent = extent_of(old)
    apart = np.abs(before - after).max(axis=1)
    if known.any() and apart[known].max() > SAME * extent:
        x = ", ".join(f"{value:.6g}" for value in old[known][int(np.argmax(apart[known]))])
        problem = f"two walls put the node at ({x}) at places {apart[known].max():.3g} apart"
        raise InputError(problem, f"have {name!r} end where its neighbour does", parameter="wall")


def _check_outline(nodes: Floats, name: str) -> None:
    closed = bool((nodes[0] == nodes[-1]).all())
    crossings = find_crossings(nodes[:-1] if closed else nodes, closed=closed, limit=1)
    if crossings:
        at = f"({crossings[0].x:.6g}, {crossings[0].y:.6g})"
        raise InputError(f"the new {name!r} crosses itself at {at}", "correct it", parameter="wall")
