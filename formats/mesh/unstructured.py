"""A structured grid as an unstructured mesh: merged seams, cells and named faces by node number.

Only connected nodes are merged: two walls that touch keep their own nodes.
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
CELLS = {2: "line", 4: "quad", 8: "hexahedron"}  # meshio's names of cells by their number of nodes


@dataclass(frozen=True)
class Unstructured:
    """Nodes without duplicates, their quadrilaterals or hexahedra, and the named boundary faces.

    Parameters
    ----------
    points : (n, 2 or 3), in the unit of the grid.
    cells : (m, 4) or (m, 8) node numbers of each cell in the order of VTK; cells block by block, i fastest.
    faces : for each name, (k, 2) edges or (k, 4) quadrilaterals (`faces_of`); periodic ones are last.
    periodic : pairs of periodic boundaries.
    """

    points: Floats
    cells: Indices
    faces: dict[str, Indices]
    periodic: tuple[PeriodicPair, ...] = ()


def unstructured(grid: Grid) -> Unstructured:
    """Return `grid` as an unstructured mesh with merged nodes; all blocks must have the same dimension.

    Only outer faces belong to the boundary. Unnamed faces get the name of their side.
    """
    numbers = node_numbers(grid)
    parts, pairs = outer_parts(grid, numbers)
    cells = np.concatenate([cells_of(number) for number in numbers])
    faces = {name: part.faces for name, part in parts.items()}
    return Unstructured(points_of(grid, numbers), cells, faces, pairs)


def points_of(grid: Grid, numbers: Sequence[Indices]) -> Floats:
    """Return points (n, d) such that ``points[numbers[b]]`` are the nodes of block b."""
    count = 1 + max(int(number.max()) for number in numbers)
    points = np.empty((count, grid.blocks[0].nodes.shape[-1]))
    for number, block in zip(numbers, grid.blocks, strict=True):
        points[number] = block.nodes
    return points


def with_z(points: Floats) -> Floats:
    """Return points (n, 2) with z = 0 added; points (n, 3) are returned unchanged."""
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def node_numbers(grid: Grid) -> list[Indices]:
    """Return the node numbers (ni, nj[, nk]) of each block; connected nodes share a number.

    Numbers start at 0, have no gaps and ascend from block to block; i varies fastest.
    """
    counts = [block.counts for block in grid.blocks]
    return list(shared_nodes(counts, grid.connections, order="F"))
