"""A structured grid as an unstructured one: seams merged, cells and named faces by node number.

The nodes of all blocks make one table, in which those that connections say are the same stand once. Nothing
else is merged: two walls that touch stay two.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.mesh.cell_faces import cells_of
from meshonet.formats.mesh.periodic import PeriodicPair, outer_parts
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.shared_nodes import shared_nodes

Indices: TypeAlias = NDArray[np.int64]
CELLS = {2: "line", 4: "quad", 8: "hexahedron"}
"""meshio's names of cells by their count of nodes."""


@dataclass(frozen=True)
class Unstructured:
    """Nodes without doubles, quadrilaterals or hexahedra, and the named boundary.

    Parameters
    ----------
    points : (n, 2 or 3), unit of the grid.
    cells : (m, 4) node numbers, counter-clockwise for a right-handed grid, or (m, 8), those of the bottom so
        and then those above them; i fastest.
    faces : of each named part (k, 2) edges with the domain on their left, or (k, 4) quadrilaterals whose
        normals point out of it; periodic ones last.
    periodic : pairs of names among `faces` whose rows face each other.
    """

    points: Floats
    cells: Indices
    faces: dict[str, Indices]
    periodic: tuple[PeriodicPair, ...] = ()


def unstructured(grid: Grid) -> Unstructured:
    """Return `grid`, all of whose blocks have the same count of directions, with connected nodes merged.

    Faces inside the domain (interfaces, the cut, the wake) belong to no part; an outer one that nobody named
    is called by its side.
    """
    numbers = node_numbers(grid)
    parts, pairs = outer_parts(grid, numbers)
    cells = np.concatenate([cells_of(number) for number in numbers])
    faces = {name: part.faces for name, part in parts.items()}
    return Unstructured(points_of(grid, numbers), cells, faces, pairs)


def points_of(grid: Grid, numbers: Sequence[Indices]) -> Floats:
    """Return the nodes (n, d) of a grid whose nodes have these numbers, each once."""
    count = 1 + max(int(number.max()) for number in numbers)
    points = np.empty((count, grid.blocks[0].nodes.shape[-1]))
    for number, block in zip(numbers, grid.blocks, strict=True):
        points[number] = block.nodes
    return points


def with_z(points: Floats) -> Floats:
    """Return points (n, 2) in the plane z = 0, those of (n, 3) as they are."""
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def node_numbers(grid: Grid) -> list[Indices]:
    """Return the number of every node (ni, nj) or (ni, nj, nk) of each block; nodes that are one share it.

    Numbers ascend from 0 without gaps in the order of blocks, i fastest.
    """
    labels = shared_nodes([block.counts for block in grid.blocks], grid.connections)
    flat = np.concatenate([label.ravel(order="F") for label in labels])
    places = np.arange(len(flat))
    first = np.empty(len(flat), dtype=np.int64)
    first[flat[::-1]] = places[::-1]  # of those that are one, the first is written last
    begins = flat[first[flat] == places]
    rank = np.empty(len(flat), dtype=np.int64)
    rank[begins] = np.arange(len(begins))
    parts = np.split(rank[flat], np.cumsum([label.size for label in labels])[:-1])
    return [part.reshape(label.shape, order="F") for part, label in zip(parts, labels, strict=True)]
