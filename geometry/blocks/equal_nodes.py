"""Nodes of connected sides made bitwise equal, as a grid requires."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.shared_nodes import joined_labels, numbered, places_among
from meshonet.geometry.polygon.corners import Indices

_PASSES = 9
"""Periodic sides that end on other ones need one more pass each."""


def with_equal_nodes(blocks: Sequence[Block], connections: Sequence[Connection]) -> tuple[Block, ...]:
    """Return `blocks` with the nodes that `connections` join made equal, bitwise.

    Joined nodes become the first of them; those of the second of two periodic sides the first ones moved.
    """
    if not connections:
        return tuple(blocks)
    ends, numbers = numbered([block.counts for block in blocks])
    used, pairs = places_among([each.pairs(numbers) for each in connections])
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
