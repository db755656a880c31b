"""Displacements of all nodes by inverse-distance weighting (Luke et al., J. Comput. Phys. 231 (2012) 586)."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, extent_of, middle
from meshonet.geometry.elementary import product
from meshonet.geometry.linear import singular_values
from meshonet.geometry.threads import thread_count
from meshonet.kernels._native import blend_motions, blend_transposed
from meshonet.solvers.deformation.motions import Turning, affine, turns_in_plane, turns_in_space
from meshonet.solvers.deformation.outer import NodeTable, Piece
from meshonet.solvers.deformation.sources import Sources, sources_of

NEAR = 0.3  # largest distance inside which the nearest wall nodes dominate, in extents of the moved walls
ROOM = 0.1  # the same in distances between moved and fixed nodes: gaps need a softer field
_SOME = 100  # approximate number of moved nodes whose distances to fixed nodes are computed
FLAT = 1e-9  # largest deviation from a line or plane, over its extent, of a side whose nodes slide


@dataclass(frozen=True, eq=False)
class Field:
    """Displacements, interpolated from boundary nodes (sources) by inverse-distance weighting.

    Source k moves from w_k to w_k' and turns by the rotation R_k, or is fixed. The displacement at x is the
    weighted mean of d_k(x) = w_k' + R_k (x - w_k) - x over all sources. The weights are A_k (r^-2 + near²
    r^-4) in the plane and A_k (r^-3 + near² r^-5) in three dimensions. A_k is the length or area that belongs
    to source k, r the distance from w_k to x. At r < `near`, the second term is larger.
    """

    sources: Indices  # (k,) node indices of the sources
    places: Floats  # (d, k) coordinates of the sources
    areas: Floats  # (k,) lengths or areas assigned to the sources
    near: float  # distance inside which the nearest sources dominate
    points: Floats  # (d, m) coordinates of the nodes that the field displaces

    @classmethod
    def of(cls, nodes: Floats, sources: Indices, areas: Floats, near: float, points: Indices) -> Self:
        """Return a field by which `points` (m,) follow boundary nodes `sources` (k,), both as node indices.

        `areas` (n,) are the lengths or areas that belong to the `nodes` (n, d); `near` is as in `Field`.
        """
        places = np.ascontiguousarray(nodes[sources].T)
        where = np.ascontiguousarray(nodes[points].T)
        return cls(sources, places, np.ascontiguousarray(areas[sources]), near, where)

    def blended(self, motions: Floats) -> Floats:
        """Return displacements (m, d) of m nodes for given `motions` (see `affine`) of k boundary nodes."""
        moved = np.empty_like(self.points)
        blend_motions(self.places, self.areas, motions, self.near, self.points, thread_count(), moved)
        return moved.T

    def transposed(self, pull: Floats) -> Floats:
        """Return the gradient (6, k) of ``(pull * u).sum()`` with respect to the motions of k boundary nodes.

        u (m, 2), like `pull`, are the displacements of m nodes in the plane that `blended` computes from the
        motions. These are 6 numbers per boundary node, as from `affine`.
        """
        gathered = np.empty((6, len(self.areas)))
        force = np.ascontiguousarray(pull.T)
        blend_transposed(self.places, self.areas, self.near, self.points, force, gathered)
        return gathered


@dataclass(frozen=True, eq=False)
class Follow:
    """Map from new positions of moved boundary nodes to new positions of all nodes of a grid."""

    table: NodeTable
    sources: Sources
    turning: Turning | None  # rotations of the wall's edges; None in three dimensions
    slide: Field | None  # the field at sliding nodes; None if there are none
    field: Field  # the field at inner nodes
    inner: Indices  # node indices of inner nodes

    @classmethod
    def of(cls, table: NodeTable, moved: Bools) -> Self:
        """Return the map by which the nodes of `table` follow moved boundary nodes (mask `moved` (n,))."""
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
        """Return new positions (n, d) of all nodes; `to` (n, d) has those of the moved boundary nodes."""
        there = self.boundary_to(to)
        there[self.inner] += self.field.blended(self._motions(self.field, there))
        return there

    def boundary_to(self, to: Floats) -> Floats:
        """Return all nodes (n, d), moved boundary nodes at `to` (n, d) and inner ones at their old places."""
        nodes = self.table.nodes
        there = np.where(self.sources.moved[:, None], to, nodes)
        if self.slide is not None:
            move = np.zeros_like(nodes)
            move[self.sources.slides] = self.slide.blended(self._motions(self.slide, there))
            there += self.along_sides(move, there)
        return there

    def _motions(self, field: Field, there: Floats) -> Floats:
        old, at = self.table.nodes, field.sources
        if self.turning is not None:
            turns = turns_in_plane(self.turning.angles(old, there)[at])
        else:
            turns = turns_in_space(self.sources.elements, old, there)[at]
        return affine(old[at], there[at], turns)

    def along_sides(self, move: Floats, there: Floats) -> Floats:
        """Make displacements `move` (n, d), in place, tangential to flat sides along which nodes slide.

        A side is flat if its old nodes and its new ones, `there` (n, d), lie in one line or plane.
        """
        for piece in self.sources.sliding:
            normal = normal_of(self.table, piece, there)
            if normal is not None:
                at = piece.numbers.ravel()
                move[at] -= product(move[at], normal)[:, None] * normal
        return move


def _near(moved: Floats, fixed: Floats) -> float:
    """Return the distance within which the nearest of the `moved` and `fixed` nodes (n, d) dominate."""
    extent = NEAR * extent_of(moved)
    if not len(fixed):
        return extent
    some = moved[:: len(moved) // _SOME + 1]
    square = sum((some[:, None, axis] - fixed[:, axis]) ** 2 for axis in range(moved.shape[1]))
    return min(extent, ROOM * middle(np.sqrt(np.min(square, axis=1))))


def normal_of(table: NodeTable, piece: Piece, there: Floats) -> Floats | None:
    """Return the unit normal (d,) of the line or plane in which a side's nodes lie before and after a move.

    None if there is no such line or plane. `there` (n, d) are the positions of all nodes after the move.
    """
    nodes, after = (each[piece.numbers.ravel()] for each in (table.nodes, there))
    centre = nodes.mean(axis=0)
    _, size, ways = singular_values(nodes - centre)
    normal = np.asarray(ways[-1])
    off = np.abs(product(np.concatenate([nodes, after]) - centre, normal)).max()
    return normal if off <= FLAT * size[0] else None


def sliding_notes(follow: Follow, to: Floats) -> tuple[str, ...]:
    """Return notes on sides whose nodes move because the wall beside them moves to positions `to` (n, d)."""
    notes, table = [], follow.table
    for piece in follow.sources.sliding:
        if (to[piece.numbers] == table.nodes[piece.numbers]).all():
            continue  # the moved nodes that it touches stay where they are
        flat = normal_of(table, piece, to) is not None
        what = "slide along it" if flat else "follow: it is bent"
        notes.append(f"nodes of {piece.patch.name} {what}")
    return tuple(dict.fromkeys(notes))
