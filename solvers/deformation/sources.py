"""Which parts of the outer boundary move, slide or are fixed, and which of its nodes are sources."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, extent_of, norms
from meshonet.solvers.deformation.outer import NodeTable, Piece, elements_of, first_heights

REACH = 0.1  # largest length of a group of nodes, divided by its distance from the moved nodes

CELLS = 2.0  # largest length of a group of nodes, divided by the height of the thinnest cell at the piece


@dataclass(frozen=True, eq=False)
class Sources:
    """Moved, sliding and fixed nodes of the outer boundary of a grid."""

    moved: Bools  # (n,) mask of nodes with prescribed new positions
    areas: Floats  # (n,) lengths or areas assigned to boundary nodes; 0 for nodes that are not sources
    elements: Indices  # edges (m, 2) or quadrilaterals (m, 4) whose nodes are all moved
    sliding: tuple[Piece, ...]  # pieces that are not moved but touch moved nodes: sliding sides
    slides: Bools  # (n,) mask of the nodes of these pieces that belong to no moved or fixed piece

    @property
    def fixed(self) -> Indices:
        """Node indices of fixed sources (see `Field`): they neither move nor slide."""
        return np.flatnonzero((self.areas > 0.0) & ~self.moved & ~self.slides)


def sources_of(table: NodeTable, moved: Bools) -> Sources:
    """Return the boundary nodes from which displacements are interpolated; `moved` (n,) marks moved nodes.

    Far from the moved nodes, one node stands for a group of fixed nodes.
    """
    elements = elements_of(table.pieces, table.nodes.shape[1])
    areas = areas_of(table.nodes, elements)
    stays = [piece for piece in table.pieces if not moved[piece.numbers].all()]
    touching = [piece for piece in stays if piece.patch.name and moved[piece.numbers].any()]
    slides, still = np.zeros(len(moved), dtype=bool), np.zeros(len(moved), dtype=bool)
    for piece in touching:
        slides[piece.numbers.ravel()] = True
    for piece in stays:
        if piece not in touching:
            still[piece.numbers.ravel()] = True
            _group(table, piece, moved, areas)
    slides &= ~moved & ~still
    return Sources(moved, areas, elements[moved[elements].all(axis=1)], tuple(touching), slides)


def areas_of(nodes: Floats, elements: Indices) -> Floats:
    """Return the length or area (n,) that belongs to each node; nodes of an element share it equally."""
    corners = nodes[elements]
    if elements.shape[1] == 2:
        size = norms(corners[:, 1] - corners[:, 0])
    else:
        size = 0.5 * norms(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]))
    each = np.repeat(size / elements.shape[1], elements.shape[1])
    return np.bincount(elements.ravel(), each, len(nodes)).astype(np.float64, copy=False)


def _group(table: NodeTable, piece: Piece, moved: Bools, areas: Floats) -> None:
    """Assign the area of each group of nodes of a piece to its first node, 0 to the others, in place."""
    if piece.patch.kind == "wall":
        return
    nodes = table.nodes[piece.numbers]
    box = np.stack([table.nodes[moved].min(axis=0), table.nodes[moved].max(axis=0)])
    away = norms(nodes - np.clip(nodes, *box)).min()
    size = min(REACH * float(away), CELLS * float(first_heights(table.grid, [piece]).min()))
    if size <= 1e-9 * extent_of(nodes.reshape(-1, nodes.shape[-1])):
        return
    labels: Indices = np.zeros(nodes.shape[:-1], dtype=np.intp)
    for axis in range(nodes.ndim - 1):
        steps = norms(np.diff(nodes, axis=axis))
        longest = steps.max(axis=tuple(k for k in range(steps.ndim) if k != axis))
        group = np.floor(np.concatenate([[0.0], np.cumsum(longest)]) / size).astype(np.intp)
        first = np.cumsum(np.append(True, np.diff(group) > 0)) - 1
        shape = [-1 if k == axis else 1 for k in range(labels.ndim)]
        labels = labels * (int(first[-1]) + 1) + first.reshape(shape)
    _, leading, own = np.unique(labels.ravel(), return_index=True, return_inverse=True)
    numbers = piece.numbers.ravel()
    total = np.bincount(own.ravel(), areas[numbers])
    areas[numbers] = 0.0
    areas[numbers[leading]] = total
