"""A structured grid as an unstructured one: seams merged, cells and named edges by node number."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.grid import Grid

Indices: TypeAlias = NDArray[np.int64]
CELLS = {2: "line", 4: "quad", 8: "hexahedron"}
"""meshio's names of cells by their count of nodes."""


@dataclass(frozen=True)
class Unstructured:
    """Nodes without doubles, quadrilaterals and the named boundary.

    Parameters
    ----------
    points : (n, 2), unit of the grid.
    quads : (m, 4) node numbers, counter-clockwise for a right-handed grid, i fastest.
    edges : (k, 2) node numbers of each named part, the domain on the left.
    """

    points: Floats
    quads: Indices
    edges: dict[str, Indices]


def unstructured(grid: Grid) -> Unstructured:
    """Return `grid` with the nodes along its O cut or C wake merged.

    Edges inside the domain (the cut, the wake) belong to no part; an outer edge that nobody named is
    called by its side.
    """
    number = node_numbers(grid)
    used, first = np.unique(number.ravel(order="F"), return_index=True)
    number = np.searchsorted(used, number)
    points = np.stack([grid.x.ravel(order="F")[first], grid.y.ravel(order="F")[first]], axis=-1)
    corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    quads = np.stack([corner.ravel(order="F") for corner in corners], axis=-1)
    return Unstructured(points, quads, _edges(grid, number))


def extruded(mesh: Unstructured, heights: Sequence[float]) -> tuple[Floats, dict[str, Indices], Indices]:
    """Return points (kn, 3), outward faces by name, hexahedra (m, 8) of layers between k planes in z.

    Layer by layer; the outermost planes are the faces ``back`` (the first height) and ``front``. Without
    heights, the points (n, 2), edges and quadrilaterals as they are.
    """
    if not heights:
        return mesh.points, mesh.edges, mesh.quads
    count, layers = len(mesh.points), len(heights) - 1
    columns = np.concatenate([mesh.quads, mesh.quads + count], axis=1)
    sides = {name: np.column_stack([edges, edges[:, ::-1] + count]) for name, edges in mesh.edges.items()}
    faces = {name: _repeated(rows, layers, count) for name, rows in sides.items()}
    faces["back"], faces["front"] = mesh.quads[:, ::-1], mesh.quads + layers * count
    return layer_points(mesh, heights), faces, _repeated(columns, layers, count)


def in_space(points: Floats) -> Floats:
    """Return points (n, 2) in the plane z = 0, those of (n, 3) as they are."""
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def layer_points(mesh: Unstructured, heights: Sequence[float]) -> Floats:
    """Return the points (kn, 3) of k planes: those at the first height, then those at the next."""
    planes = [np.column_stack([mesh.points, np.full(len(mesh.points), z)]) for z in heights]
    return np.concatenate(planes)


def _repeated(rows: Indices, layers: int, count: int) -> Indices:
    """Return node numbers (n, m) for every layer, `count` nodes a plane."""
    return np.concatenate([rows + layer * count for layer in range(layers)])


def node_numbers(grid: Grid) -> Indices:
    """Return a number (ni, nj) for every node, i fastest, the same for nodes that are one."""
    ni, nj = grid.ni, grid.nj
    number = np.arange(ni * nj, dtype=np.int64).reshape((ni, nj), order="F")
    for connection in grid.connections:
        own, donor = connection.nodes(lambda _block, side: face_of(number[..., None], side))
        donor[...] = own
    return number


def _edges(grid: Grid, number: Indices) -> dict[str, Indices]:
    """Return the outer edges by part, without those of the cut."""
    sides: dict[Side, Indices] = {
        "south": np.stack([number[:-1, 0], number[1:, 0]], axis=-1),
        "east": np.stack([number[-1, :-1], number[-1, 1:]], axis=-1),
        "north": np.stack([number[1:, -1], number[:-1, -1]], axis=-1),
        "west": np.stack([number[0, 1:], number[0, :-1]], axis=-1),
    }
    edges: dict[str, list[Indices]] = {}
    for patch in grid.outer_patches():
        edges.setdefault(patch.name, []).append(sides[patch.side][patch.start : patch.stop])
    return {name: np.concatenate(pieces) for name, pieces in edges.items()}
