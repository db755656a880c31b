"""The directions in which coordinate lines leave the singular vertices and corners of a seamless map."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.elementary import angle, times
from meshonet.solvers.blocking.decomposition.field.seamless_map import SeamlessMap

QUARTER = np.pi / 2  # angle between coordinate lines, radians
SLACK = 0.5  # angle in radians by which a ray may lie outside of the triangle to which it is assigned


@dataclass(frozen=True, eq=False)
class Ports:
    """Vertices at which lines between blocks start, and the directions (ports) of these lines."""

    vertex: Indices  # (n,) vertex of the triangulation at each node
    quarters: Indices  # (n,) number of right angles around each node, which is the number of cells
    on_wall: Bools  # (n,) whether the vertex is on a wall
    node: Indices  # (t, 3) node at each corner of each triangle, or -1
    port: Indices
    """(t, 3, 4) number of the direction from that node through the triangle along each axis, or -1.

    At walls 1 is the first interior direction; inside, 0 is the first axis after the fan's first edge.
    """
    starts: Indices
    """(r, 6) rays: node, port, triangle, corner, axis, and a column for the caller.

    There are none at corners of walls that are straight in the map.
    """


def ports_of(seamless: SeamlessMap, others: Indices) -> Ports:
    """Return directions of block edges at corners, at singular vertices and at the vertices `others` (m,)."""
    cells, around = seamless.boundary_cells, seamless.valence.copy()
    around[: len(cells)] = cells
    corners = np.flatnonzero((seamless.corner_cells > 0) | ((cells != 2) & (cells > 0)))
    vertex = np.concatenate([corners, seamless.singular, others]).astype(np.intp)
    on_wall, quarters = seamless.surface.on_wall[vertex], around[vertex]
    entry, owner = _fans(seamless, vertex)
    face, corner = np.divmod(entry, 3)
    port, margin = _directions(seamless, face, corner, owner, quarters, on_wall)
    node_at = np.full(seamless.surface.triangles.shape, -1, dtype=np.intp)
    node_at[face, corner] = owner
    port_at = np.full((*seamless.surface.triangles.shape, 4), -1, dtype=np.intp)
    port_at[face, corner] = np.where(margin > -SLACK, port, -1)
    late = np.arange(len(vertex)) >= len(vertex) - len(others)
    shoots = late | ~on_wall | (quarters != 2)
    starts = _starts(face, corner, owner, port, margin, shoots, int(quarters.max(initial=1)))
    return Ports(vertex, quarters, on_wall, node_at, port_at, starts)


def _fans(seamless: SeamlessMap, vertex: Indices) -> tuple[Indices, Indices]:
    """Return the corners (e,) around the vertices, and the node (e,) of each."""
    start, corners = seamless.surface.fans
    count = start[vertex + 1] - start[vertex]
    owner = np.repeat(np.arange(len(vertex)), count)
    before = np.cumsum(count) - count
    return corners[np.arange(len(owner)) + (start[vertex] - before)[owner]], owner


def _directions(
    seamless: SeamlessMap, face: Indices, corner: Indices, owner: Indices, quarters: Indices, on_wall: Bools
) -> tuple[Indices, Floats]:
    """Return the port (e, 4) of each axis at each corner, -1 for walls, and its angle (radians) inside it."""
    w = seamless.corner_coords
    here = w[face, corner]
    right, left = w[face, (corner + 1) % 3] - here, w[face, (corner + 2) % 3] - here
    width = angle(times(left, right.conj()))
    new = np.append(True, owner[1:] != owner[:-1])[: len(owner)]
    total = np.cumsum(width) - width
    before = total - total[np.flatnonzero(new)][owner] if len(owner) else total
    own = angle(right) / QUARTER
    off = (np.ceil(own + 1e-12) - own)[np.flatnonzero(new)] if len(owner) else own
    off = np.where(on_wall, 0.0, off)[owner]
    axes = np.array([1, 1j, -1, -1j])
    inside = angle(times(axes[None], right.conj()[:, None]))
    # an axis right behind the first edge may be turned by nearly pi either way
    inside = np.where(inside < -SLACK, inside + 2 * np.pi, inside)
    port = np.round((before[:, None] + inside) / QUARTER - off[:, None]).astype(np.intp)
    k = quarters[owner][:, None]
    wall = on_wall[owner][:, None]
    port = np.where(wall, np.where((port >= 1) & (port < k), port, -1), port % np.maximum(k, 1))
    return port, np.minimum(inside, width[:, None] - inside)


def _starts(
    face: Indices, corner: Indices, owner: Indices, port: Indices, margin: Floats, shoots: Bools, most: int
) -> Indices:
    """Return the rays (r, 6), each in the corner inside of which it has the largest `margin` (e, 4)."""
    e, axis = np.nonzero((port >= 0) & (margin > -SLACK) & shoots[owner][:, None])
    key = owner[e] * (most + 1) + port[e, axis]
    order = np.lexsort((-margin[e, axis], key))
    first = np.append(True, key[order][1:] != key[order][:-1])[: len(order)]
    best = order[first]
    e, axis = e[best], axis[best]
    rows = [owner[e], port[e, axis], face[e], corner[e], axis, np.zeros(len(e))]
    return np.ascontiguousarray(np.stack(rows, axis=1), dtype=np.intp)
