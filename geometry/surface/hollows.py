"""Concave edges of a surface: where they are, how sharp, and how far nodes are from them along it."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, norms
from meshonet.geometry.elementary import arctan2
from meshonet.geometry.surface.half_edges import ends_of
from meshonet.geometry.surface.surface import Surface

CONCAVE_DEG = 30.0  # smallest turn of the normal at a concave edge, in degrees: walls meet at 150 degrees
_LEAST = 0.01  # concave edges shorter together than this fraction of the surface's size are dents
_BESIDE = 0.1  # largest distance from a concave edge, in sizes of the surface, at which it makes cells fold


@dataclass(frozen=True, eq=False)
class Hollows:
    """Concave edges of a surface.

    Parameters
    ----------
    edges : (k, 2) the two nodes of each edge.
    angles : (k,) angle outside the body between the two faces at each edge, in degrees, at most 150.
    distance : (n,) length of the shortest way along cell edges from each node to a concave edge, plus the
        shortest cell edge that leaves it, so that none is 0; infinite if there are no concave edges.
    """

    edges: Indices
    angles: Floats
    distance: Floats

    def sharpest(self) -> tuple[float, int] | None:
        """Return the sharpest concave angle in degrees, outside the body, and a node there; or None."""
        return self._at(int(self.angles.argmin())) if len(self.edges) else None

    def nearest(self, surface: Surface, numbers: Indices) -> tuple[float, int] | None:
        """Return the angle at the concave edge nearest to some nodes, and a node there.

        `numbers` (n,) are the indices of these nodes. The angle is measured outside the body, in degrees. The
        result is None if the edge is farther away than 10 % of the surface's extent.
        """
        if not len(self.edges):
            return None
        edges = surface.nodes[self.edges[:, 0]]
        away = norms(surface.nodes[numbers][:, None] - edges).min(axis=0)
        k = int(away.argmin())
        return self._at(k) if away[k] <= _BESIDE * surface.size else None

    def _at(self, k: int) -> tuple[float, int]:
        return float(self.angles[k]), int(self.edges[k, 0])


def hollows_of(surface: Surface) -> Hollows:
    """Return the concave edges of a surface; none if their total length is below 1 % of its size."""
    quads, twin = surface.quads, surface.twin
    x = surface.nodes[quads]
    normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    first, last = ends_of(quads)
    edges = np.flatnonzero(twin > np.arange(len(twin)))
    own, other = normal[edges // 4], normal[twin[edges] // 4]
    along = surface.nodes[last[edges]] - surface.nodes[first[edges]]
    across = np.cross(own, other)
    turn = np.degrees(arctan2(norms(across), (own * other).sum(axis=1)))
    hollow = ((across * along).sum(axis=1) < 0.0) & (turn > CONCAVE_DEG)
    hollow &= norms(along[hollow]).sum() > _LEAST * surface.size
    which = edges[hollow]
    ends = np.stack([first[which], last[which]], axis=1)
    return Hollows(ends, 180.0 - turn[hollow], _distance(surface, ends))


def _distance(surface: Surface, edges: Indices) -> Floats:
    distance = np.full(len(surface.nodes), np.inf)
    if not len(edges):
        return distance
    ring = surface.ring
    length = np.where(ring >= 0, norms(surface.nodes[ring] - surface.nodes[:, None]), np.inf)
    inside = np.zeros(len(distance), dtype=bool)
    inside[edges.ravel()] = True
    off = np.where(inside[ring], np.inf, length).min(axis=1)
    distance[inside] = off[inside]
    while True:
        nearer = np.minimum(distance, (distance[ring] + length).min(axis=1))
        if np.array_equal(nearer, distance):
            return distance
        distance = nearer
