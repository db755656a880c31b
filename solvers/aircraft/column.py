"""A column of a level, from keel to crown: the collar of a wing, of a fin, or of a fin above a wing.

::

    theta = pi   +-----------+    +--( <=> )--+    +--( <=> )--+   crown
                 |    top    |    |    fin    |    |    fin    |
                 +-----------+    +-----------+    +-----------+
                 |  ( <=> )  |    |           |     /   high    /    lines from the rectangle of the wing
                 +-----------+    |    low    |    +-----------+     to that of the fin: both have equal
                 |    low    |    |           |    |  ( <=> )  |     numbers of nodes on these sides
                 |           |    |           |    +-----------+
                 |           |    |           |    |    low    |
    theta = 0    +-----------+    +-----------+    +-----------+   keel

Along the front and the back of `high`, s and zeta change smoothly from those of the wing's rectangle to those
of the fin's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats, smooth_step
from meshonet.geometry.elementary import exp, log
from meshonet.solvers.aircraft.collar_level import (
    FEWEST,
    WIDEST,
    CollarLevel,
    CollarPlan,
    Hole,
    planned_collar,
    planned_corners,
)
from meshonet.solvers.aircraft.level_lines import Side
from meshonet.solvers.rows.span_spacing import smooth_arcs, smooth_cells

_FOLLOWING = 0.7  # weight of the theta beside a fin in the theta below it; the rest are evenly changing cells
_HALVINGS = 40  # steps of the bisection for the factor of the cells below a fin


@dataclass(frozen=True, eq=False)
class ColumnPlan:
    """Numbers of cells of the blocks around a wing and a fin, from the bottom of the body to its top."""

    collars: tuple[CollarPlan, ...]  # plans of the collars of the wing, of the fin, or of both, the fin last
    fin: bool  # whether there is a fin

    @property
    def patches(self) -> int:
        """Number of patches from bottom to top of the body, on each of the nested surfaces around it."""
        return 4 if len(self.collars) == 2 else 2 if self.fin else 3

    @property
    def bands(self) -> int:
        """Number of cells from keel to crown, without the collars (the cells around wings and fins)."""
        return self.collars[0].low + (0 if self.fin_alone else self.collars[0].top)

    @property
    def fin_alone(self) -> bool:
        """Whether there is a fin and no wing."""
        return self.fin and len(self.collars) == 1

    @property
    def beside(self) -> tuple[int, int]:
        """Cells along the front, and along the rear edges, of all collars (grids around wing and fin)."""
        shares = [1 if self.fin and each is self.collars[-1] else 2 for each in self.collars]
        before = sum(n * each.nose for n, each in zip(shares, self.collars, strict=True))
        return before, sum(n * each.edge for n, each in zip(shares, self.collars, strict=True))

    def with_bands(self, cells: int, low: int | None = None) -> ColumnPlan:
        """Return the plan with `cells` cells below and above the wing's grid, `low` of them below it."""
        first, *others = self.collars
        if self.fin_alone:
            return replace(self, collars=(replace(first, low=cells, top=cells),))
        low = round(first.low * cells / self.bands) if low is None else low
        top = cells - low
        fins = tuple(replace(each, low=top, top=top) for each in others)
        return replace(self, collars=(replace(first, low=low, top=top), *fins))

    def evened(self, widest: float) -> ColumnPlan:
        """Return a plan that limits the heights of cells at the upper and the lower edge of a wing's grid.

        The limit is `widest` times the mean height of cells from there to the body's top or bottom.
        """
        return replace(self, collars=tuple(replace(each, widest=widest) for each in self.collars))


