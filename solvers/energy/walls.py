"""Wall nodes of a quad mesh as unknowns: their loops, their order, and the turning angle of the loops."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import arctan2
from meshonet.geometry.layout.quad_mesh import QuadMesh

LEAST_GAP = 0.05
"""Distance of wall nodes after reordering, relative to the mean distance between two fixed nodes."""
_SAMPLES = np.linspace(0.0, 1.0, 9)  # places in an interval between which a loop's turning is summed


@dataclass(frozen=True, eq=False)
class Walls:
    """The nodes on closed boundary curves (loops), and the edges between them, in order along each loop."""

    nodes: Indices
    loop: Indices
    arc: Floats  # (w,) arc lengths of the nodes, less than the length of the loop
    edges: Indices  # (e, 2) the two wall nodes of each edge, as indices into the nodes on loops
    round: Floats  # (e,) value to add to the arc length of the second node: 0 or the length of the loop

    def range_of(self, loop: int) -> tuple[int, int, int, int]:
        """Return four indices: first and end of a loop's nodes, first and end of a loop's edges."""
        of_edge = self.loop[self.edges[:, 0]]
        n = [int(k) for k in np.searchsorted(self.loop, [loop, loop + 1])]
        e = [int(k) for k in np.searchsorted(of_edge, [loop, loop + 1])]
        return n[0], n[1], e[0], e[1]


def walls_of(mesh: QuadMesh, fixed: Bools, tied: Bools) -> Walls | None:
    """Return the wall nodes of a mesh, with arc lengths that increase from node to node along each wall.

    Nodes that are out of order get new arc lengths, except those in the mask `fixed` (n,). Returns None if
    fixed nodes are out of order. Nodes in the mask `tied` (n,) are on periodic sides, which are not walls.
    """
    places = mesh.places
    on = (places.loop >= 0) & ~tied
    nodes = np.flatnonzero(on)
    nodes = nodes[np.argsort(places.loop[nodes], kind="stable")]
    loop = places.loop[nodes]
    lengths = mesh.domain.lengths
    arc = np.mod(places.arc[nodes], lengths[loop])
    number = np.full(len(mesh.nodes), -1, dtype=np.intp)
    number[nodes] = np.arange(len(nodes))
    cell, side = np.nonzero(mesh.on_wall[mesh.edge_of])
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
    """Return arc lengths (w,) that increase along the `edges` (e, 2) of each loop, and whether they exist."""
    following = np.full(len(arc), -1, dtype=np.intp)
    following[edges[:, 0]] = np.arange(len(edges))
    if _once_around(arc, edges, length, following):
        return arc, True
    arc = arc.copy()
    for chain in _chains(edges, following, np.flatnonzero(fixed & (following >= 0)), fixed):
        _spread(arc, edges[chain], float(length[chain[0]]), bool(fixed[edges[chain[-1], 1]]))
    return arc, _once_around(arc, edges, length, following)


def _once_around(arc: Floats, edges: Indices, length: Floats, following: Indices) -> bool:
    gap = arc[edges[:, 1]] - arc[edges[:, 0]]
    gap = np.where(gap <= 0, gap + length, gap)
    nowhere = np.zeros(len(arc), dtype=bool)
    rings = _chains(edges, following, np.empty(0, dtype=np.intp), nowhere)
    return all(gap[ring].sum() <= length[ring[0]] * (1 + 1e-9) for ring in rings)


def _chains(edges: Indices, following: Indices, starts: Indices, ends: Bools) -> list[list[int]]:
    """Return chains of edges, which end at nodes in `ends`; those that start at nodes `starts` come first."""
    seen, chains = np.zeros(len(edges), dtype=bool), []
    for start in [*starts.tolist(), *edges[:, 0].tolist()]:
        k, chain = int(following[start]), []
        while k >= 0 and not seen[k]:
            seen[k] = True
            chain.append(k)
            k = -1 if ends[edges[k, 1]] else int(following[edges[k, 1]])
        if chain:
            chains.append(chain)
    return chains


def _spread(arc: Floats, chain: Indices, length: float, ends: bool) -> None:
    """Give the edges of a chain (k, 2) positive lengths, in place; with `ends`, it ends at a fixed node."""
    gap = arc[chain[:, 1]] - arc[chain[:, 0]]
    gap = gap - length * np.round(gap / length)
    whole = ends or chain[-1, 1] == chain[0, 0]
    total = (arc[chain[-1, 1]] - arc[chain[0, 0]]) % length if whole else gap.sum()
    total = total if total > 0 else length
    gap = np.maximum(gap, LEAST_GAP * total / len(gap))
    gap *= total / gap.sum()
    inner = chain[:-1, 1] if whole else chain[:, 1]
    arc[inner] = np.mod(arc[chain[0, 0]] + np.cumsum(gap)[: len(inner)], length)


@lru_cache(maxsize=256)
def turned(loop: Loop) -> Floats:
    """Return sums (n + 1,) of the absolute values of turning angles, in radians, up to each point of a loop.

    Angles at corners are not counted. Those at other points are spread over both adjacent intervals.
    """
    curve = loop.curve
    _, first, second, third = (part[:, None] for part in curve.tables[0])
    t = _SAMPLES[:, None]
    inside = first + t * (2.0 * second + 3.0 * t * third)
    angle = arctan2(inside[..., 1], inside[..., 0])
    bend = np.abs(_wrapped(np.diff(angle, axis=1))).sum(axis=1)
    jump = np.abs(_wrapped(angle[:, 0] - np.roll(angle[:, -1], 1)))
    jump[list(loop.corners)] = 0.0
    bend += 0.5 * (jump + np.roll(jump, -1))
    return np.concatenate([[0.0], np.cumsum(bend)])


def _wrapped(angle: Floats) -> Floats:
    return np.asarray(angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi)))
