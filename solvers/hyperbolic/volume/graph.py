"""The graph of a surface for the march: ordered neighbours, ghost nodes beyond open edges, two colours.

Ghosts are mirror images in planes of symmetry, extrapolated at free edges. Red nodes are not neighbours of
each other; ``kernels/surfaces/graph.h`` has the arrays.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.surface.planes import Plane
from meshonet.geometry.surface.surface import Surface

_WIDTH, _FALL = 4, 0.35  # rings of nodes around irregular ones that are smoothed more; factor per ring


@dataclass(frozen=True, eq=False)
class Seen:
    """A neighbour of a surface node, or a ghost node that replaces one beyond an open edge.

    Its position is ``own * x + sign * y + shift``. Here x is the position of the surface node, and y that of
    node number `base`. Only for ghost nodes, `own`, `sign` and `shift` differ from their defaults.
    """

    base: int
    own: float = 0.0
    sign: Floats = field(default_factory=lambda: np.ones(3))
    shift: Floats = field(default_factory=lambda: np.zeros(3))

    @property
    def real(self) -> bool:
        """Whether the neighbour is a node of the surface, not a ghost."""
        return self.own == 0.0 and bool((self.sign == 1.0).all())

    def mirrored(self, plane: Plane) -> "Seen":
        """Return the mirror image of this node in `plane`."""
        turned = np.where(np.arange(3) == plane.axis, -1.0, 1.0)
        shift = turned * self.shift + (1.0 - turned) * plane.value
        return Seen(self.base, self.own, turned * self.sign, shift)

    def opposite(self, splay: float) -> "Seen":
        """Return a ghost opposite to this neighbour of a node, 1 + `splay` times as far from the node."""
        far = 1.0 + splay
        return Seen(self.base, 1.0 + far, -far * self.sign, -far * self.shift)


@dataclass(frozen=True, eq=False)
class MarchGraph:
    """The nodes of a surface, sorted by `order` (n,), and their neighbours (``kernels/surfaces/graph.h``)."""

    order: Indices
    red: int
    near: Indices
    odd_nodes: Indices
    odd_start: Indices
    odd_near: Indices
    owner: Indices
    base: Indices
    own: Floats
    sign: Floats
    shift: Floats
    fixed_nodes: Indices
    moves: Floats
    boost: Floats
    hollow: Floats


def march_graph(
    surface: Surface, planes: Sequence[Plane], in_plane: Bools, hollow: Floats, splay: float, boost: float
) -> MarchGraph:
    """Return the nodes of a surface with their neighbours, in the order of the march.

    Parameters
    ----------
    planes : p planes of symmetry.
    in_plane : (p, k) for each plane and each of the k open edges of the surface, whether the edge is in it.
    hollow : (n,) distances from concave edges (`meshonet.geometry.surface.hollows`).
    splay : nodes on free edges have ghost nodes 1 + `splay` times as far away as their neighbours inside.
    boost : additional smoothing at irregular nodes.
    """
    n = len(surface.nodes)
    regular = surface.valence == 4
    edges = surface.open_edges
    regular[edges.ravel()] = False
    rings = {int(k): [Seen(int(m)) for m in surface.ring[k] if m >= 0] for k in np.flatnonzero(~regular)}
    held: dict[int, set[int]] = {}
    at_edge: dict[tuple[int, int], list[Plane]] = {}
    for k, (a, b) in enumerate(edges.tolist()):
        inside = [plane for plane, flags in zip(planes, in_plane, strict=True) if flags[k]]
        at_edge[a, b] = at_edge[b, a] = inside
        for node in (a, b):
            held.setdefault(node, set()).update(plane.axis for plane in inside)
    for node in held:
        arc = rings[node]
        rings[node] = _closed(arc, at_edge[node, arc[0].base], at_edge[node, arc[-1].base], splay)
    coupled = np.zeros(n, dtype=bool)
    for node in rings:
        if node not in held and len(rings[node]) == 2:
            rings[node], coupled[node] = _with_diagonals(surface, node, rings[node]), True
        coupled[node] |= any(seen.own != 0.0 for seen in rings[node])
    red = _independent(surface, coupled)
    graph = _sorted(surface, red, rings, held)
    boosts = 1.0 + boost * _oddness(surface)[graph.order]
    return replace(graph, boost=boosts, hollow=hollow[graph.order])


def _closed(arc: list[Seen], before: list[Plane], after: list[Plane], splay: float) -> list[Seen]:
    """Return the ring of a node at an open edge, from its neighbours and the planes of its open edges."""
    shared = [plane for plane in before if plane in after]
    if shared and len(arc) > 2:
        return arc + [seen.mirrored(shared[0]) for seen in arc[-2:0:-1]]
    if before and after and not shared:
        arc = arc + [seen.mirrored(after[0]) for seen in arc[-2::-1]]
        return arc + [seen.mirrored(before[0]) for seen in arc[-2:0:-1]]
    if before and not shared:
        arc = [seen.mirrored(before[0]) for seen in arc[:0:-1]] + arc
    elif after and not shared:
        arc = arc + [seen.mirrored(after[0]) for seen in arc[-2::-1]]
    if len(arc) == 2:
        return arc + [seen.opposite(splay) for seen in arc]
    return arc + [seen.opposite(splay) for seen in arc[-2:0:-1]]


def _with_diagonals(surface: Surface, node: int, pair: list[Seen]) -> list[Seen]:
    """Return both neighbours of a node of two faces and the opposite corners, in order."""
    quads = surface.quads
    opposite = []
    for a, b in ((pair[0], pair[1]), (pair[1], pair[0])):
        for quad in quads[(quads == node).any(axis=1)].tolist():
            k = quad.index(node)
            if quad[(k + 1) % 4] == a.base and quad[(k + 3) % 4] == b.base:
                opposite.append(Seen(quad[(k + 2) % 4]))
    return [pair[0], opposite[0], pair[1], opposite[1]]


def _oddness(surface: Surface) -> Floats:
    """Return 1 at irregular inner nodes, less around them (n,)."""
    odd = (surface.valence != 4).astype(float)
    odd[surface.open_edges.ravel()] = 0.0
    for _ in range(_WIDTH):
        around = np.where(surface.ring >= 0, odd[surface.ring], 0.0).max(axis=1)
        odd = np.maximum(odd, _FALL * around)
    return odd


def _independent(surface: Surface, coupled: Indices) -> Indices:
    """Return which nodes (n,) are red: neither `coupled` to themselves nor to each other."""
    ring, n = surface.ring, len(surface.nodes)
    colour = np.full(n, -1)
    for seed in range(n):
        if colour[seed] >= 0:
            continue
        front, now = np.array([seed]), 0
        colour[seed] = 0
        while len(front):
            near = ring[front].ravel()
            near = near[near >= 0]
            near = near[colour[near] < 0]
            now = 1 - now
            colour[near] = now
            marked = np.zeros(n, dtype=bool)
            marked[near] = True
            front = np.flatnonzero(marked)
        if (colour >= 0).all():
            break
    red = (colour == 0) & ~coupled
    for column in ring.T:
        both = np.flatnonzero((column >= 0) & red & red[column])
        red[np.maximum(both, column[both])] = False
    return red


def _sorted(
    surface: Surface, red: Indices, rings: dict[int, list[Seen]], held: dict[int, set[int]]
) -> MarchGraph:
    n = len(surface.nodes)
    order = np.concatenate([np.flatnonzero(red), np.flatnonzero(~red)])
    new = np.empty(n, dtype=np.intp)
    new[order] = np.arange(n)
    width = max(4, surface.ring.shape[1])
    ring = np.full((n, width), -1)
    ring[:, : surface.ring.shape[1]] = surface.ring
    near = new[ring[order, :4].T]
    ghosts: list[tuple[int, Seen]] = []
    odd: list[tuple[int, list[int]]] = []
    for node in sorted(rings, key=lambda k: int(new[k])):
        row, k = [], int(new[node])
        for seen in rings[node]:
            row.append(int(new[seen.base]) if seen.real else n + len(ghosts))
            if not seen.real:
                ghosts.append((k, seen))
        if len(row) == 4:
            near[:, k] = row
        else:
            near[:, k] = (row + row)[:4]
            odd.append((k, row))
    fixed = sorted((int(new[node]), axes) for node, axes in held.items() if axes)
    moves = np.ones((3, len(fixed)))
    for k, (_, axes) in enumerate(fixed):
        moves[list(axes), k] = 0.0

    def whole(numbers: Iterable[int]) -> Indices:
        return np.fromiter(numbers, dtype=np.intp)

    return MarchGraph(
        order, int(red.sum()), np.ascontiguousarray(near), odd_nodes=whole(k for k, _ in odd),
        odd_start=np.cumsum([0, *(len(row) for _, row in odd)]),
        odd_near=whole(m for _, row in odd for m in row), owner=whole(k for k, _ in ghosts),
        base=whole(int(new[seen.base]) for _, seen in ghosts), own=np.array([seen.own for _, seen in ghosts]),
        sign=np.array([seen.sign for _, seen in ghosts]).reshape(-1, 3).T.copy(),
        shift=np.array([seen.shift for _, seen in ghosts]).reshape(-1, 3).T.copy(),
        fixed_nodes=whole(k for k, _ in fixed), moves=moves, boost=np.ones(n), hollow=np.ones(n),
    )  # fmt: skip
