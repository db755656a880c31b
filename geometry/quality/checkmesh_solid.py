"""The measures of OpenFOAM's checkMesh for volumes (docs/reference/metrics.md).

Faces are triangles around the mean of their corners, cells pyramids over their faces. Source: OpenFOAM,
primitiveMeshFaceCentresAndAreas.C, primitiveMeshCellCentresAndVols.C and primitiveMeshTools.C in
src/OpenFOAM/meshes/primitiveMesh.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.across import rows_beside
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.connection import cells_at
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import arctan2, cbrt

_TINY = 1e-300  # in place of 0 in divisors


Values: TypeAlias = tuple[tuple[int, ...], Floats | None, Floats]
"""Of a plane of faces: a cell at the first; angles in degrees (None at boundaries) and skewness of all."""


@dataclass(frozen=True, eq=False)
class Cells:
    """Centres (3, ni-1, nj-1, nk-1) and aspect ratios (ni-1, nj-1, nk-1) of the cells of a block."""

    centres: Floats
    aspect: Floats


def solid_faces(grid: Grid, cells: Sequence[Cells]) -> Iterator[Values]:
    """Yield per plane of faces: cell at the first; non-orthogonality (None at boundary), skewness of all."""
    for number, (block, own) in enumerate(zip(grid.blocks, cells, strict=True)):
        nodes = np.moveaxis(block.nodes, -1, 0)
        for axis in range(3):
            layers, centres = (np.moveaxis(values, axis + 1, 0) for values in (nodes, own.centres))
            for m in range(1, len(layers) - 1):
                measured = _between(layers[m], centres[m - 1], centres[m], _turn(axis))
                angle, skew = (np.expand_dims(each, axis) for each in measured)
                yield _place(number, axis, m - 1, (0, 0)), angle, skew
    yield from _across(grid, cells)
    for patch in grid.outer_patches():
        axis, end = patch.place
        counts = grid.blocks[patch.block].counts
        spans = patch.range(counts[:axis] + counts[axis + 1 :])
        (nodes,) = rows_beside(grid, patch.block, patch.side, spans, 1)
        at = (slice(None), *(slice(first, last) for first, last in spans))
        skew = _at_boundary(np.moveaxis(nodes, -1, 0), np.take(cells[patch.block].centres, end, axis + 1)[at])
        first = (spans[0][0], spans[1][0])
        yield cell_at(grid, patch.block, patch.side, first), None, np.expand_dims(skew, axis)


def _across(grid: Grid, cells: Sequence[Cells]) -> Iterator[Values]:
    def face(block: int, side: Side) -> Floats:
        axis, end = PLACES[side]
        return np.moveaxis(np.take(cells[block].centres, end, axis + 1), 0, -1)

    for each in grid.connections:
        (nodes,) = rows_beside(grid, each.block, each.side, each.range, 1)
        own, donor = cells_at(each, face)
        if each.transform:
            nodes, own = each.transform(nodes), each.transform(own)
        axis, end = PLACES[each.side]
        planes = [np.moveaxis(values, -1, 0) for values in (nodes, own, donor)]
        measured = _between(planes[0], planes[1], planes[2], _turn(axis) * (1 if end else -1))
        angle, skew = (np.expand_dims(value, axis) for value in measured)
        first = (each.range[0][0], each.range[1][0])
        yield cell_at(grid, each.block, each.side, first), angle, skew


def cells_of(nodes: Floats) -> Cells:
    """Return centres and aspect ratios of the cells of a block with `nodes` (ni, nj, nk, 3)."""
    planes = np.moveaxis(nodes, -1, 0)
    shape = [count - 1 for count in nodes.shape[:3]]
    centres, aspect = np.empty((3, *shape)), np.empty(shape)
    before = _layer(planes[:, 0])
    for i in range(shape[0]):
        low, high = planes[:, i], planes[:, i + 1]
        after = _layer(high)
        along_j = _faces((low[..., :-1], high[..., :-1], high[..., 1:], low[..., 1:]), -1)
        along_k = _faces((low[:, :-1], high[:, :-1], high[:, 1:], low[:, 1:]), 1)
        pairs = [
            (before, after),
            tuple(tuple(part[:, ends] for part in along_j) for ends in (slice(-1), slice(1, None))),
            tuple(tuple(part[..., ends] for part in along_k) for ends in (slice(-1), slice(1, None))),
        ]
        centres[:, i], aspect[i] = _cells(pairs)
        before = after
    return Cells(centres, aspect)


def _cells(pairs: Sequence[Sequence[Sequence[Floats]]]) -> tuple[Floats, Floats]:
    """Return centres (3, n, m) and aspect ratios (n, m) of cells between three pairs of faces."""
    estimate = np.asarray(sum(centre for pair in pairs for centre, _ in pair)) / 6.0
    volume, moment, extent = np.zeros(estimate.shape[1:]), np.zeros(estimate.shape), np.zeros(estimate.shape)
    for pair in pairs:
        for sign, (centre, area) in zip((-1.0, 1.0), pair, strict=True):
            pyramid = sign * _dot(area, centre - estimate)  # three times its volume
            volume += pyramid
            moment += pyramid * (0.75 * centre + 0.25 * estimate)
            extent += np.abs(area)
    solid = np.abs(volume) > _TINY
    middle = np.where(solid, moment / np.where(solid, volume, 1.0), estimate)
    box = extent.max(axis=0) / np.maximum(extent.min(axis=0), _TINY)
    bulk = extent.sum(axis=0) / (6.0 * cbrt(np.maximum(volume / 3.0, _TINY)) ** 2)
    return middle, np.maximum(box, bulk)


def _turn(axis: int) -> int:
    """Return the sign of the normal along an axis that the two other directions span."""
    return -1 if axis == 1 else 1


def _layer(nodes: Floats, turn: int = 1) -> tuple[Floats, Floats]:
    """Return centres and area vectors of the faces of a layer of nodes (3, n, m)."""
    ring = nodes[:, :-1, :-1], nodes[:, 1:, :-1], nodes[:, 1:, 1:], nodes[:, :-1, 1:]
    return _faces(ring, turn)


def _faces(ring: Sequence[Floats], turn: int) -> tuple[Floats, Floats]:
    """Return centres and area vectors (3, n, m) of faces, given their four corners in order."""
    middle = 0.25 * (ring[0] + ring[1] + ring[2] + ring[3])
    spokes = [corner - middle for corner in ring]
    area, moment, total = np.zeros_like(middle), np.zeros_like(middle), np.zeros(middle.shape[1:])
    for k, spoke in enumerate(spokes):
        normal = _cross(spoke, spokes[(k + 1) % 4])
        weight = np.sqrt(_dot(normal, normal))
        area += normal
        moment += weight * (spoke + spokes[(k + 1) % 4])
        total += weight
    return middle + moment / (3.0 * np.maximum(total, _TINY)), 0.5 * turn * area


def _between(nodes: Floats, own: Floats, neighbour: Floats, turn: int) -> tuple[Floats, Floats]:
    """Return angle and skewness of the faces of a layer (3, n, m), given the cell centres on both sides."""
    centre, area = _layer(nodes, turn)
    way = neighbour - own
    along = _dot(area, way)
    across = _cross(area, way)
    angle = np.degrees(arctan2(np.sqrt(_dot(across, across)), along))
    middle = centre - own
    part = _dot(area, middle) / np.where(along == 0, _TINY, along)
    return angle, _face_skewness(middle - part * way, nodes, centre, 0.2 * np.sqrt(_dot(way, way)))


def _at_boundary(nodes: Floats, own: Floats) -> Floats:
    """Return the skewness of the faces of a layer (3, n, m) at the boundary."""
    centre, area = _layer(nodes)
    unit = area / np.maximum(np.sqrt(_dot(area, area)), _TINY)
    middle = centre - own
    height = _dot(unit, middle)
    return _face_skewness(middle - height * unit, nodes, centre, 0.4 * np.abs(height))


def _face_skewness(off: Floats, nodes: Floats, centre: Floats, least: Floats) -> Floats:
    """Return abs(off) over the larger of `least` and the face's extent from its centre along `off`."""
    size = np.sqrt(_dot(off, off))
    unit = off / np.maximum(size, _TINY)
    reach = least
    for corner in (nodes[:, :-1, :-1], nodes[:, 1:, :-1], nodes[:, 1:, 1:], nodes[:, :-1, 1:]):
        reach = np.maximum(reach, np.abs(_dot(unit, corner - centre)))
    return np.asarray(size / np.maximum(reach, _TINY))


def _dot(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[0] * v[0] + u[1] * v[1] + u[2] * v[2])


def _cross(u: Floats, v: Floats) -> Floats:
    result = np.empty(np.broadcast_shapes(u.shape, v.shape))
    for k in range(3):
        a, b = (k + 1) % 3, (k + 2) % 3
        np.subtract(u[a] * v[b], u[b] * v[a], out=result[k])
    return result


def cell_at(grid: Grid, block: int, side: Side, first: tuple[int, ...]) -> tuple[int, ...]:
    """Return the cell (block, i, j[, k]) next to a side; `first` has the indices along this side."""
    axis, end = PLACES[side]
    return _place(block, axis, 0 if end == 0 else grid.blocks[block].counts[axis] - 2, first)


def _place(block: int, axis: int, index: int, first: tuple[int, ...]) -> tuple[int, ...]:
    at = list(first)
    at.insert(axis, index)
    return (block, *at)
