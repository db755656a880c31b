"""Connections of sides of blocks that share node numbers: first whole sides, then parts of sides."""

from itertools import groupby
from operator import itemgetter
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Indices, Side
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.motion import Motion

Line: TypeAlias = tuple[int, Side, Indices]
"""Number of a block, one of its sides, and the node numbers along this side."""


def shared(lines: list[Line]) -> tuple[list[Connection], list[Line]]:
    """Return the connections between block sides (`lines`) with the same nodes, and the unmatched sides."""
    waiting: dict[tuple[int, ...], Line] = {}
    connections = []
    for line in lines:
        key = key_of(line[2])
        if key in waiting:
            connections.append(connection_of(waiting.pop(key), line))
        else:
            waiting[key] = line
    return connections, list(waiting.values())


def key_of(nodes: Indices) -> tuple[int, ...]:
    """Return a key for the nodes of a line that is the same for both directions."""
    line = tuple(nodes.tolist())
    return min(line, line[::-1])


def connection_of(
    own: Line, donor: Line, transform: Motion | None = None, at: tuple[int, int] = (0, 0)
) -> Connection:
    """Return the connection of two block sides with the same nodes, in the same or in opposite order.

    For parts of sides, `at` gives the index of the first node of each part in its side.
    """
    (block, side, nodes), (other, other_side, others) = own, donor
    begin, end = (((first, first + len(nodes) - 1),) for first in at)
    same = int(nodes[0]) == int(others[0]) and int(nodes[1]) == int(others[1])
    return Connection(block, side, begin, other, other_side, end, (1 if same else -1,), transform)


def shared_in_part(lines: list[Line]) -> tuple[list[Connection], list[tuple[Line, int]]]:
    """Return connections of parts of block sides, and unconnected parts with their first index on a side."""
    if not lines:
        return [], []
    edges = np.concatenate([np.sort([nodes[:-1], nodes[1:]], axis=0) for _, _, nodes in lines], axis=1)
    if len(np.unique(edges[0] * (edges.max() + 1) + edges[1])) == edges.shape[1]:  # as is most often so
        return [], [(line, 0) for line in lines]
    places: dict[tuple[int, ...], list[tuple[int, int]]] = {}
    for number, (_, _, nodes) in enumerate(lines):
        for cell in range(len(nodes) - 1):
            places.setdefault(key_of(nodes[cell : cell + 2]), []).append((number, cell))
    connections, alone = [], []
    for number, (block, side, nodes) in enumerate(lines):
        met = []
        for k in range(len(nodes) - 1):
            edge = nodes[k : k + 2]
            other, cell = next((at for at in places[key_of(edge)] if at != (number, k)), (-1, 0))
            alike = bool((lines[other][2][cell : cell + 2] == edge).all())
            step = 0 if other < 0 else cell - k if alike else cell + k
            met.append((cell, (other, (number, k) < (other, cell), step)))
        start = 0
        for (other, ahead, _), run in groupby(met, key=itemgetter(1)):
            beside = [cell for cell, _ in run]
            own: Line = (block, side, nodes[start : start + len(beside) + 1])
            if other < 0:
                alone.append((own, start))
            elif ahead:
                first, (donor, donor_side, others) = min(beside), lines[other]
                part = (donor, donor_side, others[first : first + len(beside) + 1])
                connections.append(connection_of(own, part, at=(start, first)))
            start += len(beside)
    return connections, alone
