"""Nodes of one level around a body: collars around the sections of wings, and the rest out to nose and tail.

::

    theta = pi   +------+---------------+---------+--------+------+
    crown        |      |      top      |         |  top   |      |     nose and tail have cores, whose nodes
                 | nose +---------------+ between +--------+ tail |     are the same (s, theta) on all levels;
                 |      | collar ( <=> )|         | ( <=> )|      |     beside collars lines follow the
                 |      +---------------+         +--------+      |     sections from level to level
                 |      |      low      |         |  low   |      |
    theta = 0    +------+---------------+---------+--------+------+
    keel         s = 0                                    s = length

All places are (s, theta). For collars, both are scaled to lengths, by factors that hold at the section.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import arctan2, cos, sin
from meshonet.geometry.surface.pole_core import PoleCore, core_of
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.collar_level import FEWEST, WIDEST, CollarPlan, Hole
from meshonet.solvers.aircraft.column import ColumnLevel, ColumnPlan, planned_column
from meshonet.solvers.aircraft.level_lines import Points, Side, lines_between, ways_between
from meshonet.solvers.rows.span_spacing import smooth_arcs, smooth_cells

# beside a fin: largest ratio of the cells next to a collar to the mean cell towards keel and crown
_EVEN = 1.6
_POLE_CELL = 0.5  # ratio of the cells at nose and tail to the cells beside the collar


@dataclass(frozen=True, eq=False)
class LevelPlan:
    """Numbers of cells on a level (surface around the body); they are the same on all levels."""

    columns: tuple[ColumnPlan, ...]  # plans of the columns, from nose to tail
    between: tuple[int, ...]  # number of cells between each column and the next
    ends: "tuple[BodyEnd, BodyEnd]"  # nose and tail

    @property
    def patches(self) -> int:
        """Number of patches of each level (a surface around the body)."""
        return sum(each.patches for each in self.columns) + len(self.between) + 4

    @property
    def collars(self) -> tuple[CollarPlan, ...]:
        """Plans of the collars of all wings and fins."""
        return tuple(collar for column in self.columns for collar in column.collars)

    @property
    def collar_patches(self) -> tuple[int, ...]:
        """For each wing and fin, the index of the patch that is its collar (the cells around its section)."""
        out, begin = [], 0
        for column in self.columns:
            out += [begin, begin + column.patches - 1][: len(column.collars)]
            begin += column.patches
        return tuple(out)


def planned(
    space: BodyMap, holes: Sequence[Sequence[Sequence[Hole]]], first: float, growth: float
) -> LevelPlan:
    """Return numbers of cells for grids on nested surfaces around a body, through which wings pass.

    Parameters
    ----------
    space : map around the body.
    holes : sections of wings in the surfaces, ``holes[column][wing][surface]``. A column is a wing, a fin, or
        a wing with a fin above it. Columns are from nose to tail, surfaces from the body outwards.
    first, growth : height of first cells, and largest growth ratio.
    """
    plans, levels = zip(*(planned_column(each, first, growth) for each in holes), strict=True)
    columns = _with_equal_lines(plans)
    if any(column.fin for column in columns):
        columns = tuple(column.evened(_EVEN) for column in _level_with_fin(columns, plans))
    known = [
        _beside_fins([level.with_counts(plan) for plan, level in zip(columns, each, strict=True)])
        for each in zip(*levels, strict=True)
    ]
    between = tuple(
        _cells_between(
            space.points, [level[k].sides[1] for level in known], [level[k + 1].sides[0] for level in known]
        )
        for k in range(len(columns) - 1)
    )
    length = space.body.length
    tail = [(_from_tail(nodes, length), cells) for nodes, cells in (level[-1].sides[1] for level in known)]
    ends = (
        BodyEnd.of(space.points, [level[0].sides[0] for level in known]),
        BodyEnd.of(_points_from_tail(space), tail),
    )
    return LevelPlan(columns, between, ends)


def _cells_between(points: Points, sides: Sequence[Side], others: Sequence[Side]) -> int:
    """Return the number of cells of lines between two sides, from these on some levels."""
    (begin, first), (end, last) = (
        tuple(np.concatenate(each) for each in zip(*some, strict=True)) for some in (sides, others)
    )
    return smooth_cells(*ways_between(points, begin, end, (first, last)), WIDEST, FEWEST)


def _points_from_tail(space: BodyMap) -> Points:
    return lambda places: space.points(_from_tail(places, space.body.length))


def _with_equal_lines(plans: Sequence[ColumnPlan]) -> tuple[ColumnPlan, ...]:
    """Return the plans with bands so wide that as many lines leave each column as reach the next."""
    more = np.cumsum([0] + [a.beside[1] - b.beside[0] for a, b in pairwise(plans)])
    bands = max(plan.bands - n for plan, n in zip(plans, more.tolist(), strict=True)) + more
    return tuple(plan.with_bands(cells) for plan, cells in zip(plans, bands.tolist(), strict=True))


def _level_with_fin(columns: Sequence[ColumnPlan], plans: Sequence[ColumnPlan]) -> list[ColumnPlan]:
    """Return the columns; those ahead of a wing with a fin get as many lines below as it has."""
    out = list(columns)
    for k in range(len(out) - 1, 0, -1):
        own, after = out[k - 1], out[k]
        if after.fin_alone or own.fin or not any(column.fin for column in out[k:]):
            continue
        wanted = after.collars[0].low + after.collars[0].nose - own.collars[0].edge
        low = min(max(wanted, plans[k - 1].collars[0].low), own.bands - plans[k - 1].collars[0].top)
        out[k - 1] = own.with_bands(own.bands, low)
    return out


def level_patches(space: BodyMap, plan: LevelPlan, holes: Sequence[Sequence[Hole]]) -> list[Floats]:
    """Return the patches of one surface around a body, as coordinates s, theta, zeta (see `BodyMap`).

    Each patch is (ni, nj, 3). `holes` are the sections of wings, which are left open. The order of patches
    is: around wings, from nose to tail; between wings; two at the nose; two at the tail.
    """
    levels = _beside_fins([ColumnLevel.of(*each) for each in zip(plan.columns, holes, strict=True)])
    patches = [patch for level in levels for patch in level.patches()]
    for cells, before, after in zip(plan.between, levels[:-1], levels[1:], strict=True):
        (start, first), (stop, last) = before.sides[1], after.sides[0]
        patches.append(lines_between(space.points, start, stop, (first, last), cells))
    nose, tail = plan.ends
    patches += nose.patches(space.points, *levels[0].sides[0])
    (back, last), length = levels[-1].sides[1], space.body.length
    made = tail.patches(_points_from_tail(space), _from_tail(back, length), last)
    return [*patches, *(_from_tail(patch, length) for patch in made)]


def _beside_fins(levels: Sequence[ColumnLevel]) -> list[ColumnLevel]:
    """Return the columns, with more similar zeta where one has a fin and the next has none."""
    out = list(levels)
    for k, level in enumerate(levels):
        near = [other for other in (k - 1, k + 1) if 0 <= other < len(levels)]
        if not level.plan.fin:
            fins = [levels[other] for other in near if levels[other].plan.fin]
            out[k] = level.beside_fin(fins[0]) if fins else level
        elif level.plan.fin_alone and near:
            wing = levels[near[0]]
            out[k] = level.beside_wing(wing, wing.sides[1 if near[0] < k else 0])
    return out


def _from_tail(nodes: Floats, length: float) -> Floats:
    """Return places (..., 3) with s counted from the other end."""
    return nodes * [-1.0, 1.0, 1.0] + [length, 0.0, 0.0]


@dataclass(frozen=True, eq=False)
class BodyEnd:
    """Plan of two patches at the nose or tail of a body: around the tip, and from there to a wing."""

    theta: Floats  # (n,) angles of the lines from the pole, the tip of nose or tail
    core: PoleCore  # block that covers the pole, in a plane with polar coordinates s, theta
    at: float  # s at which the rows around the core end
    step: float  # last step of s in these rows
    cells: int  # number of cells from these rows to the next collar

    @classmethod
    def of(cls, points: Points, sides: Sequence[Side]) -> Self:
        """Return the plan of the patches between the tip of nose or tail and the nearest wing.

        Nodes are s, theta, zeta: along, around and away from the body, s = 0 at the tip. `points` maps them
        to x, y, z. For each of the nested surfaces around the body, from the innermost, `sides` has a
        pair: the nodes (n, 3) on the edge towards the wing, and the lengths in s (n,) of the cells there.
        """
        nodes, cells = sides[0]
        way, last = min((float(nodes[k, 0]), float(cells[k])) for k in (0, -1))
        theta = np.linspace(0.0, np.pi, len(sides[0][1]))
        pole = _POLE_CELL * last
        count = smooth_cells(way, (pole, last), WIDEST, 2 * FEWEST)
        s = smooth_arcs(np.array([way]), (pole, last), count)[0]
        polar = np.stack(
            [s * cos(theta)[:, None], s * sin(theta)[:, None], np.zeros((len(theta), len(s)))], axis=-1
        )
        core = core_of(polar, 2, max(count // 2, 3), even=True)
        end = cls(theta, core, float(s[core.at]), float(s[core.at + 1] - s[core.at]), 0)
        return replace(end, cells=_cells_between(points, [end._begin(side) for side, _ in sides], sides))

    def _begin(self, side: Floats) -> Side:
        """Return the begin (n, 3) of lines to a `side` (n, 3), and their first cells (n,) in s."""
        zeta = 0.5 * float(side[0, 2] + side[-1, 2])
        begin = np.stack([np.full(len(side), self.at), self.theta, np.full(len(side), zeta)], axis=1)
        return begin, np.full(len(side), self.step)

    def patches(self, points: Points, side: Floats, last: Floats) -> tuple[Floats, Floats]:
        """Return two patches (ni, nj, 3): one that ends at the nodes `side` (n, 3), and one around the tip.

        `last` (n,) are the lengths in s of the cells that end at `side`. Nodes are s, theta, zeta: along,
        around and away from the body, with s = 0 at the tip of nose or tail. `points` maps nodes to x, y, z.
        """
        begin, first = self._begin(side)
        lines = lines_between(points, begin, side, (first, last), self.cells)
        zeta = float(begin[0, 2])
        rows = _polar(self.core.rows[:-1, :, :2], zeta).swapaxes(0, 1)
        rows[0, :, 1], rows[-1, :, 1] = 0.0, np.pi
        return np.concatenate([rows, lines], axis=1), _polar(self.core.nodes[..., :2], zeta)


def _polar(nodes: Floats, zeta: float) -> Floats:
    x, y = nodes[..., 0], nodes[..., 1]
    theta = arctan2(np.where(np.abs(y) < 1e-15, 0.0, y), x)
    return np.stack([np.sqrt(x * x + y * y), theta, np.full(x.shape, zeta)], axis=-1)
