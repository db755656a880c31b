"""A structured grid as an unstructured one: seams merged, cells and named edges by node number.

The nodes of all blocks make one table, in which those that connections say are the same stand once. Nothing
else is merged: two walls that touch stay two.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.mesh.periodic import PeriodicPair, periodic_pairs
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.shared_nodes import shared_nodes

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
    edges : (k, 2) node numbers of each named part, the domain on the left; periodic ones last.
    periodic : pairs of names among `edges` whose rows face each other.
    """

    points: Floats
    quads: Indices
    edges: dict[str, Indices]
    periodic: tuple[PeriodicPair, ...] = ()


def unstructured(grid: Grid) -> Unstructured:
    """Return planar `grid` with the nodes of connected sides merged.

    Edges inside the domain (interfaces, the cut, the wake) belong to no part; an outer edge that nobody named
    is called by its side.
    """
    numbers = node_numbers(grid)
    flat = np.concatenate([number.ravel(order="F") for number in numbers])
    _, first = np.unique(flat, return_index=True)
    nodes = [np.stack([b.nodes[..., k].ravel(order="F") for k in (0, 1)], axis=-1) for b in grid.blocks]
    quads = [
        np.stack(
            [part.ravel(order="F") for part in (n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:])], axis=-1
        )
        for n in numbers
    ]
    edges = _edges(grid, numbers)
    pairs = tuple(periodic_pairs(grid, numbers, edges))
    for pair in pairs:
        edges |= {pair.name: pair.edges, pair.partner: pair.partner_edges}
    return Unstructured(np.concatenate(nodes)[first], np.concatenate(quads), edges, pairs)


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


def periodic_nodes(pair: PeriodicPair, mesh: Unstructured, planes: int) -> Indices:
    """Return (n, 2) the nodes of a periodic side and their partners, on all planes of an extruded `mesh`."""
    return _repeated(pair.nodes, max(planes, 1), len(mesh.points))


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


def node_numbers(grid: Grid) -> list[Indices]:
    """Return the number (ni, nj) of every node of every block, the same for nodes that are one.

    Numbers ascend from 0 without gaps in the order of blocks, i fastest.
    """
    labels = shared_nodes([block.counts for block in grid.blocks], grid.connections)
    flat = np.concatenate([label.ravel(order="F") for label in labels])
    _, first, which = np.unique(flat, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    ends = np.cumsum([label.size for label in labels])[:-1]
    parts = np.split(rank[which.ravel()], ends)
    return [part.reshape(label.shape, order="F") for part, label in zip(parts, labels, strict=True)]


def _edges(grid: Grid, numbers: Sequence[Indices]) -> dict[str, Indices]:
    """Return the outer edges by part, without those of connections."""
    edges: dict[str, list[Indices]] = {}
    for patch in grid.outer_patches():
        number = numbers[patch.block]
        line = face_of(number, patch.side)[patch.start : patch.stop + 1]
        rows = np.stack([line[:-1], line[1:]], axis=-1)
        backwards = patch.side in ("north", "west")  # the domain is on the left of a side's other direction
        edges.setdefault(patch.name, []).append(rows[:, ::-1] if backwards else rows)
    return {name: np.concatenate(pieces) for name, pieces in edges.items()}
