"""The measures of faces of OpenFOAM's checkMesh (docs/reference/metrics.md) for planar grids.

Source: OpenFOAM, src/OpenFOAM/meshes/primitiveMesh/primitiveMeshCheck/primitiveMeshTools.C and
primitiveMeshCheck.C (thresholds 70 degrees, 4, 1000).
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats, cross2, dots
from meshonet.geometry.blocks.across import across, rows_at
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import arctan2, cos
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.checkmesh_solid import Values, cell_at, cells_of, solid_faces
from meshonet.geometry.quality.growth import Extreme, Tally, strips
from meshonet.geometry.quality.metrics import FACE_NAMES


@dataclass(frozen=True)
class FaceMeasures:
    """For each measure of faces, its largest value, the cell there, and its mean; None if no face has it.

    A cell is (i, j) in a single planar block, (block, i, j) in several, and (block, i, j, k) in volumes.
    """

    non_orthogonality: Extreme | None
    face_skewness: Extreme | None
    box_ratio: Extreme | None


def faces(grid: Grid) -> FaceMeasures:
    """Return OpenFOAM's face measures of a planar or volume grid. Raises InputError: a surface grid."""
    if grid.form == "volume":
        cells = [cells_of(block.nodes) for block in grid.blocks]
        ratios = (((number, 0, 0, 0), own.aspect) for number, own in enumerate(cells))
        return _summed(solid_faces(grid, cells), ratios)
    if grid.form == "surface":
        problem = f"a surface has no faces between cells, of which {', '.join(FACE_NAMES)} are"
        raise InputError(problem, "make a volume of it, or judge it by other figures")
    boxes = (
        ((number, i, 0), _box_ratio(part))
        for number, block in enumerate(grid.blocks)
        for i, part in strips(block.nodes, 1)
    )
    return _summed(_of_blocks(grid), boxes, alone=grid.topology != "blocks")


def worst_faces(grid: Grid, name: str) -> list[Floats]:
    """Return, for each block, the largest value (ni-1, nj-1[, nk-1]) of measure `name` on faces of each cell.

    A face between two cells counts only for the cell with the lower index. Raises InputError for surfaces.
    """
    if name == "box_ratio":
        volume = grid.form == "volume"
        return [cells_of(block.nodes).aspect if volume else _box_ratio(block.nodes) for block in grid.blocks]
    values = [np.zeros([count - 1 for count in block.counts]) for block in grid.blocks]
    measured = _of_blocks(grid)
    if grid.form == "volume":
        measured = solid_faces(grid, [cells_of(block.nodes) for block in grid.blocks])
    for (number, *first), angle, skew in measured:
        own = angle if name == "non_orthogonality" else skew
        if own is not None:
            part = values[number][tuple(slice(k, k + n) for k, n in zip(first, own.shape, strict=True))]
            np.maximum(part, own, out=part)
    return values


def cells_beyond(grid: Grid, angle: float, skew: float) -> list[tuple[int, int, int]]:
    """Return the cells (block, i, j) with a non-orthogonality above `angle` or a skewness above `skew`."""
    cells: list[tuple[int, int, int]] = []
    for (block, i, j), angles, skews in _of_blocks(grid):
        where = skews > skew if angles is None else (angles > angle) | (skews > skew)
        cells += [(block, i + a, j + b) for a, b in np.argwhere(where).tolist()]
    return cells


def _of_blocks(grid: Grid) -> Iterator[Values]:
    """Yield the measures of the faces of planar blocks."""
    for number, block in enumerate(grid.blocks):
        yield from _within(block.nodes, number)
    yield from _across(grid)
    yield from _outer(grid)


def _summed(
    faces: Iterable[Values], box_ratios: Iterable[tuple[tuple[int, ...], Floats]], *, alone: bool = False
) -> FaceMeasures:
    """Return the statistics of measures; places of a block `alone` are without its number."""
    angles, cosines, skews, boxes = Tally(), Tally(), Tally(), Tally()
    for place, angle, skew in faces:
        skews.add(place, skew)
        if angle is not None:
            angles.add(place, angle)
            cosines.add(place, cos(np.radians(angle)))
    for place, ratio in box_ratios:
        boxes.add(place, ratio)
    largest, cosine = angles.extreme, cosines.extreme
    if largest and cosine:
        largest = replace(largest, mean=math.degrees(math.acos(min(1.0, max(-1.0, cosine.mean)))))
    extremes = largest, skews.extreme, boxes.extreme
    return FaceMeasures(*(replace(each, at=each.at[1:]) if each and alone else each for each in extremes))


