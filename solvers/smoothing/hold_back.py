"""Compares a smoothed planar multi-block grid with the given one, and moves nodes back where it is worse."""

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, shortest_ways
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.layout.from_grid import with_nodes
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.quality.blocks import block_figures
from meshonet.geometry.quality.checkmesh import cells_beyond, faces
from meshonet.geometry.quality.measure import count_folded_in

_SLACK = 1e-7  # tolerance for rounding, in degrees and for skewness
_NOTHING = 1.0, 0.05, 0.1  # non-orthogonality, skewness, mean deviation: smaller differences are ignored


@dataclass(frozen=True)
class PlaneMeasures:
    """Quality measures of a planar grid, none of which may increase, and a `score`, better if smaller."""

    folded: int
    angle: float  # largest non-orthogonality of a face in degrees
    skew: float  # largest skewness of a face
    mean: float  # mean deviation of corner angles from 90 degrees
    score: float

    def no_worse(self, than: Self) -> bool:
        """Return whether no measure is larger than its value in `than`, apart from negligible differences."""
        if than.folded or self.folded:
            return self.folded < than.folded
        pairs = (self.angle, than.angle), (self.skew, than.skew), (self.mean, than.mean)
        both = zip(pairs, _NOTHING, strict=True)
        return all(own <= max(other + _SLACK, nothing) for (own, other), nothing in both)


def measures(grid: Grid) -> PlaneMeasures:
    """Return the quality measures of a planar multi-block grid."""
    of_faces, figures = faces(grid), block_figures(grid)
    angle = of_faces.non_orthogonality.max if of_faces.non_orthogonality else 0.0
    skew = of_faces.face_skewness.max if of_faces.face_skewness else 0.0
    angles, across = figures.deviation, figures.lines.growth_across
    jump = math.log(across.max) if across else 0.0
    folded = count_folded_in(grid)
    score = angle / 30.0 + skew + angles.mean / 5.0 + (angles.p99 or 0.0) / 30.0 + jump
    return PlaneMeasures(folded, angle, skew, angles.mean, math.inf if folded else score)


_ROUNDS, _GENTLE = 30, 8
"""Largest number of rounds, and the number after which nodes of bad cells are reset at once."""

_SHARES = (0.5, 0.7, 0.85)
"""Factors per round of the displacement of a bad cell's nodes, and of nodes one and two cells away."""

_SMALL = 0.02  # fraction of the displacement below which a node is reset


def held_back(grid: Grid, original: Layout, layout: Layout, before: PlaneMeasures) -> Grid | None:
    """Return `grid` with its nodes moved towards those of `layout`, as far as no measure becomes worse.

    `grid` has the layout `original` and the measures `before`. Returns None if hardly any node would move.
    """
    part = np.ones(len(original.mesh.nodes))
    for number in range(_ROUNDS):
        made = with_nodes(grid, part_of_the_way(original, layout, part))
        now = measures(made)
        if now.no_worse(before):
            return made
        bad = np.zeros(len(part), dtype=bool)
        for block, i, j in cells_beyond(made, before.angle, before.skew):
            bad[original.blocks[block][i : i + 2, j : j + 2]] = True
        if not bad.any():  # the mean deviation, or folded cells
            bad[:] = True
        quads = original.mesh.quads
        for share in _SHARES:
            part[bad] *= share if number < _GENTLE else 0.0
            bad[quads[bad[quads].any(axis=1)].ravel()] = True  # and the nodes around them
        part[part < _SMALL] = 0.0
        if not part.any():
            break
    return None


def part_of_the_way(original: Layout, layout: Layout, part: Floats) -> Layout:
    """Return `original` with nodes moved by fractions `part` (n,) of their way to `layout`."""
    old, mesh = original.mesh, layout.mesh
    nodes = old.nodes + part[:, None] * (mesh.nodes - old.nodes)
    arc = old.places.arc.copy()
    moved = (mesh.nodes != old.nodes).any(axis=1) & (old.places.partner < 0)
    moved[old.places.partner[old.places.partner >= 0]] = False
    on = (old.places.loop >= 0) & moved
    length = old.domain.lengths[old.places.loop[on]]
    way = shortest_ways(mesh.places.arc[on] - arc[on], length)
    arc[on] = np.mod(arc[on] + part[on] * way, length)
    nodes[on] = old.domain.at(old.places.loop[on], arc[on])
    return replace(layout, mesh=mesh.with_nodes(old.beside_partners(nodes), arc))
