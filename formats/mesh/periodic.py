"""The periodic sides of a grid as pairs of named edges that face each other, row by row.

::

    name      a ---> b        own edges, the domain on their left
                                  + motion
    partner   b' <-- a'       row k of the one goes with row k of the other, the other way round
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from meshonet.formats.mesh.names import unused
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.connection import Connection, Motion
from meshonet.geometry.blocks.find_connections import AROUND
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.polygon.corners import Indices

_WAYS = dict(AROUND)
_SAME = 1e-9
"""Motions are the same when they differ by no more, shifts as part of their size."""


class PeriodicPair(NamedTuple):
    """Edges (k, 2) of node numbers under a name, and those of the partner, to which `motion` carries them."""

    name: str
    partner: str
    motion: Motion
    edges: Indices
    partner_edges: Indices

    @property
    def nodes(self) -> Indices:
        """(n, 2) each node of the first side and its partner, once."""
        rows = np.stack([self.edges.ravel(), self.partner_edges[:, ::-1].ravel()], axis=1)
        return np.asarray(np.unique(rows, axis=0))


def periodic_pairs(grid: Grid, numbers: Sequence[Indices], taken: Iterable[str]) -> list[PeriodicPair]:
    """Return the pairs of periodic sides of planar blocks whose nodes have `numbers` (ni, nj) each.

    Connections of one motion and one pair of names make one pair; without names they are called periodic1 and
    periodic2, and so on, and never as those `taken` by other edges.
    """
    motions: list[Motion] = []
    found: dict[tuple[int, str, str], list[tuple[Indices, Indices]]] = {}
    for connection in grid.connections:
        if connection.transform is None:
            continue
        number, backwards = _known(connection.transform, motions)
        edges = _edges(connection, numbers)
        names = _name(grid, connection), _name(grid, connection.reversed())
        if backwards:
            edges, names = edges[::-1], names[::-1]
        found.setdefault((number, *names), []).append(edges)
    pairs, used = [], set(taken)
    for count, ((number, *both), edges_of) in enumerate(found.items()):
        own, partner = (np.concatenate(rows) for rows in zip(*edges_of, strict=True))
        titles = []
        for k, name in enumerate(both, start=1):
            plain = f"{name}{k}" if both[0] == both[1] and name else name
            titles.append(unused(plain or f"periodic{2 * count + k}", used))
            used.add(titles[-1])
        pairs.append(PeriodicPair(titles[0], titles[1], motions[number], own, partner))
    return pairs


def _known(motion: Motion, motions: list[Motion]) -> tuple[int, bool]:
    """Return the number of a motion among those known, which it may join, and whether it goes back there."""
    for number, known in enumerate(motions):
        for backwards, like in ((False, motion), (True, motion.inverse())):
            if known.alike(like, _SAME):
                return number, backwards
    motions.append(motion)
    return len(motions) - 1, False


def _edges(connection: Connection, numbers: Sequence[Indices]) -> tuple[Indices, Indices]:
    """Return the edges (k, 2) of both sides, each with the domain on its left."""
    plain = replace(connection, transform=None)
    own, donor = (nodes[:, 0] for nodes in plain.nodes(lambda b, side: face_of(numbers[b][..., None], side)))
    if _WAYS[connection.side] < 0:
        own, donor = own[::-1], donor[::-1]
    return np.stack([own[:-1], own[1:]], axis=1), np.stack([donor[1:], donor[:-1]], axis=1)


def _name(grid: Grid, connection: Connection) -> str:
    """Return the name that all patches on the first side of a connection share, if they cover it."""
    ((first, last),) = connection.range
    owners = [""] * (last - first)
    for patch in grid.patches:
        if (patch.block, patch.side) == (connection.block, connection.side):
            start, stop = max(patch.start - first, 0), max(min(patch.stop - first, last - first), 0)
            owners[start:stop] = [patch.name] * max(stop - start, 0)
    return owners[0] if len(set(owners)) == 1 else ""
