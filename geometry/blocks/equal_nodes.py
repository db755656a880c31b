"""Nodes of connected sides made equal to the last bit, as a grid has to have them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import Block, face_of
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.shared_nodes import joined_labels
from meshonet.geometry.polygon.corners import Indices

_PASSES = 9
"""Periodic sides that end on other ones need one more pass each."""


def with_equal_nodes(blocks: Sequence[Block], connections: Sequence[Connection]) -> tuple[Block, ...]:
    """Return `blocks` with the nodes that `connections` join made equal, bitwise.

    Joined nodes become the first of them; those of the second of two periodic sides the first ones moved.
    """
    if not connections:
        return tuple(blocks)
    ends = np.cumsum([0, *(int(np.prod(block.counts)) for block in blocks)])
    used, pairs = _pairs(blocks, connections, ends)
    shared = np.empty((len(used), blocks[0].nodes.shape[-1]))
    places = []
    for block, first, last in zip(blocks, ends, ends[1:], strict=False):
        rows = slice(*np.searchsorted(used, [first, last]))
        places.append((rows, np.unravel_index(used[rows] - first, block.counts)))
        shared[rows] = block.nodes[places[-1][1]]
    equal = _equal(shared, pairs, connections)
    result = []
    for block, (rows, at) in zip(blocks, places, strict=True):
        if np.array_equal(equal[rows], shared[rows]):
            result.append(block)
            continue
        nodes = block.nodes.copy(order="K")
        nodes[at] = equal[rows]
        result.append(Block(nodes, finite=True))
    return tuple(result)


def _pairs(
    blocks: Sequence[Block], connections: Sequence[Connection], ends: Indices
) -> tuple[Indices, list[tuple[Indices, Indices]]]:
    """Return the joined nodes, counted through all blocks, and of each connection pairs of places in them."""
    counts = [block.counts for block in blocks]
    numbers = [np.arange(a, b).reshape(n) for a, b, n in zip(ends, ends[1:], counts, strict=False)]

    def face(block: int, side: Side) -> Indices:
        return np.asarray(face_of(numbers[block], side)[..., None])

    plain = [replace(each, transform=None).nodes(face) for each in connections]
    flat = [nodes.ravel() for pair in plain for nodes in pair]
    used, where = np.unique(np.concatenate(flat), return_inverse=True)
    parts = np.split(where.ravel(), np.cumsum([len(nodes) for nodes in flat])[:-1])
    return used, list(zip(parts[0::2], parts[1::2], strict=True))


def _equal(
    nodes: Floats, pairs: Sequence[tuple[Indices, Indices]], connections: Sequence[Connection]
) -> Floats:
    """Return `nodes` (n, d), each as the first of those that it is joined to, directly or through others."""
    fixed = [pair for pair, each in zip(pairs, connections, strict=True) if each.transform is None]
    label = joined_labels(len(nodes), fixed)
    nodes = nodes[label]
    for _ in range(_PASSES):
        old = nodes.copy()
        for (own, donor), each in zip(pairs, connections, strict=True):
            if each.transform is not None:
                nodes[label[donor]] = each.transform(nodes[own])
                nodes = nodes[label]
        if np.array_equal(nodes, old):
            break
    return nodes
