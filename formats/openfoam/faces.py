"""All faces of the cells of a grid in OpenFOAM's upper-triangular order.

Interior faces by owner, then neighbour; outer faces follow, patch by patch.
https://doc.openfoam.com/2312/tools/processing/mesh/polyMesh/
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.mesh.cell_faces import cell_numbers
from meshonet.formats.mesh.periodic import NamedFaces, cells_beside
from meshonet.geometry.arrays import Bools
from meshonet.geometry.blocks.block import PLACES, face_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.kernels._native import inner_faces

Labels = NDArray[np.int32]
Indices = NDArray[np.int64]
_LEAST = 3  # smallest number of nodes of a face
MOST_LABELS = 2**31 - 1  # largest label, and largest total number of nodes of all faces, in 32 bits


class Faces(NamedTuple):
    """Faces of cells: first the interior faces, then the boundary faces.

    Parameters
    ----------
    nodes : (f, 4) point numbers; the normal points out of the owner. Consecutive numbers may be equal.
    owner : (f,) cell of each face; at interior faces, the cell with the lower number.
    neighbour : (g,) the other cell of each of the g interior faces.
    """

    nodes: Labels
    owner: Labels
    neighbour: Labels


def all_faces(grid: Grid, numbers: Sequence[Indices], parts: Mapping[str, NamedFaces]) -> Faces:
    """Return the faces of a volume grid with these node `numbers`; `parts` has its boundary faces.

    Raises InputError if there are too many faces for labels of 32 bits, or if a cell is its own neighbour.
    """
    cells = cell_numbers([block.counts for block in grid.blocks])
    count = sum(each.size for each in cells)
    outer = sum(len(part.cells) for part in parts.values())
    inner = (6 * count - outer) // 2
    if 4 * (inner + outer) > MOST_LABELS:
        problem = f"{count} cells have more faces than labels of 32 bits count"
        raise InputError(problem, "write a coarser grid, or blocks of it")
    slack = 6 * max(each.shape[0] for each in cells)
    nodes = np.empty((inner + outer + slack, 4), np.int32)
    owner, neighbour = np.empty(len(nodes), np.int32), np.empty(len(nodes), np.int32)
    at = 0
    beyond = _beyond(grid, cells)
    for number, own, sides in zip(numbers, cells, beyond, strict=True):
        flat = np.ascontiguousarray(number.T, np.int32)
        at += inner_faces(flat, sides, int(own.flat[0]), nodes[at:], owner[at:], neighbour[at:])
    if at != inner:
        problem = "a cell is its own neighbour, across a connection of a block one cell wide"
        raise InputError(problem, "make the grid with more cells around")
    for part in parts.values():
        nodes[at : at + len(part.cells)], owner[at : at + len(part.cells)] = part
        at += len(part.cells)
    return Faces(nodes[:at], owner[:at], neighbour[:inner])


def whole(nodes: NDArray[np.integer[Any]]) -> Bools:
    """Return a mask (f,) of the faces (f, 4) that are not degenerate to an edge or a point."""
    several = (nodes != np.roll(nodes, -1, axis=1)).sum(axis=1) >= _LEAST
    return np.asarray(several & (nodes[:, 0] != nodes[:, 2]) & (nodes[:, 1] != nodes[:, 3]))


def without_collapsed(faces: Faces, parts: Mapping[str, NamedFaces]) -> tuple[Faces, dict[str, NamedFaces]]:
    """Return faces and boundary parts without degenerate faces; parts that become empty are left out."""
    keep, inner = whole(faces.nodes), len(faces.neighbour)
    kept = {name: (part, whole(part.faces)) for name, part in parts.items()}
    left = Faces(faces.nodes[keep], faces.owner[keep], faces.neighbour[keep[:inner]])
    return left, {name: NamedFaces(p.faces[at], p.cells[at]) for name, (p, at) in kept.items() if at.any()}


def _beyond(grid: Grid, cells: Sequence[Indices]) -> list[list[Labels]]:
    """Return the neighbour at each face of each block's sides, -1 at the boundary, first index fastest."""
    table = [[np.full(face_of(own, side).shape, -1) for side in PLACES] for own in cells]
    sides = list(PLACES)
    for each in grid.connections:
        if each.transform is None:
            for way in (each, each.reversed()):
                _, donor = cells_beside(way, cells)
                part = tuple(slice(*span) for span in way.range)
                table[way.block][sides.index(way.side)][part] = donor
    return [[np.ascontiguousarray(side.T, np.int32) for side in block] for block in table]
