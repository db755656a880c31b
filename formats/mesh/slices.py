"""A plane grid out of a three-dimensional file: one plane, or copies of one, in any index direction."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, planar_nodes
from meshonet.geometry.errors import InputError

_SAME = 1e-6
"""Two planes are copies, and a coordinate constant, to this part of the grid's size (float32 holds 1e-7)."""

_ROWS = 16


def planar(coordinates: Sequence[Floats]) -> Floats:
    """Return nodes (ni, nj, 2) of a plane grid, the constant index and the constant coordinate dropped.

    `coordinates` are x, y[, z], each (n1, n2, n3), any unit; memory order does not matter.

    Raises InputError: the grid is truly three-dimensional, or its plane is curved.
    """
    return plane_of(coordinates)[0]


def plane_of(coordinates: Sequence[Floats]) -> tuple[Floats, int]:
    """Return the nodes as `planar` does, and which index was dropped: 0, 1 or 2."""
    with np.errstate(all="ignore"):  # what is not finite is refused later, with its place
        return _plane_of(coordinates)


def _plane_of(coordinates: Sequence[Floats]) -> tuple[Floats, int]:
    dims = coordinates[0].shape
    counts = "x".join(str(n) for n in dims)
    for axis in sorted(range(3), key=lambda k: (dims[k], -k)):
        first = [_plane(c, axis, 0) for c in coordinates]
        if min(first[0].shape) < 2:
            problem = f"a grid of {counts} nodes has no cells"
            raise InputError(problem, "give at least 2 nodes in two directions")
        if dims[axis] == 1:
            return _nodes(_without_constant(first, counts)), axis
        kept = list(range(len(coordinates)))
        for index in range(1, dims[axis]):
            if not kept:
                break
            kept = _unshifted(first, [_plane(c, axis, index) for c in coordinates], kept)
        if kept:
            return _nodes([first[k] for k in kept]), axis
    remedy = "give a plane one: one plane, or copies of one, in some direction"
    raise InputError(f"a grid of {counts} nodes is three-dimensional", remedy)


def _plane(values: Floats, axis: int, index: int) -> Floats:
    """Return plane `index` of (n1, n2, n3) along `axis`, a view."""
    return values[(slice(None),) * axis + (index,)]


def _nodes(coordinates: list[Floats]) -> Floats:
    """Return (ni, nj, 2) float64 of x and y, each (ni, nj), in the layout that `Grid` keeps.

    Files have i fastest and grids j, so this transposes; a few rows at a time stay in the cache.
    """
    ni, nj = coordinates[0].shape
    nodes = planar_nodes(ni, nj)
    for start in range(0, nj, _ROWS):
        rows = slice(start, start + _ROWS)
        for k, values in enumerate(coordinates):
            nodes[:, rows, k] = values[:, rows]
    return nodes


def _without_constant(plane: list[Floats], counts: str) -> list[Floats]:
    """Return the two coordinates of a plane that vary."""
    if len(plane) == 2:
        return plane
    spans = [float(np.ptp(c)) for c in plane]
    flat = [k for k in (2, 1, 0) if not spans[k] > _SAME * max(spans)]
    if not flat:
        problem = f"the {counts} nodes lie on a curved or tilted surface"
        raise InputError(problem, "give a grid in a coordinate plane")
    return [c for k, c in enumerate(plane) if k != flat[0]]


def _unshifted(first: list[Floats], next_plane: list[Floats], among: list[int]) -> list[int]:
    """Return the two coordinates, `among` those in which earlier planes agreed, that two planes share."""
    size = max(float(np.ptp(c)) for c in first)
    for k in (2, 1, 0):
        kept = [m for m in range(len(first)) if m != k]
        if k >= len(first) or not set(kept) <= set(among):
            continue
        flat = max(float(np.ptp(first[k])), float(np.ptp(next_plane[k]))) <= _SAME * size
        if flat and all(np.allclose(first[m], next_plane[m], rtol=0, atol=_SAME * size) for m in kept):
            return kept
    return []
