"""Half-edges of quadrilaterals: 4 q + k goes from corner k of quadrilateral q to its next corner.

Its twin is the half-edge on the other side, in the opposite direction if both are oriented alike.
"""

import numpy as np

from meshonet.geometry.arrays import Indices


def ends_of(quads: Indices) -> tuple[Indices, Indices]:
    """Return the first and the last nodes (4 m,) of the half-edges of `quads` (m, 4)."""
    return quads.ravel(), np.roll(quads, -1, axis=1).ravel()


def open_sides(quads: Indices, twin: Indices) -> Indices:
    """Return the corners (k, 4) of the quadrilaterals at open edges; the ends of the open edge come first."""
    opened = np.flatnonzero(twin < 0)
    around = (opened[:, None] % 4 + np.arange(4)) % 4
    return np.asarray(quads[opened[:, None] // 4, around])


def paired(quads: Indices, nodes: int) -> tuple[Indices, Indices]:
    """Return for each half-edge (4 m,) the opposite one, or -1 at open edges; also surplus half-edges.

    A half-edge is an edge of one quad. If three or more meet, all but two of them are surplus.
    """
    first, last = ends_of(quads)
    key = np.minimum(first, last) * nodes + np.maximum(first, last)
    order = np.argsort(key, kind="stable")
    same = key[order[1:]] == key[order[:-1]]
    again = np.append(False, same)
    crowded = order[2:][same[1:] & same[:-1]]
    starts = np.flatnonzero(~again[:-1] & same)
    twin = np.full(len(key), -1)
    twin[order[starts]], twin[order[starts + 1]] = order[starts + 1], order[starts]
    return twin, crowded


def rings(quads: Indices, twin: Indices, nodes: int) -> tuple[Indices, Indices]:
    """Return the neighbours (n, w) of each node in order around it, padded with -1, and their number (n,).

    All `quads` must have the same orientation. A node on an open edge has one neighbour more than it has
    quads; its first and its last neighbour are along open edges.
    """
    first, last = ends_of(quads)
    edges = np.arange(len(first))
    previous = edges - edges % 4 + (edges + 3) % 4
    start = np.full(nodes, -1)
    start[first[::-1]] = edges[::-1]
    opened = edges[twin < 0]
    start[first[opened]] = opened
    table = np.full((nodes, int(np.bincount(first).max()) + 1), -1)
    count = np.zeros(nodes, dtype=np.intp)
    around = np.flatnonzero(start >= 0)
    at = start[around]
    while len(around):
        table[around, count[around]] = last[at]
        count[around] += 1
        into = previous[at]  # the edge on which the quadrilateral's other side reaches the node
        onward = twin[into]
        ended = around[onward < 0]
        table[ended, count[ended]] = first[into[onward < 0]]
        count[ended] += 1
        going = (onward >= 0) & (onward != start[around])
        around, at = around[going], onward[going]
    return table[:, : int(count.max())], count
