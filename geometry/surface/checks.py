"""Checks of surfaces; a fault raises one line that says where it is."""

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, distinct, norms
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError, place_of
from meshonet.geometry.surface.half_edges import ends_of
from meshonet.geometry.surface.merge import SLANT, near_pairs

_GAP = 0.2  # open nodes nearer than this fraction of the shorter adjacent edge, but not coincident, are a gap
_ON = 0.05  # a node nearer to an edge than this fraction of the edge's length lies on the edge
_SIDES = ("west", "east", "south", "north")


def node_place(nodes: Floats, lattices: tuple[Indices, ...], node: int) -> str:
    """Return text that says where a node is: a patch, the node's i and j in this patch, and its x, y, z."""
    for number, lattice in enumerate(lattices):
        at = np.argwhere(lattice == node)
        if len(at):
            return f"patch {number}, i={at[0, 0]}, j={at[0, 1]}, {place_of(nodes[node])}"
    return ""


def check_quads(nodes: Floats, lattices: tuple[Indices, ...], quads: Indices) -> None:
    """Raise InputError for an edge of length zero, or a quadrilateral folded onto itself."""
    for number, k in enumerate(lattices):
        for side, line in zip(_SIDES, (k[0], k[-1], k[:, 0], k[:, -1]), strict=True):
            if (line == line[0]).all():
                problem = f"the {side} side of patch {number} is a single point"
                remedy = "close the surface there by a patch of its own (a core), not by a pole"
                raise InputError(problem, remedy, place=node_place(nodes, lattices, int(line[0])))
    first, last = ends_of(quads)
    none = np.flatnonzero(first == last)
    if len(none):
        place = node_place(nodes, lattices, int(first[none[0]]))
        raise InputError("an edge has no length", "keep neighbouring nodes apart", place=place)
    folded = np.flatnonzero((quads[:, 0] == quads[:, 2]) | (quads[:, 1] == quads[:, 3]))
    if len(folded):
        place = node_place(nodes, lattices, int(quads[folded[0], 0]))
        problem = "opposite corners of a face are the same node"
        raise InputError(problem, "close the surface there by a patch of its own", place=place)


def check_manifold(nodes: Floats, lattices: tuple[Indices, ...], crowded: Indices) -> None:
    """Raise InputError if there are `crowded` nodes, which are on an edge of three or more faces."""
    if len(crowded):
        owners = [str(n) for n, k in enumerate(lattices) if (k == crowded[0]).any()]
        problem = f"an edge belongs to three faces or more (patches {', '.join(owners)})"
        remedy = "leave out the patch that lies inside or twice at the same place"
        raise InputError(problem, remedy, place=node_place(nodes, lattices, int(crowded[0])))


def check_gaps(nodes: Floats, lattices: tuple[Indices, ...], edges: Indices) -> None:
    """Raise InputError if two nodes on open edges of a surface nearly coincide: there is a gap.

    `edges` (k, 2) are the nodes of open edges, `lattices` the node numbers (ni, nj) of each patch.
    """
    if not len(edges):
        return
    length = np.sqrt(((nodes[edges[:, 0]] - nodes[edges[:, 1]]) ** 2).sum(axis=1))
    shortest = np.full(len(nodes), np.inf)
    for end in (0, 1):
        np.minimum.at(shortest, edges[:, end], length)
    at = np.flatnonzero(np.isfinite(shortest))
    pairs = near_pairs(nodes[at], _GAP * float(np.median(shortest[at])))
    pairs = at[pairs]
    apart = np.sqrt(((nodes[pairs[:, 0]] - nodes[pairs[:, 1]]) ** 2).sum(axis=1))
    near = np.flatnonzero(apart < _GAP * np.minimum(shortest[pairs[:, 0]], shortest[pairs[:, 1]]))
    if not len(near):
        return
    widest = near[np.argmax(apart[near])]
    places = [node_place(nodes, lattices, int(k)) for k in pairs[widest]]
    problem = f"a gap of {apart[widest]:.3g} between sides that nearly match, at {places[0]} and {places[1]}"
    raise InputError(problem, "make the nodes of both sides the same", place=f"{len(near)} nodes")


def check_seams(nodes: Floats, lattices: tuple[Indices, ...], edges: Indices) -> None:
    """Raise InputError if a node of one of the open `edges` (k, 2) of a surface lies inside another edge."""
    ends = nodes[edges]
    along = ends[:, 1] - ends[:, 0]
    length = norms(along)
    open_nodes = distinct(edges.ravel())
    place = product(nodes[open_nodes], SLANT)
    order = np.argsort(place, kind="stable")
    reach = product(ends, SLANT)
    first = np.searchsorted(place[order], reach.min(axis=1) - _ON * length)
    last = np.searchsorted(place[order], reach.max(axis=1) + _ON * length)
    edge = np.repeat(np.arange(len(edges)), last - first)
    skipped = np.repeat(first - np.cumsum(last - first) + last - first, last - first)
    node = open_nodes[order[np.arange(len(edge)) + skipped]]
    off = nodes[node] - ends[edge, 0]
    part = (off * along[edge]).sum(axis=1) / length[edge] ** 2
    away = norms(off - part[:, None] * along[edge])
    lies = np.flatnonzero((np.abs(part - 0.5) < 0.5 - _GAP) & (away < _ON * length[edge]))
    if len(lies):
        at = lies[0]
        own, other = (node_place(nodes, lattices, int(k)) for k in (node[at], edges[edge[at], 0]))
        problem = f"sides that meet have other nodes, {len(lies)} in all, the first at {own}, next to {other}"
        raise InputError(problem, "give both sides the same nodes where they meet")


def check_sides(
    nodes: Floats, lattices: tuple[Indices, ...], quads: Indices, twin: Indices, valence: Indices
) -> None:
    """Raise InputError if two parts of the surface touch in a single node."""
    first, _ = ends_of(quads)
    faces = np.bincount(first, minlength=len(nodes))
    opened = np.bincount(first[twin < 0], minlength=len(nodes))
    torn = np.flatnonzero((faces != valence - (opened > 0)) | (opened > 1))
    if len(torn):
        place = node_place(nodes, lattices, int(torn[0]))
        raise InputError(
            "parts of the surface touch in a single node", "join them, or part them", place=place
        )
