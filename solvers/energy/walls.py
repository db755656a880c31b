"""Wall nodes of a quad mesh as unknowns: which slide on which loop, in which order, how far the loop turns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices

LEAST_GAP = 0.05
"""Of the mean distance of wall nodes between two that stay: nodes out of order are put that far apart."""
_SAMPLES = np.linspace(0.0, 1.0, 9)

Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Walls:
    """The nodes on loops, by loop, and the edges between them in the direction of the loop."""

    nodes: Indices
    loop: Indices
    arc: Floats
    """Arc lengths (w,), those of a loop not beyond its length."""
    edges: Indices
    """(e, 2), numbers of wall nodes."""
    round: Floats
    """(e,) what the second's arc length lacks: 0 or the length of the loop."""

    def range_of(self, loop: int) -> tuple[int, int, int, int]:
        """Return the first and last (not included) node and edge of a loop."""
        of_edge = self.loop[self.edges[:, 0]]
        n = [int(k) for k in np.searchsorted(self.loop, [loop, loop + 1])]
        e = [int(k) for k in np.searchsorted(of_edge, [loop, loop + 1])]
        return n[0], n[1], e[0], e[1]


def walls_of(mesh: QuadMesh, edges: Indices, edge_of: Indices, fixed: Bools, tied: Bools) -> Walls | None:
    """Return the walls of a mesh, nodes that overtook others put back; None where nodes that stay are out of order.

    `fixed` (n,) are nodes that stay, `tied` (n,) those of periodic sides, which are no walls.
    """
    places = mesh.places
    on = (places.loop >= 0) & ~tied
    nodes = np.flatnonzero(on)
    nodes = nodes[np.argsort(places.loop[nodes], kind="stable")]
    loop = places.loop[nodes]
    lengths = np.array([each.length for each in mesh.domain.loops])
    arc = np.mod(places.arc[nodes], lengths[loop])
    number = np.full(len(mesh.nodes), -1, dtype=np.intp)
    number[nodes] = np.arange(len(nodes))
    once = np.bincount(edge_of.ravel(), minlength=len(edges))[edge_of] == 1
    cell, side = np.nonzero(once)
    ends = np.stack([mesh.quads[cell, side], mesh.quads[cell, (side + 1) % 4]], axis=1)
    first, second = number[ends[:, 0]], number[ends[:, 1]]
    both = (first >= 0) & (second >= 0)
    first, second = first[both], second[both]
    same = loop[first] == loop[second]
    first, second = first[same], second[same]
    order = np.argsort(loop[first], kind="stable")
    pairs = np.stack([first[order], second[order]], axis=1)
    length = lengths[loop[pairs[:, 0]]]
    arc, ok = _in_order(arc, pairs, length, fixed[nodes])
    if not ok:
        return None
    lacks = np.where(arc[pairs[:, 1]] <= arc[pairs[:, 0]], length, 0.0)
    return Walls(nodes, loop, arc, pairs, lacks)


def _in_order(arc: Floats, edges: Indices, length: Floats, fixed: Bools) -> tuple[Floats, bool]:
    """Return arc lengths (w,) that rise along the `edges` (e, 2) of each loop, and whether there are such."""
    gap = arc[edges[:, 1]] - arc[edges[:, 0]]
    gap = np.where(gap <= 0, gap + length, gap)
    if not len(edges) or _laps(gap, edges, length, len(arc)):
        return arc, True
    return _put_back(arc, edges, length, fixed)


def _laps(gap: Floats, edges: Indices, length: Floats, count: int) -> bool:
    """Return whether the gaps along each closed ring of edges add up to its loop's length, once around."""
    following = np.full(count, -1, dtype=np.intp)
    following[edges[:, 0]] = np.arange(len(edges))
    seen = np.zeros(len(edges), dtype=bool)
    for start in range(len(edges)):
        ring, k = [], start
        while k >= 0 and not seen[k]:
            seen[k] = True
            ring.append(k)
            k = int(following[edges[k, 1]])
        if ring and gap[ring].sum() > length[ring[0]] * (1 + 1e-9):
            return False
    return True


def _put_back(arc: Floats, edges: Indices, length: Floats, fixed: Bools) -> tuple[Floats, bool]:
    """Spread nodes that overtook others between those that stay."""
    arc = arc.copy()
    following = np.full(len(arc), -1, dtype=np.intp)
    following[edges[:, 0]] = np.arange(len(edges))
    before = np.full(len(arc), -1, dtype=np.intp)
    before[edges[:, 1]] = np.arange(len(edges))
    anchors = [int(k) for k in np.flatnonzero(fixed & (following >= 0))]
    seen = np.zeros(len(edges), dtype=bool)
    for a in anchors + [int(e[0]) for e in edges]:
        k, chain = int(following[a]), []
        while k >= 0 and not seen[k]:
            seen[k] = True
            chain.append(k)
            if fixed[edges[k, 1]] or edges[k, 1] == a:
                break
            k = int(following[edges[k, 1]])
        if chain and not _spread(
            arc, edges[chain], float(length[chain[0]]), bool(fixed[edges[chain[-1], 1]])
        ):
            return arc, False
    return arc, True


def _spread(arc: Floats, chain: Indices, length: float, ends: bool) -> bool:
    """Give the edges of a chain (k, 2) gaps above zero, in place; `ends`: at a node that stays."""
    raw = arc[chain[:, 1]] - arc[chain[:, 0]]
    gap = raw - length * np.round(raw / length)
    total = gap.sum()
    if ends or chain[-1, 1] == chain[0, 0]:
        total = (arc[chain[-1, 1]] - arc[chain[0, 0]]) % length
        total = total if total > 0 else length
    if total <= 0:
        return False
    gap = np.maximum(gap, LEAST_GAP * total / len(gap))
    gap *= total / gap.sum()
    inner = chain[:-1, 1] if ends or chain[-1, 1] == chain[0, 0] else chain[:, 1]
    arc[inner] = np.mod(arc[chain[0, 0]] + np.cumsum(gap)[: len(inner)], length)
    return True


@lru_cache(maxsize=256)
def turned(loop: Loop) -> Floats:
    """Return how far a loop has turned (n + 1,) at each of its points, in absolute radians, corners left out.

    What the tangent jumps by at points that are no corners is spread over both intervals there.
    """
    curve = loop.curve
    _, first, second, third = (part[:, None] for part in curve.tables[0])
    t = _SAMPLES[:, None]
    inside = first + t * (2.0 * second + 3.0 * t * third)
    angle = np.arctan2(inside[..., 1], inside[..., 0])
    bend = np.abs(_wrapped(np.diff(angle, axis=1))).sum(axis=1)
    jump = np.abs(_wrapped(angle[:, 0] - np.roll(angle[:, -1], 1)))
    jump[list(loop.corners)] = 0.0
    bend += 0.5 * (jump + np.roll(jump, -1))
    return np.concatenate([[0.0], np.cumsum(bend)])


def _wrapped(angle: Floats) -> Floats:
    return np.asarray(angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi)))
