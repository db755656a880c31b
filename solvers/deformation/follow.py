"""How nodes follow their boundary: one smooth map of the plane or of space, and its derivative.

Nodes of moved walls are sources of a field of displacements, with what they move and turn by; those of the
rest of the outer boundary are sources that stay. Straight sides, and flat ones of volumes, that touch a moved
wall slide along themselves first, and are sources then.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, extent_of, middle
from meshonet.geometry.elementary import product
from meshonet.geometry.linear import singular_values
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.threads import thread_count
from meshonet.kernels._native import blend_motions, blend_transposed
from meshonet.solvers.deformation.motions import Turning, affine, turns_in_plane, turns_in_space
from meshonet.solvers.deformation.outer import NodeTable, Piece
from meshonet.solvers.deformation.sources import Bools, Sources, sources_of

NEAR = 0.3
"""Distance inside which the nearest wall nodes prevail, in extents of what is moved, at the most."""
ROOM = 0.1
"""The same, in distances between what is moved and what stays: gaps need a softer field."""
_SOME = 100
"""Moved nodes whose distances are looked at."""
FLAT = 1e-9
"""Part of its extent by which a side is off a straight line or plane at the most, to slide in it."""


@dataclass(frozen=True, eq=False)
class Field:
    """Displacements anywhere from the motions of the boundary: nearer places weigh more, and rotations count.

    The displacement at x is the mean of d_k(x) = w_k' + R_k (x - w_k) - x over all boundary nodes k, with
    weights A_k (r^-2 + near² r^-4) in the plane and A_k (r^-3 + near² r^-5) in space: A is the length or area
    that a node stands for, r its distance. Next to a wall its own node prevails, so that layers move and turn
    with it. All of it depends on x alone, so that nodes that blocks share stay shared.

    Luke, Collins, Blades, J. Comput. Phys. 231 (2012) 586-601, whose exponents are those in space; a line of
    places in the plane takes one less.
    """

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


@dataclass(frozen=True, eq=False)
class Follow:
    """The map of a table's nodes that nodes of its boundary make when they move."""

    table: NodeTable
    sources: Sources
    turning: Turning | None
    """In the plane."""
    slide: Field | None
    """At the nodes that slide, where there are any."""
    field: Field
    inner: Indices

    @classmethod
    def of(cls, table: NodeTable, moved: Bools) -> Follow:
        """Return that of `table` whose nodes `moved` (n,) go to places of their own."""
        nodes, sources = table.nodes, sources_of(table, moved)
        near = _near(nodes[moved], nodes[sources.fixed])
        held = np.union1d(np.flatnonzero(moved), sources.fixed)
        slides = np.flatnonzero(sources.slides)
        slide = Field.of(nodes, held, sources.areas, near, slides) if len(slides) else None
        inner = np.flatnonzero(~table.outer)
        every = np.union1d(held, slides) if len(slides) else held
        field = Field.of(nodes, every, sources.areas, near, inner)
        turning = Turning.of(nodes, sources.elements) if nodes.shape[1] == 2 else None
        return cls(table, sources, turning, slide, field, inner)

    def nodes_to(self, to: Floats) -> Floats:
        """Return all nodes (n, d) when the moved ones go where they are in `to` (n, d)."""
        there = self.boundary_to(to)
        there[self.inner] += self.field.blended(self._motions(self.field, there))
        return there

    def boundary_to(self, to: Floats) -> Floats:
        """Return all nodes (n, d) where they were, but for those that are moved and those that slide."""
        nodes = self.table.nodes
        there = np.where(self.sources.moved[:, None], to, nodes)
        if self.slide is not None:
            move = np.zeros_like(nodes)
            move[self.sources.slides] = self.slide.blended(self._motions(self.slide, there))
            there += self.along_sides(move, there)
        return there

    def _motions(self, field: Field, there: Floats) -> Floats:
        """Return the motions (d + d², k) of the sources of a field."""
        old, at = self.table.nodes, field.sources
        if self.turning is not None:
            turns = turns_in_plane(self.turning.angles(old, there)[at])
        else:
            turns = turns_in_space(self.sources.elements, old, there)[at]
        return affine(old[at], there[at], turns)

    def along_sides(self, move: Floats, there: Floats) -> Floats:
        """Return displacements (n, d) of sliding nodes without what leads out of their straight sides."""
        for piece in self.sources.sliding:
            normal = normal_of(self.table, piece, there)
            if normal is not None:
                at = piece.numbers.ravel()
                move[at] -= product(move[at], normal)[:, None] * normal
        return move


def _near(moved: Floats, fixed: Floats) -> float:
    """Return the distance inside which the nearest of the sources (n, d) prevail."""
    extent = NEAR * extent_of(moved)
    if not len(fixed):
        return extent
    some = moved[:: len(moved) // _SOME + 1]
    square = sum((some[:, None, axis] - fixed[:, axis]) ** 2 for axis in range(moved.shape[1]))
    return min(extent, ROOM * middle(np.sqrt(np.min(square, axis=1))))


def normal_of(table: NodeTable, piece: Piece, there: Floats) -> Floats | None:
    """Return the unit normal (d,) of a straight or flat side, None where it is bent, or its ends leave it."""
    nodes, after = (each[piece.numbers.ravel()] for each in (table.nodes, there))
    centre = nodes.mean(axis=0)
    _, size, ways = singular_values(nodes - centre)
    normal = np.asarray(ways[-1])
    off = np.abs(product(np.concatenate([nodes, after]) - centre, normal)).max()
    return normal if off <= FLAT * size[0] else None


def sliding_notes(follow: Follow, to: Floats) -> tuple[str, ...]:
    """Return what is to be said of sides that touch moved walls, whose nodes go to `to` (n, d), and stay."""
    notes, table = [], follow.table
    for piece in follow.sources.sliding:
        if (to[piece.numbers] == table.nodes[piece.numbers]).all():
            continue  # the moved nodes that it touches stay where they are
        flat = normal_of(table, piece, to) is not None
        what = "slide along it" if flat else "follow: it is bent"
        notes.append(f"nodes of {piece.patch.name} {what}")
    return tuple(dict.fromkeys(notes))
