"""A column of a level, from keel to crown: the collar of a wing, of a fin, or of a fin above a wing.

::

    theta = pi   +-----------+    +--( <=> )--+    +--( <=> )--+   crown
                 |    top    |    |    fin    |    |    fin    |
                 +-----------+    +-----------+    +-----------+
                 |  ( <=> )  |    |           |     /   high    /    lines from one rectangle to the other,
                 +-----------+    |    low    |    +-----------+     each with as many on this side
                 |    low    |    |           |    |  ( <=> )  |
                 |           |    |           |    +-----------+
                 |           |    |           |    |    low    |
    theta = 0    +-----------+    +-----------+    +-----------+   keel

Beside both s, theta and zeta of the sides change smoothly from those of the wing to those of the fin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.solvers.aircraft.collar_level import (
    FEWEST,
    WIDEST,
    CollarLevel,
    CollarPlan,
    Hole,
    planned_collar,
    planned_corners,
)
from meshonet.solvers.rows.span_spacing import smooth_arcs, smooth_cells

Side: TypeAlias = tuple[Floats, Floats]
"""Nodes (n, 3) s, theta, zeta on the front or back of a column, from the keel, and cells (n,) there in s."""


@dataclass(frozen=True, eq=False)
class ColumnPlan:
    """Counts of a column, which all levels share.

    Parameters
    ----------
    collars : of its wing, of its fin, or of both, the fin last.
    fin : whether there is one.
    """

    collars: tuple[CollarPlan, ...]
    fin: bool

    @property
    def patches(self) -> int:
        """Number of patches of a level."""
        return 4 if len(self.collars) == 2 else 2 if self.fin else 3

    @property
    def bands(self) -> int:
        """Cells from keel to crown above and below collars."""
        return self.collars[0].low + (0 if self.fin_alone else self.collars[0].top)

    @property
    def fin_alone(self) -> bool:
        """Whether there is a fin and no wing."""
        return self.fin and len(self.collars) == 1

    @property
    def beside(self) -> tuple[int, int]:
        """Cells from keel to crown before and behind collars."""
        shares = [1 if self.fin and each is self.collars[-1] else 2 for each in self.collars]
        before = sum(n * each.nose for n, each in zip(shares, self.collars, strict=True))
        return before, sum(n * each.edge for n, each in zip(shares, self.collars, strict=True))

    def with_bands(self, cells: int) -> ColumnPlan:
        """Return the plan with so many `bands`, in the same proportion."""
        first, *others = self.collars
        if self.fin_alone:
            return replace(self, collars=(replace(first, low=cells, top=cells),))
        low = round(first.low * cells / self.bands)
        top = cells - low
        fins = tuple(replace(each, low=top, top=top) for each in others)
        return replace(self, collars=(replace(first, low=low, top=top), *fins))

    def evened(self, widest: float) -> ColumnPlan:
        """Return the plan with cells beside collars of at most `widest` times the mean to keel and crown."""
        return replace(self, collars=tuple(replace(each, widest=widest) for each in self.collars))


def planned_column(
    holes: Sequence[Sequence[Hole]], first: float, growth: float
) -> tuple[ColumnPlan, list[ColumnLevel]]:
    """Return the plan for the holes of a wing, a fin, or both, on some levels from the root on, and these."""
    corners = planned_corners([hole for each in holes for hole in each])
    collars, levels = zip(*(planned_collar(each, corners, first, growth) for each in holes), strict=True)
    plan = ColumnPlan(collars, holes[-1][0].fin)
    made = [ColumnLevel(plan, each) for each in zip(*levels, strict=True)]
    if len(collars) == 2:
        high = max(smooth_cells(*level.above(), WIDEST, FEWEST) for level in made)
        wing, fin = collars
        plan = ColumnPlan((replace(wing, top=high), replace(fin, low=high, top=high)), fin=True)
    return plan, made


@dataclass(frozen=True, eq=False)
class ColumnLevel:
    """A column on one level.

    Parameters
    ----------
    plan : counts.
    levels : of the collars of its wing and fin.
    """

    plan: ColumnPlan
    levels: tuple[CollarLevel, ...]

    @classmethod
    def of(cls, plan: ColumnPlan, holes: Sequence[Hole]) -> ColumnLevel:
        """Return the level of holes, that of a fin last."""
        levels = (CollarLevel.of(*each) for each in zip(plan.collars, holes, strict=True))
        return cls(plan, tuple(levels))

    def above(self) -> tuple[float, tuple[float, float]]:
        """Return the way in space from the wing's collar to that of the fin, and the cells there."""
        wing, fin = self.levels
        low, high = wing.box.high / float(wing.hole.scale[1]), fin.box.low / float(fin.hole.scale[1])
        rho = 0.5 * float(wing.hole.scale[1] + fin.hole.scale[1])
        return (high - low) * rho, (wing.last[2], fin.last[1])

    def _high(self) -> tuple[Floats, Floats]:
        """Return theta (n,) of lines from the wing's collar to that of the fin, and parts of the way."""
        wing, fin = self.levels
        way, cells = self.above()
        arcs = smooth_arcs(np.array([way]), cells, wing.plan.top)[0]
        low, high = wing.box.high / float(wing.hole.scale[1]), fin.box.low / float(fin.hole.scale[1])
        t = arcs / way
        theta = low + (high - low) * t
        theta[-1] = high
        return theta, t * t * (3.0 - 2.0 * t)

    @property
    def sides(self) -> tuple[Side, Side]:
        """Front and back."""
        return self._side(0), self._side(1)

    def _side(self, which: int) -> Side:
        first = self.levels[0]
        low, top = first.low_and_top
        theta = [low, first.across[which][1:-1], top]
        if self.plan.fin_alone:
            theta = [low, first.across[which][1:]]
        values = np.array([[first.sides[which], first.hole.zeta, first.ends[which]]])
        if len(self.levels) == 2:
            fin = self.levels[1]
            high, t = self._high()
            theta = [low, first.across[which][1:-1], high, fin.across[which][1:]]
            other = np.array([[fin.sides[which], fin.hole.zeta, fin.ends[which]]])
            t = np.concatenate([np.zeros(len(low) + len(theta[1])), t, np.ones(len(theta[3]))])[:, None]
            values = values + (other - values) * t
        around = np.concatenate(theta)
        s, zeta, cells = np.broadcast_to(values, (len(around), 3)).T
        return np.stack([s, around, zeta], axis=1), cells

    def patches(self) -> list[Floats]:
        """Return patches (ni, nj, 3): a collar, those above and below it, the collar of a fin above."""
        first = self.levels[0]
        low, top = first.low_and_top
        below, above = first.long_sides
        zeta = first.hole.zeta
        patches = [_on(first.collar(), zeta)]
        if len(self.levels) == 2:
            fin = self.levels[1]
            theta, t = self._high()
            s = above[:, None] + (fin.long_sides[0] - above)[:, None] * t
            patches.append(_lattice(s, theta, zeta + (fin.hole.zeta - zeta) * t))
        elif not self.plan.fin:
            patches.append(_lattice(above[:, None], top, zeta))
        patches.append(_lattice(below[::-1, None], low, zeta))
        return [*patches, *(_on(each.collar(), each.hole.zeta) for each in self.levels[1:])]


def _lattice(s: Floats, theta: Floats, zeta: Floats | float) -> Floats:
    """Return nodes (m, n, 3) of s (m, n or 1), theta (n,) and zeta (n,)."""
    return np.stack(np.broadcast_arrays(s, theta[None], zeta), axis=-1)


def _on(patch: Floats, zeta: float) -> Floats:
    """Return nodes (ni, nj, 3) of a patch (ni, nj, 2) at zeta."""
    return np.concatenate([patch, np.full((*patch.shape[:2], 1), zeta)], axis=-1)