def planned_column(
    holes: Sequence[Sequence[Hole]], first: float, growth: float
) -> tuple[ColumnPlan, list[ColumnLevel]]:
    """Return numbers of cells for patches at a wing, a fin or both, and the patches on each surface.

    The surfaces are nested around the body. `holes` has the sections of the wing in all surfaces, then those
    of the fin. Cells next to these sections are `first` high and grow by at most `growth`.
    """
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
    """Patches at a wing, a fin or both, from the bottom of a body (keel) to its top (crown).

    They lie on one of the nested surfaces around the body. s is along, theta around, zeta away from the body.
    """

    plan: ColumnPlan  # numbers of cells
    levels: tuple[CollarLevel, ...]  # cells around the wing, the fin, or both, the fin last
    below: Floats | None = None  # prescribed theta of the nodes from the keel to these cells
    keel: float | None = None  # zeta at the keel, if other than at the first of these cells
    crown: float | None = None  # zeta at the crown, if other than there

    @classmethod
    def of(cls, plan: ColumnPlan, holes: Sequence[Hole]) -> ColumnLevel:
        """Return the patches on a surface around the body; `holes` are the sections of wing or fin there."""
        levels = (CollarLevel.of(*each) for each in zip(plan.collars, holes, strict=True))
        return cls(plan, tuple(levels))

    def with_counts(self, plan: ColumnPlan) -> ColumnLevel:
        """Return a copy with numbers of cells from `plan`; the cells around wing and fin do not change."""
        levels = (replace(each, plan=counts) for each, counts in zip(self.levels, plan.collars, strict=True))
        return replace(self, plan=plan, levels=tuple(levels))

    def beside_fin(self, fin: ColumnLevel) -> ColumnLevel:
        """Return the patches of a wing, with a new zeta (coordinate away from the body) at their upper edge.

        It is the mean of the values at this wing and at a `fin` ahead of the wing or behind it.
        """
        zeta = self.zeta
        return replace(self, crown=zeta + 0.5 * (fin.levels[-1].hole.zeta - zeta))

    def beside_wing(self, wing: ColumnLevel, side: Side) -> ColumnLevel:
        """Return the patches of a fin, with nodes more similar to those at a neighbouring `wing`.

        Below the fin, nodes get other angles around the body. Near the bottom of the body they also get
        another zeta (the coordinate away from it). `side` is the edge of the wing's patches next to the fin.
        """
        own, others = self.low, side[0][: len(self.low), 1]
        keel = self.zeta + _FOLLOWING * (wing.zeta - self.zeta)
        return replace(self, below=_followed(own, others), keel=keel)

    @property
    def zeta(self) -> float:
        """Mean zeta (0 on the body, 1 in the far field) of the wing's section; without wing, of the fin's."""
        return self.levels[0].hole.zeta

    @property
    def low(self) -> Floats:
        """Angles theta, from 0 (keel) upwards, of the nodes below the wing; without a wing, below the fin."""
        return self.levels[0].low_and_top[0] if self.below is None else self.below

    def above(self) -> tuple[float, tuple[float, float]]:
        """Return the gap from a wing's cells up to a fin's, and the heights of first and last cell in it."""
        wing, fin = self.levels
        low, high = self._gap
        rho = 0.5 * float(wing.hole.scale[1] + fin.hole.scale[1])
        return (high - low) * rho, (wing.beside[1], fin.beside[0])

    @property
    def _gap(self) -> tuple[float, float]:
        """Theta at which the wing's rectangle ends and the fin's begins."""
        wing, fin = (each.hole for each in self.levels)
        return wing.box.high / float(wing.scale[1]), fin.box.low / float(fin.scale[1])

    def _above(self) -> tuple[Floats, Floats]:
        """Return theta (n,) of lines above the first collar, and weights (n,) from 0 to 1."""
        if len(self.levels) == 1:
            theta = self.levels[0].low_and_top[1]
            return theta, _fade(theta)
        (way, cells), (low, high) = self.above(), self._gap
        arcs = smooth_arcs(np.array([way]), cells, self.levels[0].plan.top)[0]
        theta = low + (high - low) * (arcs / way)
        theta[-1] = high
        return theta, _fade(theta)

    @property
    def sides(self) -> tuple[Side, Side]:
        """For the front edge of the patches, then the rear edge: nodes (n, 3), and cell lengths in s (n,).

        Nodes are s, theta, zeta (along, around and away from the body), from its bottom to its top.
        """
        return self._side(0), self._side(1)

    def _side(self, which: int) -> Side:
        first, last = self.levels[0], self.levels[-1]
        own, keel = (
            np.array([first.sides[which], zeta, first.ends[which]]) for zeta in (self.zeta, self._keel_zeta)
        )
        beside = first.across[which]
        parts = [(self.low, own + (keel - own) * _fade(self.low[::-1])[::-1, None])]
        if self.plan.fin_alone:
            parts.append((beside[1:], np.tile(own, (len(beside) - 1, 1))))
        else:
            theta, fade = self._above()
            high = np.array([last.sides[which], self._high_zeta, last.ends[which]])
            parts.append((beside[1:-1], np.tile(own, (len(beside) - 2, 1))))
            parts.append((theta, own + (high - own) * fade[:, None]))
            if last is not first:
                beside = last.across[which][1:]
                parts.append((beside, np.tile(high, (len(beside), 1))))
        around = np.concatenate([theta for theta, _ in parts])
        s, zeta, cells = np.concatenate([values for _, values in parts]).T
        return np.stack([s, around, zeta], axis=1), cells

    @property
    def _keel_zeta(self) -> float:
        return self.zeta if self.keel is None else self.keel

    @property
    def _high_zeta(self) -> float:
        """Zeta of a fin above a wing, or of the crown."""
        if len(self.levels) == 2:
            return self.levels[1].hole.zeta
        return self.zeta if self.crown is None else self.crown

    def patches(self) -> list[Floats]:
        """Return nodes (ni, nj, 3) of patches: around the wing, above it, below it, and around the fin.

        Without a wing: around the fin, and below it. Coordinates are along, around and away from the body.
        """
        below, above = self.levels[0].long_sides
        zeta = self.zeta
        patches = [_on(self.levels[0].collar(), zeta)]
        if not self.plan.fin_alone:
            theta, fade = self._above()
            end = self.levels[1].long_sides[0] if len(self.levels) == 2 else above
            s = above[:, None] + (end - above)[:, None] * fade
            patches.append(_lattice(s, theta, zeta + (self._high_zeta - zeta) * fade))
        fade = _fade(self.low[::-1])[::-1]
        patches.append(_lattice(below[::-1, None], self.low, zeta + (self._keel_zeta - zeta) * fade))
        return [*patches, *(_on(each.collar(), each.hole.zeta) for each in self.levels[1:])]


