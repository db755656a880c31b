"""What OpenFOAM's checkMesh says of a grid: non-orthogonality, skewness, aspect ratio.

Here of a grid in the plane as one that is a cell thick; of volumes see
`meshonet.geometry.quality.checkmesh_solid`.

::

    own  o-----.-- nei      d: from the centre of the owner to that of the neighbour
               |            S: normal of the face, its length the face's
               f            f: the face's centre

===================  =======================================================================================
non_orthogonality    angle between d and S, degrees, of every face inside (90 and more is an error there); its
                     mean is the angle of the mean cosine
face_skewness        distance from f to where d crosses the face's plane, over the larger of 0.2 abs(d) and
                     the face's reach from f in that direction; at the outer boundary d is the way from the
                     owner's centre square to the face, and counts 0.4
box_ratio            sum of abs(Sx) over the faces of a cell against that of abs(Sy), the larger over the
                     smaller: its aspect ratio for cells along the axes
===================  =======================================================================================

Faces on the seam of an O grid, on the wake of a C grid and between blocks are inside, as they are in a mesh
whose nodes were merged. Source: OpenFOAM, src/OpenFOAM/meshes/primitiveMesh/primitiveMeshCheck/
primitiveMeshTools.C and primitiveMeshCheck.C (thresholds 70 degrees, 4, 1000).
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.across import across, rows_beside
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import arctan2, cos
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.checkmesh_solid import cells_of, solid_faces
from meshonet.geometry.quality.growth import Extreme, Tally, beyond_seam, strips

FACES = ("non_orthogonality", "face_skewness", "box_ratio")
"""Figures of `Faces`."""

SEVERE = 70.0
"""Non-orthogonality from which checkMesh counts faces."""

Values: TypeAlias = tuple[int, int, Floats, int | None]
"""Cell (i, j) of the first value, values (m, n), and the block, None for the only one."""
Inside: TypeAlias = tuple[int, int, Floats, Floats, int | None]
"""The same with two values: angle and skewness."""


@dataclass(frozen=True)
class Faces:
    """Measures of the faces, the greatest at cell (i, j), whose face it is; None where there is no such face.

    In a grid of many blocks cells are (block, i, j), in volumes (block, i, j, k).

    `severe` counts the faces with a non-orthogonality beyond 70 degrees.
    """

    non_orthogonality: Extreme | None
    severe: int
    face_skewness: Extreme | None
    box_ratio: Extreme | None


def faces(grid: Grid) -> Faces:
    """Return the measures of the faces of `grid`.

    Raises InputError: a surface, which has no faces between cells of volume.
    """
    if grid.form == "volume":
        return _of_volume(grid)
    if grid.topology != "blocks":
        only: Iterator[Values] = ((i, 0, _box_ratio(part), None) for i, part in strips(grid.nodes, 1))
        return _summed(_inside(grid), _outside(grid), only)
    if grid.form == "surface":
        problem = f"a surface has no faces between cells, of which {', '.join(FACES)} are"
        raise InputError(problem, "make a volume of it, or judge it by other figures")
    blocks = list(enumerate(grid.blocks))
    within = (face for number, block in blocks for face in _within(block.nodes, number))
    boxes = ((0, 0, _box_ratio(block.nodes), number) for number, block in blocks)
    return _summed(chain(within, _across(grid)), _outer(grid), boxes)


def _of_volume(grid: Grid) -> Faces:
    cells = [cells_of(block.nodes) for block in grid.blocks]
    angles, cosines, skews, boxes, severe = Tally(), Tally(), Tally(), Tally(), 0
    for place, axis, angle, skew in solid_faces(grid, cells):
        skews.add_from(place, np.expand_dims(skew, axis))
        if angle is not None:
            angles.add_from(place, np.expand_dims(angle, axis))
            cosines.add_from(place, np.expand_dims(cos(np.radians(angle)), axis))
            severe += int((angle > SEVERE).sum())
    for number, own in enumerate(cells):
        boxes.add_from((number, 0, 0, 0), own.aspect)
    return Faces(_of_cosines(angles.extreme, cosines.extreme), severe, skews.extreme, boxes.extreme)


def cells_beyond(grid: Grid, angle: float, skew: float) -> list[tuple[int, int, int]]:
    """Return the cells (block, i, j) with a face beyond a non-orthogonality, in degrees, or a skewness."""
    cells: list[tuple[int, int, int]] = []
    for number, block in enumerate(grid.blocks):
        for i, j, angles, skews, _ in _within(block.nodes, number):
            cells += _placed(number, i, j, (angles > angle) | (skews > skew))
    for i, j, angles, skews, at in _across(grid):
        cells += _placed(at or 0, i, j, (angles > angle) | (skews > skew))
    for i, j, skews, at in _outer(grid):
        cells += _placed(at or 0, i, j, skews > skew)
    return cells


def _placed(block: int, i: int, j: int, where: NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    return [(block, i + a, j + b) for a, b in np.argwhere(where).tolist()]


def _summed(inside: Iterable[Inside], outside: Iterable[Values], box_ratios: Iterable[Values]) -> Faces:
    angles, skews, boxes = Tally(), Tally(), Tally()
    severe, cosines = 0, Tally()
    for i, j, angle, skew, block in inside:
        severe += int((angle > SEVERE).sum())
        angles.add(i, j, angle, block)
        cosines.add(i, j, cos(np.radians(angle)))
        skews.add(i, j, skew, block)
    for i, j, skew, block in outside:
        skews.add(i, j, skew, block)
    for i, j, ratio, block in box_ratios:
        boxes.add(i, j, ratio, block)
    return Faces(_of_cosines(angles.extreme, cosines.extreme), severe, skews.extreme, boxes.extreme)


def _of_cosines(angle: Extreme | None, cosine: Extreme | None) -> Extreme | None:
    """Return an angle whose mean is that of the mean cosine."""
    if angle is None or cosine is None:
        return None
    return replace(angle, mean=math.degrees(math.acos(min(1.0, max(-1.0, cosine.mean)))))


def _inside(grid: Grid) -> Iterator[Inside]:
    """Yield cell (i, j) of the first face, angles and skewness (m, n) of the faces inside."""
    yield from _within(beyond_seam(grid), None, grid.nodes)
    wake = grid.wake
    if wake:
        first, last = centroids(grid.nodes[: wake + 1, :2]), centroids(grid.nodes[-wake - 1 :, :2])[::-1]
        yield 0, 0, *_between(last, first, grid.nodes[1 : wake + 1, :1], grid.nodes[:wake, :1]), None


def _within(nodes: Floats, number: int | None, once: Floats | None = None) -> Iterator[Inside]:
    """Yield the faces inside a block: those across xi of `nodes`, those across eta of `once` if given."""
    for i, block in strips(nodes, 2):
        centre = centroids(block)
        yield i, 0, *_between(centre[:-1], centre[1:], block[1:-1, :-1], block[1:-1, 1:]), number
    for i, block in strips(nodes if once is None else once, 1):
        centre = centroids(block)
        yield i, 0, *_between(centre[:, :-1], centre[:, 1:], block[1:, 1:-1], block[:-1, 1:-1]), number


def _across(grid: Grid) -> Iterator[Inside]:
    """Yield the faces on the connections of blocks, which are those of cells of the first one."""
    for each in grid.connections:
        own, donor = across(grid, each, 2)
        axis, end = PLACES[each.side]
        if (axis == 0) == (end == 0):  # the donor is on the right of edges that run the other way
            own, donor = own[:, ::-1], donor[:, ::-1]
        inner, beyond = (centroids(rows.swapaxes(0, 1))[:, 0] for rows in (own, donor))
        values = _between(inner, beyond, donor[0, :-1], donor[0, 1:])
        if (axis == 0) == (end == 0):
            values = values[0][::-1], values[1][::-1]
        counts = [count - 1 for count in grid.blocks[each.block].counts]
        at = [each.range[0][0]] * 2
        at[axis] = 0 if end == 0 else counts[axis] - 1
        angle, skew = (np.expand_dims(value, axis) for value in values)
        yield at[0], at[1], angle, skew, each.block


def _outside(grid: Grid) -> Iterator[Values]:
    """Yield cell (i, j) of the first face and the skewness (m, n) of the faces of the outer boundary."""
    nodes, wake = grid.nodes, grid.wake
    body = nodes[wake : grid.ni - wake]
    yield wake, 0, _at_boundary(centroids(body[:, :2]), body[:-1, :1], body[1:, :1]), None
    yield 0, grid.nj - 2, _at_boundary(centroids(nodes[:, -2:]), nodes[:-1, -1:], nodes[1:, -1:]), None
    if not grid.periodic:
        yield 0, 0, _at_boundary(centroids(nodes[:2]), nodes[:1, :-1], nodes[:1, 1:]), None
        yield grid.ni - 2, 0, _at_boundary(centroids(nodes[-2:]), nodes[-1:, :-1], nodes[-1:, 1:]), None


def _outer(grid: Grid) -> Iterator[Values]:
    """Yield the faces of the outer boundary of many blocks."""
    for patch in grid.outer_patches():
        rows = rows_beside(grid, patch.block, patch.side, ((patch.start, patch.stop),), 2)
        skew = _at_boundary(centroids(rows.swapaxes(0, 1))[:, 0], rows[0, :-1], rows[0, 1:])
        axis, end = patch.place
        at = [patch.start] * 2
        at[axis] = 0 if end == 0 else grid.blocks[patch.block].counts[axis] - 2
        yield at[0], at[1], np.expand_dims(skew, axis), patch.block


def centroids(nodes: Floats) -> Floats:
    """Return the centroids (ni-1, nj-1, 2) of the cells of `nodes` (ni, nj, 2), by two triangles each."""
    a = nodes[:-1, :-1]
    b, c, d = nodes[1:, :-1] - a, nodes[1:, 1:] - a, nodes[:-1, 1:] - a
    first, second = _cross(b, c), _cross(c, d)
    area = first + second
    area = np.where(area == 0, np.finfo(float).tiny, area)[..., None]
    return np.asarray(a + ((b + c) * first[..., None] + (c + d) * second[..., None]) / (3 * area))


def _between(own: Floats, neighbour: Floats, a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Return angle and skewness of faces from `a` to `b`; (b - a) turned right points to the `other` side."""
    edge, way = b - a, neighbour - own
    square = edge[..., 0] * way[..., 1] - edge[..., 1] * way[..., 0]
    square = -square  # abs(S) abs(d) cos: the normal is the edge turned right
    angle = np.degrees(arctan2(np.abs(_dot(edge, way)), square))
    middle = 0.5 * (a + b) - own
    crossing = _cross(middle, edge) / np.where(square == 0, np.finfo(float).tiny, square)
    off = middle - crossing[..., None] * way
    return angle, _skewness(off, edge, 0.2 * np.hypot(way[..., 0], way[..., 1]))


