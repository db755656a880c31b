"""What OpenFOAM's checkMesh says of volumes: non-orthogonality, skewness, aspect ratio.

Faces and cells are those of its mesh: a face's area vector and centre come from triangles around the mean of
its corners, a cell's centre and volume from pyramids over its faces. Definitions of the measures are those of
`meshonet.geometry.quality.checkmesh`, but that

- a face's reach is the farthest of its corners in the direction of what is off;
- the aspect ratio of a cell is the greatest of sum abs(S) along x, y and z over the least, or, if that is
more,
  sum abs(S) of all over 6 V^(2/3).

Faces on connections are inside. Source: OpenFOAM,
src/OpenFOAM/meshes/primitiveMesh/primitiveMeshFaceCentresAndAreas.C, primitiveMeshCellCentresAndVols.C and
primitiveMeshCheck/primitiveMeshTools.C.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats, Side, norms
from meshonet.geometry.blocks.across import rows_beside
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.connection import cells_at
from meshonet.geometry.blocks.grid import Grid

_TINY = 1e-300


class Measures(NamedTuple):
    """Place (block, i, j, k) of the first of faces (n, m), their angles, None at the boundary, skewness."""

    place: tuple[int, ...]
    axis: int
    angle: Floats | None
    skewness: Floats


@dataclass(frozen=True, eq=False)
class Cells:
    """Centres (ni-1, nj-1, nk-1, 3) and aspect ratios (ni-1, nj-1, nk-1) of the cells of a block."""

    centres: Floats
    aspect: Floats


def solid_faces(grid: Grid, cells: Sequence[Cells]) -> Iterator[Measures]:
    """Yield the measures of the faces of blocks of volume with those `cells`, a layer at a time."""
    for number, (block, own) in enumerate(zip(grid.blocks, cells, strict=True)):
        for axis in range(3):
            layers, centres = np.moveaxis(block.nodes, axis, 0), np.moveaxis(own.centres, axis, 0)
            for m in range(1, len(layers) - 1):
                angle, skew = _between(layers[m], centres[m - 1], centres[m], _turn(axis))
                yield Measures(_place(number, axis, m - 1, (0, 0)), axis, angle, skew)
    yield from _across(grid, cells)
    for patch in grid.outer_patches():
        axis, end = patch.place
        counts = grid.blocks[patch.block].counts
        spans = patch.range(counts[:axis] + counts[axis + 1 :])
        (nodes,) = rows_beside(grid, patch.block, patch.side, spans, 1)
        at = tuple(slice(first, last) for first, last in spans)
        skew = _at_boundary(nodes, np.moveaxis(cells[patch.block].centres, axis, 0)[end][at])
        first = (spans[0][0], spans[1][0])
        yield Measures(
            _place(patch.block, axis, 0 if end == 0 else counts[axis] - 2, first), axis, None, skew
        )


def _across(grid: Grid, cells: Sequence[Cells]) -> Iterator[Measures]:
    def face(block: int, side: Side) -> Floats:
        axis, end = PLACES[side]
        return np.asarray(np.moveaxis(cells[block].centres, axis, 0)[end])

    for each in grid.connections:
        (nodes,) = rows_beside(grid, each.block, each.side, each.range, 1)
        own, donor = cells_at(each, face)
        if each.transform:
            nodes, own = each.transform(nodes), each.transform(own)
        axis, end = PLACES[each.side]
        angle, skew = _between(nodes, own, donor, _turn(axis) * (1 if end else -1))
        index = 0 if end == 0 else grid.blocks[each.block].counts[axis] - 2
        first = (each.range[0][0], each.range[1][0])
        yield Measures(_place(each.block, axis, index, first), axis, angle, skew)


def cells_of(nodes: Floats) -> Cells:
    """Return the cells of a block of nodes (ni, nj, nk, 3)."""
    faces = [_faces_along(nodes, axis) for axis in range(3)]
    estimate = sum(np.asarray(centre[0] + centre[1]) for centre, _ in faces) / 6.0
    volume, moment = np.zeros(estimate.shape[:-1]), np.zeros(estimate.shape)
    extent = np.zeros(estimate.shape)
    for centres, areas in faces:
        for end, sign in enumerate((-1.0, 1.0)):
            pyramid = sign * (areas[end] * (centres[end] - estimate)).sum(axis=-1)  # three times its volume
            volume += pyramid
            moment += pyramid[..., None] * (0.75 * centres[end] + 0.25 * estimate)
            extent += np.abs(areas[end])
    solid = np.abs(volume) > _TINY
    centre = np.where(solid[..., None], moment / np.where(solid, volume, 1.0)[..., None], estimate)
    box = extent.max(axis=-1) / np.maximum(extent.min(axis=-1), _TINY)
    bulk = extent.sum(axis=-1) / (6.0 * np.maximum(volume / 3.0, _TINY) ** (2.0 / 3.0))
    return Cells(centre, np.maximum(box, bulk))


def _faces_along(nodes: Floats, axis: int) -> tuple[list[Floats], list[Floats]]:
    """Return centres and area vectors of both faces of every cell across an axis."""
    layers = np.moveaxis(nodes, axis, 0)
    made = [_geometry(layer, _turn(axis)) for layer in layers]
    centres, areas = (np.moveaxis(np.stack([pair[k] for pair in made]), 0, axis) for k in (0, 1))
    first, last = (slice(None),) * axis + (slice(-1),), (slice(None),) * axis + (slice(1, None),)
    return [centres[first], centres[last]], [areas[first], areas[last]]


def _turn(axis: int) -> int:
    """Return the sign with which the two other directions, in their order, span a normal along an axis."""
    return -1 if axis == 1 else 1


def _geometry(nodes: Floats, turn: int) -> tuple[Floats, Floats]:
    """Return the centres and area vectors (n-1, m-1, 3) of the faces of a layer of nodes (n, m, 3)."""
    ring = [nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]]
    middle = 0.25 * (ring[0] + ring[1] + ring[2] + ring[3])
    normals = [np.cross(ring[k] - middle, ring[(k + 1) % 4] - middle) for k in range(4)]
    area = normals[0] + normals[1] + normals[2] + normals[3]
    moment, total = np.zeros_like(middle), np.zeros(middle.shape[:-1])
    for k, normal in enumerate(normals):
        weight = norms(normal)
        moment += weight[..., None] * (ring[k] + ring[(k + 1) % 4] + middle)
        total += weight
    flat = total > _TINY
    centre = np.where(flat[..., None], moment / (3.0 * np.where(flat, total, 1.0))[..., None], middle)
    return centre, 0.5 * turn * area


def _between(nodes: Floats, own: Floats, neighbour: Floats, turn: int) -> tuple[Floats, Floats]:
    """Return angle and skewness of the faces of a layer (n, m, 3) between cells with those centres."""
    centre, area = _geometry(nodes, turn)
    way = neighbour - own
    along = (area * way).sum(axis=-1)
    angle = np.degrees(np.arctan2(norms(np.cross(area, way)), along))
    middle = centre - own
    part = (area * middle).sum(axis=-1) / np.where(along == 0, _TINY, along)
    return angle, _skewness(middle - part[..., None] * way, nodes, centre, 0.2 * norms(way))


def _at_boundary(nodes: Floats, own: Floats) -> Floats:
    """Return the skewness of the faces of a layer (n, m, 3) at the boundary."""
    centre, area = _geometry(nodes, 1)
    unit = area / np.maximum(norms(area), _TINY)[..., None]
    middle = centre - own
    height = (unit * middle).sum(axis=-1)
    return _skewness(middle - height[..., None] * unit, nodes, centre, 0.4 * np.abs(height))


def _skewness(off: Floats, nodes: Floats, centre: Floats, least: Floats) -> Floats:
    """Return abs(off) over the larger of `least` and the face's reach from its centre along it."""
    size = norms(off)
    unit = off / np.maximum(size, _TINY)[..., None]
    corners = (nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:])
    reach = np.max([np.abs((unit * (corner - centre)).sum(axis=-1)) for corner in corners], axis=0)
    return np.asarray(size / np.maximum(np.maximum(least, reach), _TINY))


def _place(block: int, axis: int, index: int, first: tuple[int, int]) -> tuple[int, ...]:
    at = list(first)
    at.insert(axis, index)
    return (block, *at)
