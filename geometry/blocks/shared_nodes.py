"""Global node numbers of a multi-block grid: nodes that connections join have the same number.

::

    block 0       block 1          numbers
    +--+--+       +--+--+          0--2--4--6--8
    |  |  |   +   |  |  |     ->   |  |  |  |  |
    +--+--+       +--+--+          1--3--5--7--9
         east = west
"""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.kernels._native import joined_classes

_PASSES = 9  # periodic sides that end on other periodic sides need one more pass each


def shared_nodes(
    counts: Sequence[tuple[int, ...]], connections: Sequence[Connection], *, periodic: bool = False,
    order: Literal["C", "F"] = "C",
) -> tuple[Indices, ...]:  # fmt: skip
    """Return arrays of the global numbers, from 0, of the nodes of blocks with `counts` nodes per direction.

    Nodes that connections join, directly or through other nodes, have the same number. Numbers ascend from
    block to block. Within a block, the last index varies fastest or, if `order` is F, the first index.
    Unless `periodic`, the two sides of a periodic connection have separate numbers.
    """
    ends, numbers = numbered(counts, order)
    joined = [each.pairs(numbers) for each in connections if periodic or each.transform is None]
    if not joined:
        return tuple(numbers)
    label = joined_labels(int(ends[-1]), joined)
    return tuple(label[number] for number in numbers)


def numbered(
    counts: Sequence[tuple[int, ...]], order: Literal["C", "F"] = "C"
) -> tuple[Indices, list[Indices]]:
    """Return the first node number of each block, followed by the total; and the node numbers of each block.

    Nodes are numbered block after block. Nodes that blocks share have a number in each block.
    """
    ends = np.cumsum([0, *(int(np.prod(count)) for count in counts)])
    parts = zip(ends, ends[1:], counts, strict=False)
    return ends, [np.arange(a, b).reshape(n, order=order) for a, b, n in parts]


def node_table(
    blocks: Sequence[Block], connections: Sequence[Connection]
) -> tuple[Floats, tuple[Indices, ...]]:
    """Return the nodes (n, d) of all blocks, shared ones once, and per block the indices of its nodes."""
    numbers = shared_nodes([block.counts for block in blocks], connections)
    if len(blocks) == 1 and not connections:
        return np.ascontiguousarray(blocks[0].nodes.reshape(-1, blocks[0].nodes.shape[-1])), numbers
    nodes = np.empty((1 + max(int(number.max()) for number in numbers), blocks[0].nodes.shape[-1]))
    for number, block in zip(numbers, blocks, strict=True):
        nodes[number] = block.nodes
    return nodes, numbers


def joined_labels(count: int, pairs: Sequence[tuple[Indices, Indices]]) -> Indices:
    """Return labels (count,) of nodes, numbered from 0 in the order of the nodes.

    Nodes that `pairs` join, directly or through other nodes, have the same label.
    """
    rows = [np.stack([own.ravel(), donor.ravel()], axis=1) for own, donor in pairs]
    label, _ = joined_classes(np.concatenate([np.empty((0, 2), np.intp), *rows]), count)
    return label


def with_equal_nodes(blocks: Sequence[Block], connections: Sequence[Connection]) -> tuple[Block, ...]:
    """Return `blocks` in which the nodes that `connections` join are bitwise equal.

    Joined nodes get the coordinates of the first of them. The nodes of the second side of a periodic pair
    become the nodes of the first side, moved by the periodic motion.
    """
    if not connections:
        return tuple(blocks)
    ends, numbers = numbered([block.counts for block in blocks])
    flat = [nodes.ravel() for each in connections for nodes in each.pairs(numbers)]
    used, where = np.unique(np.concatenate(flat), return_inverse=True)
    parts = np.split(where.ravel(), np.cumsum([len(nodes) for nodes in flat])[:-1])
    pairs = list(zip(parts[0::2], parts[1::2], strict=True))
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
    """Return `nodes` (n, d), each equal to the first that it is joined to, directly or through others."""
    fixed = [pair for pair, each in zip(pairs, connections, strict=True) if each.transform is None]
    label = joined_labels(len(nodes), fixed)
    first = np.unique(label, return_index=True)[1][label]
    nodes = nodes[first]
    for _ in range(_PASSES):
        old = nodes.copy()
        for (own, donor), each in zip(pairs, connections, strict=True):
            if each.transform is not None:
                nodes[first[donor]] = each.transform(nodes[own])
                nodes = nodes[first]
        if np.array_equal(nodes, old):
            break
    return nodes
