"""Moves nodes of a mesh so that the ratio of consecutive edges along grid lines is limited.

Let ρ be the logarithms of the ratios of consecutive edges, θ the angles at corners of cells, and z the nodes.
Nodes near ratios above the limit minimise, in Gauss-Newton steps::

    E = the term of `growth_limit` in ρ + ν Σ (θ - θ0)² + σ Σ |z - z0|² / h²

θ0, limited to between 60 and 120 degrees, and z0 are the initial values; h is the shortest edge at a node. ρ
and θ are real and imaginary parts of logarithms of quotients of edges as complex numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Bools, Complexes, Floats, Indices, complex_of, pairs_of
from meshonet.geometry.blocks.shared_nodes import joined_labels
from meshonet.geometry.elementary import angle, modulus, times
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.layers.growth_lines import GrowthLines
from meshonet.solvers.layers.growth_limit import EXCESS, MOST_WEIGHT, RISE, GrowthLimit, damped
from meshonet.solvers.least_squares import NormalEquations, Residuals

ANGLE, MOVE = 6.0, 1e-3  # ν, σ
MARGIN = 0.008  # margin below the limit, in logarithms, to which ratios are reduced
AROUND, REACH = 5, 1.0
"""Number of cells around ratios above the limit in which nodes move, and its increase with the excess."""
ROUNDS, STEPS = 8, 3
"""Number of times that the set of moving nodes is determined, and number of steps for each set."""
RAIL = 1e9  # weight, in units of σ, that keeps sliding nodes on their tangent
WORTH, FEW = 0.7, 5e-4
"""Fraction of the excess up to which another round follows; fraction of ratios that counts as few."""
NO_PAIRS = np.empty((0, 2), dtype=np.intp)
_ANGLES = np.radians(60.0), np.radians(120.0)  # limits of θ0, so that bad corners improve
_WORST = np.radians(5.0), np.radians(175.0)  # angles that no step passes, unless they were beyond before
_SLACK = 0.02  # radians by which corners beyond them may become worse


def evened_mesh(mesh: QuadMesh, held: Bools, lines: GrowthLines, following: Indices = NO_PAIRS) -> QuadMesh:
    """Return the mesh with nodes moved where the ratio of successive edges exceeds the limits of `lines`.

    Nodes in the mask `held` (n,) are fixed. Each pair in `following` (k, 2) is a wall node and a node that
    moves and rotates with it, so that first cells keep their heights. Nodes slide along the boundary, except
    at corners and on periodic sides. Ratios may exceed the limits where good angles require it.
    """
    sliding = mesh.wall_nodes & ~held & (mesh.places.cells == 0) & ~mesh.tied
    fixed = held | (mesh.wall_nodes & ~sliding)
    fixed[following[:, 1]] |= fixed[following[:, 0]]
    weight, before = EXCESS, np.inf
    for _ in range(ROUNDS):
        z = complex_of(mesh.nodes)
        growth = lines.growth(z)
        free = _near(mesh, lines, growth) & ~fixed
        free[following[:, 1]] = free[following[:, 0]]
        excess = np.maximum(np.abs(growth) - lines.limit, 0.0).sum()
        many = np.count_nonzero(np.abs(growth) > lines.limit) > FEW * len(growth)
        if not free.any() or (many and excess > WORTH * before):
            break
        before = excess
        on, pairs = sliding & free, following[free[following[:, 0]]]
        tangents = _tangents(mesh, on)
        z, weight = _Patch.of(mesh, lines, z, free, tangents, pairs).evened(z, weight)
        mesh = _followed(mesh, mesh.with_nodes(pairs_of(z)).on_loops(on), tangents, pairs)
    return mesh


def _followed(before: QuadMesh, after: QuadMesh, tangents: Complexes, pairs: Indices) -> QuadMesh:
    """Return the mesh `after` a step with second nodes of pairs (k, 2) moved and rotated like the first."""
    if len(pairs) == 0:
        return after
    first, second = pairs.T
    turn = _tangents(after, np.isin(np.arange(len(tangents)), first))[first] / tangents[first]
    away = complex_of(before.nodes[second] - before.nodes[first])
    nodes = after.nodes.copy()
    nodes[second] = nodes[first] + pairs_of(times(away, turn))
    return after.with_nodes(nodes)


def _tangents(mesh: QuadMesh, sliding: Bools) -> Complexes:
    """Return the directions (n,) of the loops at the nodes that slide, 0 at others."""
    tangents = np.zeros(len(mesh.nodes), dtype=np.complex128)
    for number, loop in enumerate(mesh.domain.loops):
        on = np.flatnonzero(sliding & (mesh.places.loop == number))
        tangents[on] = complex_of(loop.tangent(mesh.places.arc[on]))
    return tangents


def _near(mesh: QuadMesh, lines: GrowthLines, growth: Floats) -> Bools:
    """Return a mask (n,) of nodes near the middle ones of lines whose growth (k,) exceeds the limit.

    Near means within `AROUND` cells, and `REACH` more for each multiple of the limit beyond it.
    """
    uneven = np.abs(growth) > lines.limit
    near = np.zeros(len(mesh.nodes), dtype=bool)
    reach = AROUND + np.floor(REACH * (np.abs(growth[uneven]) / lines.limit[uneven] - 1.0)).astype(np.intp)
    middle, begins = lines.nodes[uneven, 1], lines.begins[uneven]
    for cells in range(int(reach.max(initial=0)), 0, -1):
        near[middle[reach >= cells]] = near[begins[reach >= cells]] = True
        near[mesh.quads[_touched(near, mesh.quads)]] = True
    return near


def _touched(nodes: Bools, groups: Indices) -> Bools:
    """Return a mask (k,) of the groups (k, m) of nodes with a node in the mask `nodes` (n,)."""
    touched = nodes[groups[:, 0]]
    for column in groups.T[1:]:
        touched |= nodes[column]
    return np.asarray(touched)


@dataclass(frozen=True, eq=False)
class _Patch:
    """The nodes that move, and the terms of E that change with them."""

    nodes: Indices  # (m,) those that move
    lines: GrowthLines
    corners: Indices  # (c, 3) corners of cells, the nodes after and before them
    growth: GrowthLimit
    angles: Floats  # (c,) θ0
    worst: tuple[Floats, Floats]  # (c,) least and largest angle permitted
    start: Complexes  # (m,) z0
    stiffness: Floats  # (m,) σ / h²
    axes: Complexes  # (n,) direction of the first of the two unknowns of each node: the tangent if it slides
    across: Floats
    """(m,) factor on the stiffness of the second unknown, which keeps sliding nodes on the tangent."""
    equations: NormalEquations
    pairs: Indices  # (k, 2) nodes on loops, and those that move with them
    part: Indices  # (n,) number of the independent part of the patch that each node is in, -1 for none

    @classmethod
    def of(
        cls, mesh: QuadMesh, lines: GrowthLines, z: Complexes, free: Bools, tangents: Complexes,
        pairs: Indices,
    ) -> Self:  # fmt: skip
        own = free.copy()
        own[pairs[:, 1]] = False
        nodes = np.flatnonzero(own)
        lines = lines.some(_touched(free, lines.nodes))
        quads = mesh.quads[_touched(free, mesh.quads)]
        corners = np.concatenate(
            [np.stack([quads[:, k], quads[:, (k + 1) % 4], quads[:, k - 1]], axis=1) for k in range(4)]
        )
        corners = corners[_touched(free, corners)]
        initial = _angles(z, corners)
        shortest = np.full(len(z), np.inf)
        edges = mesh.edges[_touched(free, mesh.edges)]
        length = modulus(z[edges[:, 1]] - z[edges[:, 0]])
        for end in edges.T:
            np.minimum.at(shortest, end, length)
        unknown = np.full(len(z), -1, dtype=np.intp)
        unknown[nodes] = np.arange(len(nodes))
        unknown[pairs[:, 1]] = unknown[pairs[:, 0]]
        tangents = tangents.copy()
        tangents[pairs[:, 1]] = tangents[pairs[:, 0]]
        return cls(
            nodes, lines, corners,
            GrowthLimit.at(lines.growth(z), lines.limit - MARGIN),
            np.clip(initial, *_ANGLES),
            (
                np.maximum(np.minimum(initial - _SLACK, _WORST[0]), 0.0),
                np.maximum(initial + _SLACK, _WORST[1]),
            ),
            z[nodes], MOVE / shortest[nodes] ** 2,
            np.where(tangents == 0, 1.0, tangents), np.where(tangents[nodes] == 0, 1.0, RAIL),
            NormalEquations(len(nodes), [unknown[lines.nodes], unknown[corners]], 2), pairs,
            _parts(free, (lines.nodes, quads)),
        )  # fmt: skip

    def evened(self, z: Complexes, weight: float) -> tuple[Complexes, float]:
        """Return the nodes after some iterations, and the final weight of the penalty on excessive growth."""
        z, part = z.copy(), self.part[self.nodes]
        for _ in range(STEPS):
            weight = min(weight * RISE, MOST_WEIGHT)
            step = damped(partial(self._values, z, weight), z[self.nodes], self._step(z, weight), part)
            z = self._placed(z, z[self.nodes] + step)
            if (np.abs(self.lines.growth(z)) <= self.lines.limit).all():
                break
        return z, weight

    def _values(self, z: Complexes, weight: float, at: Complexes) -> Floats:
        """Return E of each part (p,) with moving nodes at `at` (m,); infinite beyond the `worst` angles."""
        z = self._placed(z, at)
        angles = _angles(z, self.corners)
        least, most = self.worst
        turned = np.where((angles > least) & (angles < most), ANGLE * (angles - self.angles) ** 2, np.inf)
        grown = self.growth.values(self.lines.growth(z), weight)
        moved = self.stiffness * modulus(at - self.start) ** 2
        count = int(self.part.max()) + 1
        value = np.bincount(self.part[self.nodes], moved, count)
        value += np.bincount(self.part[self.lines.nodes].max(axis=1), grown, count)
        value += np.bincount(self.part[self.corners].max(axis=1), turned, count)
        return np.asarray(value, dtype=np.float64)

    def _placed(self, z: Complexes, at: Complexes) -> Complexes:
        """Return the nodes (n,) with those that move at `at` (m,), and others that move with them."""
        placed = z.copy()
        placed[self.nodes] = at
        first, second = self.pairs.T
        placed[second] += placed[first] - z[first]
        return placed

    def _alike(self, nodes: Indices, derivatives: Complexes) -> Complexes:
        """Return derivatives (k, 3) by `nodes` (k, 3); of nodes that move together, the first has the sum."""
        leader = np.arange(len(self.part))
        leader[self.pairs[:, 1]] = self.pairs[:, 0]
        for i, j in ((0, 1), (0, 2), (1, 2)):
            alike = leader[nodes[:, i]] == leader[nodes[:, j]]
            derivatives[alike, i] += derivatives[alike, j]
            derivatives[alike, j] = 0.0
        return derivatives

    def _step(self, z: Complexes, weight: float) -> Complexes:
        """Return by how much nodes (m,) move in a step of Gauss-Newton."""
        nodes = self.lines.nodes
        before, after = self.lines.edges(z)
        along, back = (z[self.corners[:, k]] - z[self.corners[:, 0]] for k in (1, 2))
        by_line = np.stack([1.0 / before, -1.0 / before - 1.0 / after, 1.0 / after], axis=1)
        by_corner = np.stack([1.0 / along - 1.0 / back, -1.0 / along, 1.0 / back], axis=1)
        if len(self.pairs):
            by_line, by_corner = self._alike(nodes, by_line), self._alike(self.corners, by_corner)
        growth, turned = self.lines.growth(z), _angles(z, self.corners) - self.angles
        axes = self.axes[self.nodes]
        pull = times(np.conj(axes) * self.stiffness, (z[self.nodes] - self.start))
        step = self.equations.step(
            [
                self.growth.residuals(growth, _by_coordinates(times(self.axes[nodes], by_line)), weight),
                Residuals(
                    _by_coordinates(times(times(-1j, self.axes[self.corners]), by_corner)),
                    np.full(len(turned), ANGLE),
                    ANGLE * turned,
                ),
            ],
            np.stack([self.stiffness, self.across * self.stiffness], axis=1).ravel(),
            np.stack([pull.real, pull.imag], axis=1).ravel(),
        )
        return np.asarray(times(axes, (step[::2] + 1j * step[1::2])))


def _angles(z: Complexes, corners: Indices) -> Floats:
    """Return the angles (c,) of corners, negative where they are folded."""
    corner = z[corners[:, 0]]
    return angle((z[corners[:, 2]] - corner) / (z[corners[:, 1]] - corner))


def _parts(free: Bools, groups: Sequence[Indices]) -> Indices:
    """Return a number (n,) for each free node, -1 for others, the same within a row of `groups` (k, m)."""
    pairs = []
    for group in groups:
        inside = free[group]
        first = np.take_along_axis(group, inside.argmax(axis=1)[:, None], axis=1)
        pairs.append((np.broadcast_to(first, group.shape)[inside], group[inside]))
    label = joined_labels(len(free), pairs)
    part = np.full(len(free), -1, dtype=np.intp)
    part[free] = np.unique(label[free], return_inverse=True)[1]
    return part


def _by_coordinates(derivatives: Complexes) -> Floats:
    """Return derivatives (k, 6) by real and imaginary parts, from complex `derivatives` (k, 3)."""
    return np.stack([derivatives.real, -derivatives.imag], axis=2).reshape(len(derivatives), 6)
