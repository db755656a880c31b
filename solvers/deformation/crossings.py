"""Checks that a moved wall neither crosses the rest of the boundary nor lies beyond it."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Indices
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import contains
from meshonet.geometry.polygon.self_intersection import find_crossings
from meshonet.solvers.deformation.outer import NodeTable, Piece, lines_of
from meshonet.solvers.deformation.targets import NodeTargets

_MOST = 4096  # crossings looked for; those at the joints of concatenated polylines are skipped


def check_apart(table: NodeTable, targets: NodeTargets) -> None:
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
                    f"{name} is moved to the other side of {beyond}", "keep it", parameter="wall"
                )


def _name(pieces: Sequence[Piece], edge: Indices) -> str:
    names = [piece.patch.name for piece in pieces if np.isin(edge, piece.numbers).all()]
    return names[0] if names else "a side"
