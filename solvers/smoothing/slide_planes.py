"""Sliding nodes of flat outer patches: in their planes, and along the lines where two planes meet."""

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, extent_of, norms
from meshonet.geometry.blocks.block import face_of, part_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import product
from meshonet.geometry.linear import symmetric_eigen
from meshonet.geometry.volume.hex_mesh import HexMesh
from meshonet.solvers.energy.hexes import Slides

FLAT = 1e-9  # largest deviation of a patch from a plane, relative to its size
_SAME = 1e-6  # largest difference of unit normals of the same plane


def slides_of(grid: Grid, mesh: HexMesh) -> tuple[Slides, Bools]:
    """Return the planes or lines in which outer nodes slide, and a mask (n,) of these nodes.

    Other outer nodes are fixed: those on patches that are not flat, between different patches in the same
    plane, and where three planes meet.
    """
    fixed = mesh.outer.copy()
    known = np.zeros(len(mesh.nodes), dtype=bool)
    normals = np.zeros((len(mesh.nodes), 2, 3))
    count = np.zeros(len(mesh.nodes), dtype=np.intp)
    names = np.full(len(mesh.nodes), -1)
    numbers = {name: k for k, name in enumerate(sorted({patch.name for patch in grid.patches}))}
    for patch in grid.patches:
        spans = patch.range(face_of(mesh.blocks[patch.block], patch.side).shape)
        free = mesh.free_cells(patch.block, patch.side)[tuple(slice(a, b) for a, b in spans)]
        nodes = np.unique(part_of(face_of(mesh.blocks[patch.block], patch.side), spans))
        nodes = nodes[mesh.outer[nodes]]
        if not free.all():
            fixed[nodes], known[nodes], count[nodes] = True, True, 9
            continue
        _add_plane(nodes, _normal(mesh.nodes[nodes]), numbers[patch.name], normals, count, names)
        known[nodes] = True
    slide = mesh.outer & known & (count > 0) & (count < 3)
    at = np.flatnonzero(slide)
    return Slides(at, _projections(normals[at], count[at])), slide


def _normal(points: Floats) -> Floats | None:
    """Return the unit normal (3,) of the plane through points (n, 3), None if they are not in a plane."""
    size = extent_of(points)
    centred = points - points.mean(axis=0)
    values, vectors = symmetric_eigen(product(centred.T, centred))
    normal = vectors[:, 0]
    if values[1] <= (FLAT * size) ** 2 or np.abs(product(centred, normal)).max() > FLAT * size:
        return None
    axis = int(np.argmax(np.abs(normal)))
    if abs(normal[axis]) > 1 - 1e-12:  # exactly a plane of coordinates: those stay bitwise
        normal = np.eye(3)[axis]
    return np.asarray(normal)


def _add_plane(
    nodes: Indices, normal: Floats | None, name: int, normals: Floats, count: Indices, names: Indices
) -> None:  # fmt: skip
    """Add a plane to those of nodes; `count` becomes 3 or more for fixed nodes."""
    if normal is None:
        count[nodes] = 9
        return
    for node in nodes[count[nodes] < 3]:
        same = [k for k in range(count[node]) if abs(product(normals[node, k], normal)) > 1 - _SAME]
        if not same:
            if count[node] < 2:
                normals[node, count[node]] = normal
            count[node] += 1
        elif names[node] != name:
            count[node] = 9
        names[node] = name


def _projections(normals: Floats, count: Indices) -> Floats:
    """Return the projections (k, 3, 3) onto planes with normals (k, 2, 3), or onto lines of two planes."""
    first, second = normals[:, 0], normals[:, 1]
    second = second - (first * second).sum(axis=1)[:, None] * first
    size = norms(second)
    second = np.where((count > 1)[:, None], second / np.where(size > 0, size, 1.0)[:, None], 0.0)
    return np.asarray(np.eye(3) - sum(each[:, :, None] * each[:, None, :] for each in (first, second)))