def _at_boundary(own: Floats, a: Floats, b: Floats) -> Floats:
    """Return the skewness of boundary faces from `a` to `b` of cells with their centres at `own`."""
    edge, middle = b - a, 0.5 * (a + b) - own
    length = np.hypot(edge[..., 0], edge[..., 1])
    unit = edge / np.maximum(length, np.finfo(float).tiny)[..., None]
    off = _dot(middle, unit)[..., None] * unit
    return _skewness(off, edge, 0.4 * np.abs(_cross(middle, unit)))


def _skewness(off: Floats, edge: Floats, least: Floats) -> Floats:
    """Return abs(off) over the larger of `least` and half the face's extent along it."""
    size = np.hypot(off[..., 0], off[..., 1])
    tiny = np.finfo(float).tiny
    reach = 0.5 * np.abs(_dot(off, edge)) / np.maximum(size, tiny)
    return np.asarray(size / np.maximum(np.maximum(least, reach), tiny))


def _box_ratio(nodes: Floats) -> Floats:
    along, across = np.abs(np.diff(nodes, axis=0)), np.abs(np.diff(nodes, axis=1))
    extent = along[:, :-1] + along[:, 1:] + across[:-1] + across[1:]
    least = np.maximum(extent.min(axis=-1), np.finfo(float).tiny)
    return np.asarray(extent.max(axis=-1) / least)


def _cross(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def _dot(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[..., 0] * v[..., 0] + u[..., 1] * v[..., 1])
