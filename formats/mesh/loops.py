"""Closed curves out of edges in any order and direction, with the name that each edge has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from meshonet.formats.mesh.unstructured import Indices
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError


@dataclass(frozen=True)
class Loop:
    """A closed curve.

    Parameters
    ----------
    nodes : (n,) point numbers, in order; the last one is joined to the first.
    names : (n,) name of the edge behind each.
    """

    nodes: Indices
    names: tuple[str, ...]

    def reversed(self) -> Loop:
        """Return it the other way round, from the same point."""
        return Loop(np.roll(self.nodes[::-1], 1), self.names[::-1])

    def begun_at(self, place: int) -> Loop:
        """Return it from its node number `place` on."""
        return Loop(np.roll(self.nodes, -place), (*self.names[place:], *self.names[:place]))

    @property
    def changes(self) -> list[int]:
        """Places where the name changes."""
        return [k for k in range(len(self.names)) if self.names[k] != self.names[k - 1]]


def closed_loops(edges: Mapping[str, Indices], points: Floats) -> list[Loop]:
    """Return the closed curves of named edges, each from its first edge on and in its direction.

    Parameters
    ----------
    edges : (k, 2) point numbers by name.
    points : (n, 2), for messages.

    Raises InputError: a point where one edge ends, or more than two meet.
    """
    ends = np.concatenate([np.empty((0, 2), np.int64), *edges.values()])
    names = [name for name, rows in edges.items() for _ in range(len(rows))]
    met = np.bincount(ends.ravel(), minlength=len(points))
    for node in np.flatnonzero((met != 0) & (met != 2))[:1]:
        x, y = points[node]
        problem = "one edge ends" if met[node] == 1 else f"{met[node]} edges meet"
        raise InputError(
            f"{problem} at ({x:.6g}, {y:.6g})",
            "the boundary has to consist of closed curves",
            place="boundary",
        )
    order = np.argsort(ends.ravel(), kind="stable")
    twin = np.empty(len(order), np.int64)  # the other place where the same point stands
    twin[order[0::2]], twin[order[1::2]] = order[1::2], order[0::2]
    return _followed(ends.ravel().tolist(), twin.tolist(), names)


def _followed(flat: list[int], twin: list[int], names: list[str]) -> list[Loop]:
    loops, used = [], [False] * len(names)
    for first in range(len(names)):
        if used[first]:
            continue
        nodes, own, at = [], [], 2 * first  # a place in `flat`; the edge goes from there to its partner
        while not used[at // 2]:
            used[at // 2] = True
            nodes.append(flat[at])
            own.append(names[at // 2])
            at = twin[at ^ 1]
        loops.append(Loop(np.array(nodes, np.int64), tuple(own)))
    return loops
