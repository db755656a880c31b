"""How each node of a moved wall moves and turns: x -> w' + R (x - w), with R the turn of the wall there.

::

         |  n'          In the plane R is the angle between old and new wall, from both edges at a node, the
      ___|___ w'        nearer one counting more. In space it is the rotation of the wall's quadrilaterals
      n | R             there, the polar factor of the map from the old to the new ones.
    ____|____ w
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import product, sin
from meshonet.geometry.linear import inverse, nearest_rotation
from meshonet.geometry.polygon.corners import Indices, angle_between


@dataclass(frozen=True, eq=False)
class Turning:
    """The edges of a planar wall, and what they turn by."""

    edges: Indices
    """(m, 2) numbers of nodes."""
    share: Floats
    """(m, 2) that an edge has in the turn of either end; those at a node add up to 1."""

    @classmethod
    def of(cls, nodes: Floats, edges: Indices) -> Turning:
        """Return that of `edges` of `nodes` (n, 2)."""
        nearness = 1.0 / np.maximum(norms(nodes[edges[:, 1]] - nodes[edges[:, 0]]), 1e-300)
        total = np.bincount(edges.ravel(), np.repeat(nearness, 2), len(nodes))
        return cls(edges, nearness[:, None] / total[edges])

    def angles(self, old: Floats, new: Floats) -> Floats:
        """Return the angles (n,) in radians by which the wall turns at nodes, from `old` to `new` (n, 2)."""
        before, after = (nodes[self.edges[:, 1]] - nodes[self.edges[:, 0]] for nodes in (old, new))
        return self._at_nodes(angle_between(before, after), len(old))

    def _at_nodes(self, turn: Floats, n: int) -> Floats:
        shares = (self.share * turn[:, None]).ravel()
        return np.bincount(self.edges.ravel(), shares, n).astype(np.float64, copy=False)

    def angles_along(self, new: Floats, moves: Floats) -> Floats:
        """Return the derivatives (n,) of the angles at `new` along `moves` (n, 2)."""
        slope, way = self._slopes(new), moves[self.edges[:, 1]] - moves[self.edges[:, 0]]
        return self._at_nodes((slope * way).sum(axis=1), len(new))

    def angles_transposed(self, new: Floats, pull: Floats) -> Floats:
        """Return the derivative (n, 2) by the nodes `new` of Σ pull · angles, `pull` (n,)."""
        onto = self._slopes(new) * (self.share * pull[self.edges]).sum(axis=1)[:, None]
        gathered = np.zeros_like(new)
        np.add.at(gathered, self.edges[:, 1], onto)
        np.subtract.at(gathered, self.edges[:, 0], onto)
        return gathered

    def _slopes(self, new: Floats) -> Floats:
        after = new[self.edges[:, 1]] - new[self.edges[:, 0]]
        square = np.maximum((after**2).sum(axis=1, keepdims=True), 1e-300)
        return np.stack([-after[:, 1], after[:, 0]], axis=1) / square


def turns_in_plane(angles: Floats) -> Floats:
    """Return R - 1 (n, 2, 2) of angles (n,), exact for small ones."""
    sine, less = sin(angles), -2.0 * sin(0.5 * angles) ** 2
    return np.stack([np.stack([less, -sine], axis=-1), np.stack([sine, less], axis=-1)], axis=-2)


def turns_in_space(quads: Indices, old: Floats, new: Floats) -> Floats:
    """Return R - 1 (n, 3, 3) at nodes: of the `quads` (m, 4) of a wall from `old` to `new` (n, 3)."""
    before, after = _frames(old[quads]), _frames(new[quads])
    whole = product(after, inverse(before))
    total = np.zeros((len(old), 3, 3))
    np.add.at(total, quads.ravel(), np.repeat(nearest_rotation(whole), 4, axis=0))
    on = np.flatnonzero(np.bincount(quads.ravel(), minlength=len(old)))
    turns = np.zeros_like(total)
    turns[on] = nearest_rotation(total[on]) - np.eye(3)
    return turns


def _frames(corners: Floats) -> Floats:
    """Return mean edges and normal of unit size (m, 3, 3), columns, of quads (m, 4, 3)."""
    u = corners[:, 1] - corners[:, 0] + corners[:, 2] - corners[:, 3]
    v = corners[:, 3] - corners[:, 0] + corners[:, 2] - corners[:, 1]
    normal = np.cross(u, v)
    frame = [way / np.maximum(norms(way)[:, None], 1e-300) for way in (u, v, normal)]
    return np.stack(frame, axis=-1) + 1e-12 * np.eye(3)


def affine(places: Floats, moved: Floats, turns: Floats) -> Floats:
    """Return a and B (d + d², n) of d(x) = a + B x, the motions of places (n, d), as kernels take them."""
    shift = moved - places - product(turns, places[:, :, None])[:, :, 0]
    return np.ascontiguousarray(np.concatenate([shift.T, turns.reshape(len(places), -1).T]))