def _within(nodes: Floats, number: int) -> Iterator[Values]:
    """Yield the inner faces of a block."""
    for i, block in strips(nodes, 2):
        centre = centroids(block)
        yield (number, i, 0), *_between(centre[:-1], centre[1:], block[1:-1, :-1], block[1:-1, 1:])
    for i, block in strips(nodes, 1):
        centre = centroids(block)
        yield (number, i, 0), *_between(centre[:, :-1], centre[:, 1:], block[1:, 1:-1], block[:-1, 1:-1])


def _across(grid: Grid) -> Iterator[Values]:
    """Yield the faces on connections; each belongs to a cell of the connection's own side."""
    for each in grid.connections:
        own, donor = across(grid, each, 2)
        axis, end = PLACES[each.side]
        if (axis == 0) == (end == 0):  # the donor is on the right of edges that run the other way
            own, donor = own[:, ::-1], donor[:, ::-1]
        inner, beyond = (centroids(rows.swapaxes(0, 1))[:, 0] for rows in (own, donor))
        values = _between(inner, beyond, donor[0, :-1], donor[0, 1:])
        if (axis == 0) == (end == 0):
            values = values[0][::-1], values[1][::-1]
        angle, skew = (np.expand_dims(value, axis) for value in values)
        yield cell_at(grid, each.block, each.side, (each.range[0][0],)), angle, skew


def _outer(grid: Grid) -> Iterator[Values]:
    """Yield the faces on the outer boundary."""
    for patch in grid.outer_patches():
        rows = rows_at(grid, patch, 2)
        skew = _at_boundary(centroids(rows.swapaxes(0, 1))[:, 0], rows[0, :-1], rows[0, 1:])
        at = cell_at(grid, patch.block, patch.side, (patch.start,))
        yield at, None, np.expand_dims(skew, patch.place[0])


def centroids(nodes: Floats) -> Floats:
    """Return the centroids (ni-1, nj-1, 2) of the cells of `nodes` (ni, nj, 2), from two triangles each."""
    a = nodes[:-1, :-1]
    b, c, d = nodes[1:, :-1] - a, nodes[1:, 1:] - a, nodes[:-1, 1:] - a
    first, second = cross2(b, c), cross2(c, d)
    area = first + second
    area = np.where(area == 0, np.finfo(float).tiny, area)[..., None]
    return np.asarray(a + ((b + c) * first[..., None] + (c + d) * second[..., None]) / (3 * area))


def _between(own: Floats, neighbour: Floats, a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Return angle and skewness of faces from `a` to `b`; (b - a) turned right points to `neighbour`."""
    edge, way = b - a, neighbour - own
    square = -cross2(edge, way)  # abs(S) abs(d) cos: the normal is the edge turned right
    angle = np.degrees(arctan2(np.abs(dots(edge, way)), square))
    middle = 0.5 * (a + b) - own
    crossing = cross2(middle, edge) / np.where(square == 0, np.finfo(float).tiny, square)
    off = middle - crossing[..., None] * way
    return angle, _face_skewness(off, edge, 0.2 * np.hypot(way[..., 0], way[..., 1]))


def _at_boundary(own: Floats, a: Floats, b: Floats) -> Floats:
    """Return the skewness of boundary faces from `a` to `b`, of cells with centres `own`."""
    edge, middle = b - a, 0.5 * (a + b) - own
    length = np.hypot(edge[..., 0], edge[..., 1])
    unit = edge / np.maximum(length, np.finfo(float).tiny)[..., None]
    off = dots(middle, unit)[..., None] * unit
    return _face_skewness(off, edge, 0.4 * np.abs(cross2(middle, unit)))


def _face_skewness(off: Floats, edge: Floats, least: Floats) -> Floats:
    """Return abs(off) over the larger of `least` and half the face's extent in the direction of `off`."""
    size = np.hypot(off[..., 0], off[..., 1])
    tiny = np.finfo(float).tiny
    reach = 0.5 * np.abs(dots(off, edge)) / np.maximum(size, tiny)
    return np.asarray(size / np.maximum(np.maximum(least, reach), tiny))


def _box_ratio(nodes: Floats) -> Floats:
    along, across = np.abs(np.diff(nodes, axis=0)), np.abs(np.diff(nodes, axis=1))
    extent = along[:, :-1] + along[:, 1:] + across[:-1] + across[1:]
    least = np.maximum(extent.min(axis=-1), np.finfo(float).tiny)
    return np.asarray(extent.max(axis=-1) / least)
