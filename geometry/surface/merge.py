"""One table of nodes for patches whose sides meet: edge nodes in the same position are one node."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, extent_of
from meshonet.geometry.blocks.shared_nodes import joined_labels
from meshonet.geometry.elementary import product

TOLERANCE = 1e-8  # edge nodes nearer than this fraction of the surface's size are one node
SLANT = np.array([0.5257311, 0.6513887, 0.5470973])
"""Direction along which points are sorted; along an oblique one few distant points are equal."""


def near_pairs(points: Floats, distance: float) -> Indices:
    """Return the pairs (m, 2) of `points` (n, 3) within `distance` along each axis, lower index first."""
    along = product(points, SLANT)
    order = np.argsort(along, kind="stable")
    along, window = along[order], distance * float(SLANT.sum()) * (1.0 + 1e-12)
    pairs = [np.empty((0, 2), dtype=np.intp)]
    for gap in range(1, len(points)):
        near = np.flatnonzero(along[gap:] - along[:-gap] <= window)
        if not len(near):
            break
        first, second = order[near], order[near + gap]
        close = (np.abs(points[first] - points[second]) <= distance).all(axis=1)
        both = np.stack([first[close], second[close]], axis=1)
        pairs.append(np.sort(both, axis=1))
    return np.concatenate(pairs)


def merged(patches: Sequence[Floats]) -> tuple[Floats, tuple[Indices, ...]]:
    """Return all nodes (n, 3) of `patches` (ni, nj, 3), and for each patch the indices (ni, nj) of its nodes.

    On edges, nodes that are closer than `TOLERANCE` times the size of the surface are replaced by the first
    of them.
    """
    points = np.concatenate([np.ascontiguousarray(patch).reshape(-1, 3) for patch in patches])
    edges = [
        np.pad(np.zeros([n - 2 for n in patch.shape[:2]], bool), 1, constant_values=True) for patch in patches
    ]
    on_edge = np.flatnonzero(np.concatenate([edge.ravel() for edge in edges]))
    pairs = on_edge[near_pairs(points[on_edge], TOLERANCE * extent_of(points))]
    numbers = joined_labels(len(points), [(pairs[:, 0], pairs[:, 1])])
    kept = np.unique(numbers, return_index=True)[1]
    ends = np.cumsum([0, *(patch.shape[0] * patch.shape[1] for patch in patches)])
    lattices = tuple(
        numbers[start:end].reshape(patch.shape[:2])
        for start, end, patch in zip(ends, ends[1:], patches, strict=False)
    )
    return points[kept], lattices
