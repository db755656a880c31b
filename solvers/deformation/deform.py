"""Deformation of a grid to a changed boundary that preserves its boundary layers."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Indices
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.geometry.notes import UNJUDGED
from meshonet.geometry.polygon.area import contains
from meshonet.geometry.polygon.self_intersection import find_crossings
from meshonet.geometry.quality.measure import count_folded_in, worst_cells_of
from meshonet.solvers.deformation.follow import Follow, sliding_notes
from meshonet.solvers.deformation.outer import NodeTable, Piece, first_heights, lines_of
from meshonet.solvers.deformation.targets import NewWall, NodeTargets, targets_of
from meshonet.solvers.solution import Outcome, Solution, timed

METHOD = "deformation"
STEPS = 2, 4, 8  # numbers of steps of the deformation, tried in turn while cells are folded
_MOST = 4096  # crossings looked for; those at the joints of concatenated polylines are skipped


@timed
def deform(grid: Grid, walls: Mapping[str, NewWall] | NewWall) -> Solution:
    """Return `grid` deformed to the new shapes of `walls`, with notes.

    Displacements of the boundary are interpolated to all nodes (`meshonet.solvers.deformation.follow`). If
    cells fold, the deformation is divided into steps. If cells still fold, they are repaired, and as a last
    resort nodes outside layers are smoothed. Raises InputError if the grid is a surface, has folded cells or
    has no wall of a given name, if a new shape is unsuitable, or if walls cross.
    """
    table = NodeTable.of(grid)
    folded = count_folded_in(grid)
    if folded:
        where = worst_cells_of(grid, 1)[0]
        raise InputError(f"{folded} cells of the starting grid are folded, ({where})", "give a valid grid")
    targets = targets_of(table, walls)
    follow = Follow.of(table, targets.moved)
    made, path = _made(follow, targets)
    outcome = Outcome.FOLDED if count_folded_in(made) else Outcome.DONE
    notes = (*targets.notes, *sliding_notes(follow, targets.nodes), *_layers(table, made, targets))
    made = made.with_provenance(method=METHOD, walls=",".join(targets.names), **UNJUDGED)
    return Solution(made, METHOD, path=path, notes=notes, outcome=outcome)


def _made(follow: Follow, targets: NodeTargets) -> tuple[Grid, tuple[str, ...]]:
    """Return the first grid without folded cells, or else the one with the fewest, and the stages it took."""
    tried: list[tuple[int, Grid, tuple[str, ...]]] = []
    for made, path in _ways(follow, targets):
        tried.append((count_folded_in(made), made, path))
        if not tried[-1][0]:
            break
    return min(tried, key=lambda each: each[0])[1:]


def _ways(follow: Follow, targets: NodeTargets) -> Iterator[tuple[Grid, tuple[str, ...]]]:
    made = _in_steps(follow, targets, 1)
    yield made, ()
    if made.form == "plane":
        _check_apart(follow.table, targets)
    for steps in STEPS:
        made = _in_steps(follow, targets, steps)
        yield made, (f"{steps} steps",)
    yield from _mended(made)


def _in_steps(follow: Follow, targets: NodeTargets, steps: int) -> Grid:
    table = now = follow.table
    for number in range(1, steps + 1):
        part = number / steps
        to = targets.nodes if part == 1.0 else table.nodes + part * (targets.nodes - table.nodes)
        step = follow if number == 1 else Follow.of(now, targets.moved)
        nodes = step.nodes_to(to)
        now = replace(now, nodes=nodes, grid=replace(table.grid, blocks=now.with_nodes(nodes)))
    return now.grid


def _mended(grid: Grid) -> Iterator[tuple[Grid, tuple[str, ...]]]:
    """Yield `grid`, which has folded cells, repaired around them; then smoothed outside boundary layers."""
    if grid.form == "plane" and len(grid.blocks) == 1:
        from meshonet.solvers.energy.repair import repair

        nodes = grid.nodes.copy(order="K")
        repair(nodes, grid.periodic)
        yield grid.with_nodes(nodes, finite=True), ("repair",)
    with contextlib.suppress(MeshonetError):
        if grid.form == "plane":
            from meshonet.solvers.smoothing.smooth import smooth

            yield smooth(grid).grid, ("smoothing",)
        else:
            from meshonet.solvers.smoothing.volumes import smooth_volumes

            yield smooth_volumes(grid).grid, ("smoothing",)


def _layers(table: NodeTable, after: Grid, targets: NodeTargets) -> tuple[str, ...]:
    """Return a note of the largest change of the first-cell height at the moved walls."""
    pieces = [piece for piece in table.pieces if piece.patch.name in targets.names]
    walls = [piece for piece in pieces if piece.patch.kind == "wall"] or pieces
    old, new = (first_heights(grid, walls) for grid in (table.grid, after))
    change = float(np.abs(new / old - 1.0).max())
    names = ", ".join(dict.fromkeys(piece.patch.name for piece in walls))
    return (f"first cells at {names}: heights changed by at most {100 * change:.2g} %",)


def _check_apart(table: NodeTable, targets: NodeTargets) -> None:
    """Raise InputError, with the place, if planar walls in their new positions cross other boundaries.

    Sliding sides are not checked: the ends of such a side are known only after the deformation.
    """
    moved = targets.moved
    walls = [piece for piece in table.pieces if moved[piece.numbers].all()]
    rest = [piece for piece in table.pieces if not moved[piece.numbers].any()]
    lines = [*lines_of(walls), *lines_of(rest)]
    path = np.concatenate([targets.nodes[line] for line in lines])
    joints = set((np.cumsum([len(line) for line in lines]) - 1).tolist())
    numbers = np.concatenate(lines)
    for crossing in find_crossings(path, closed=False, limit=_MOST):
        a, b = crossing.first, crossing.second
        if a in joints or b in joints or set(numbers[a : a + 2]) & set(numbers[b : b + 2]):
            continue
        names = dict.fromkeys(_name(table.pieces, numbers[k : k + 2]) for k in (a, b))
        at = f"({crossing.x:.6g}, {crossing.y:.6g})"
        raise InputError(f"{' and '.join(names)} cross at {at}", "keep them apart", parameter="wall")
    for line in lines_of(walls):
        closed = [other for other in lines if other[0] == other[-1] and other[0] != line[0]]
        for other in closed if line[0] == line[-1] else ():
            before = contains(table.nodes[other], table.nodes[line[0]])
            if contains(targets.nodes[other], targets.nodes[line[0]]) != before:
                name, beyond = (_name(table.pieces, each[:2]) for each in (line, other))
                raise InputError(
                    f"{name} is moved to the other side of {beyond}", "move it less", parameter="wall"
                )


def _name(pieces: Sequence[Piece], edge: Indices) -> str:
    names = [piece.patch.name for piece in pieces if np.isin(edge, piece.numbers).all()]
    return names[0] if names else "a side"
