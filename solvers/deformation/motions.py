"""The motion x -> w' + R (x - w) of each node w of a moved wall, with R the local rotation of the wall.

In the plane R is the rotation by the mean angle of the edges at a node, weighted by their inverse lengths; in
space the mean rotation of quadrilaterals, polar factors of the maps from old to new edges.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, norms
from meshonet.geometry.elementary import product, sin
from meshonet.geometry.linear import inverse, nearest_rotation
from meshonet.geometry.polygon.corners import angle_between


@dataclass(frozen=True, eq=False)
class Turning:
    """Rotation angle of each node of a planar wall: a weighted mean over the edges at the node."""

    edges: Indices  # (m, 2) node indices of the edges
    share: Floats
    """(m, 2) weights of each edge in the angles of its two end nodes; the weights at a node add up to 1."""

    @classmethod
    def of(cls, nodes: Floats, edges: Indices) -> Self:
        """Return weights for averaging the rotations of the `edges` (m, 2) at each node: inverse lengths."""
        nearness = 1.0 / np.maximum(norms(nodes[edges[:, 1]] - nodes[edges[:, 0]]), 1e-300)
        total = np.bincount(edges.ravel(), np.repeat(nearness, 2), len(nodes))
        return cls(edges, nearness[:, None] / total[edges])

    def angles(self, old: Floats, new: Floats) -> Floats:
        """Return by how many radians (n,) a wall rotates at each node, from positions `old` to `new`."""
        before, after = (nodes[self.edges[:, 1]] - nodes[self.edges[:, 0]] for nodes in (old, new))
        return self._at_nodes(angle_between(before, after), len(old))

    def _at_nodes(self, turn: Floats, n: int) -> Floats:
        shares = (self.share * turn[:, None]).ravel()
        return np.bincount(self.edges.ravel(), shares, n).astype(np.float64, copy=False)

    def angles_along(self, new: Floats, moves: Floats) -> Floats:
        """Return the directional derivative (n,) of rotation angles at nodes `new` (n, 2) along `moves`."""
        slope, way = self._slopes(new), moves[self.edges[:, 1]] - moves[self.edges[:, 0]]
        return self._at_nodes((slope * way).sum(axis=1), len(new))

    def angles_transposed(self, new: Floats, pull: Floats) -> Floats:
        """Return the gradient (n, 2), with respect to `new`, of ``(pull * angles(old, new)).sum()``."""
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
    """Return R - I (n, 2, 2) for the rotation matrices R of `angles` (n,), accurate for small angles too."""
    sine, less = sin(angles), -2.0 * sin(0.5 * angles) ** 2
    return np.stack([np.stack([less, -sine], axis=-1), np.stack([sine, less], axis=-1)], axis=-2)


def turns_in_space(quads: Indices, old: Floats, new: Floats) -> Floats:
    """Return R - I (n, 3, 3), with the mean rotation R of a node's quads from `old` to `new` nodes (n, 3)."""
    before, after = _frames(old[quads]), _frames(new[quads])
    whole = product(after, inverse(before))
    total = np.zeros((len(old), 3, 3))
    np.add.at(total, quads.ravel(), np.repeat(nearest_rotation(whole), 4, axis=0))
    on = np.flatnonzero(np.bincount(quads.ravel(), minlength=len(old)))
    turns = np.zeros_like(total)
    turns[on] = nearest_rotation(total[on]) - np.eye(3)
    return turns


def _frames(corners: Floats) -> Floats:
    """Return unit mean edges and unit normal, as columns (m, 3, 3), of quads with `corners` (m, 4, 3)."""
    u = corners[:, 1] - corners[:, 0] + corners[:, 2] - corners[:, 3]
    v = corners[:, 3] - corners[:, 0] + corners[:, 2] - corners[:, 1]
    normal = np.cross(u, v)
    frame = [way / np.maximum(norms(way)[:, None], 1e-300) for way in (u, v, normal)]
    return np.stack(frame, axis=-1) + 1e-12 * np.eye(3)


def affine(places: Floats, moved: Floats, turns: Floats) -> Floats:
    """Return the motion of each of n nodes, as coefficients of the displacement a + B x of any point x.

    Columns of the result (d + d², n) have a, then the rows of B. `places` and `moved` (n, d) are the old and
    new positions of the nodes, `turns` (n, d, d) their rotation matrices minus the identity.
    """
    shift = moved - places - product(turns, places[:, :, None])[:, :, 0]
    return np.ascontiguousarray(np.concatenate([shift.T, turns.reshape(len(places), -1).T]))
