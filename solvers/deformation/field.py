"""Displacements anywhere from the motions of the boundary: nearer places weigh more, and rotations count.

The displacement at x is the mean of d_k(x) = w_k' + R_k (x - w_k) - x over all boundary nodes k, with weights
A_k (r^-2 + near² r^-4) in the plane and A_k (r^-3 + near² r^-5) in space: A is the length or area that a node
stands for, r its distance. Next to a wall its own node prevails, so that layers move and turn with it. All of
it depends on x alone, so that nodes that blocks share stay shared.

Luke, Collins, Blades, J. Comput. Phys. 231 (2012) 586-601, whose exponents are those in space; a line of
places in the plane takes one less.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.threads import thread_count
from meshonet.kernels._native import blend_motions, blend_transposed


@dataclass(frozen=True, eq=False)
class Field:
    """What weighs: places with their areas, and the points where displacements are wanted."""

    sources: Indices
    """(k,) numbers of nodes."""
    places: Floats
    """(d, k)"""
    areas: Floats
    """(k,)"""
    near: float
    """Distance inside which the nearest places prevail."""
    points: Floats
    """(d, m)"""

    @classmethod
    def of(cls, nodes: Floats, sources: Indices, areas: Floats, near: float, points: Indices) -> Field:
        """Return that of `nodes` (n, d), by the numbers of sources and points; `areas` are of all nodes."""
        places = np.ascontiguousarray(nodes[sources].T)
        where = np.ascontiguousarray(nodes[points].T)
        return cls(sources, places, np.ascontiguousarray(areas[sources]), near, where)

    def blended(self, motions: Floats) -> Floats:
        """Return the displacements (m, d) of the points by the motions (d + d², k) of the sources."""
        moved = np.empty_like(self.points)
        blend_motions(self.places, self.areas, motions, self.near, self.points, thread_count(), moved)
        return moved.T

    def transposed(self, pull: Floats) -> Floats:
        """Return the derivative (6, k) by motions in the plane of Σ pull · displacement, `pull` (m, 2)."""
        gathered = np.empty((6, len(self.areas)))
        force = np.ascontiguousarray(pull.T)
        blend_transposed(self.places, self.areas, self.near, self.points, force, gathered)
        return gathered