def _fade(theta: Floats) -> Floats:
    """Return smooth weights (n,) from 0 at the first to 1 at the last of angles (n,)."""
    return smooth_step((theta - theta[0]) / (theta[-1] - theta[0]))


def _followed(own: Floats, others: Floats) -> Floats:
    """Return angles (n,) between `own` and `others`, with the last cell of `own` and growth to `WIDEST`."""
    mine, wanted = (log(np.diff(each)[::-1]) for each in (own, others))
    cone = log(np.float64(WIDEST)) * np.arange(len(mine))
    wanted = mine + _FOLLOWING * (wanted - mine)
    low, high = -10.0, 10.0
    for _ in range(_HALVINGS):
        more = 0.5 * (low + high)
        steps = exp(np.clip(wanted + more, mine[0] - cone, mine[0] + cone))
        low, high = (more, high) if float(steps.sum()) < own[-1] else (low, more)
    steps *= own[-1] / float(steps.sum())
    out = np.concatenate([[0.0], np.cumsum(steps[::-1])])
    out[-1] = own[-1]
    return out


def _lattice(s: Floats, theta: Floats, zeta: Floats | float) -> Floats:
    return np.stack(np.broadcast_arrays(s, theta[None], zeta), axis=-1)


def _on(patch: Floats, zeta: float) -> Floats:
    return np.concatenate([patch, np.full((*patch.shape[:2], 1), zeta)], axis=-1)
