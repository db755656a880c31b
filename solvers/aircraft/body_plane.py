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

All in (s, theta); collars are made in lengths in space, as units of s and theta have them at the section.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.solvers.aircraft.body_end import BodyEnd
from meshonet.solvers.aircraft.collar_level import FEWEST, WIDEST, CollarPlan, Hole, lines_between
from meshonet.solvers.aircraft.column import ColumnLevel, ColumnPlan, Side, planned_column
from meshonet.solvers.rows.span_spacing import smooth_arcs, smooth_cells

_EVEN = 1.6
"""Largest cell beside a collar of those to keel and crown, over their mean, where there is a fin: as many
lines pass beside it as beside wings, and many of them are far from it."""


_STEEP = 1.12
"""Growth in s of cells between columns where there is a fin: levels lead from a wing to it, steeply in the
middle of the way, where cells are longer in space."""


@dataclass(frozen=True, eq=False)
class LevelPlan:
    """Counts that all levels share, and what nose and tail have in common on all of them.

    Parameters
    ----------
    length : arc length of the meridian.
    columns : of wings and fins, from nose to tail.
    between : cells between neighbouring columns.
    ends : nose and tail.
    """

    length: float
    columns: tuple[ColumnPlan, ...]
    between: tuple[int, ...]
    ends: tuple[BodyEnd, BodyEnd]

    @property
    def patches(self) -> int:
        """Number of patches of a level."""
        return sum(each.patches for each in self.columns) + len(self.between) + 4

    @property
    def collars(self) -> tuple[CollarPlan, ...]:
        """Of each wing and fin."""
        return tuple(collar for column in self.columns for collar in column.collars)

    @property
    def collar_patches(self) -> tuple[int, ...]:
        """Numbers of the patches that are collars, of each wing and fin."""
        out, begin = [], 0
        for column in self.columns:
            out += [begin, begin + column.patches - 1][: len(column.collars)]
            begin += column.patches
        return tuple(out)


def planned(
    holes: Sequence[Sequence[Sequence[Hole]]], length: float, first: float, growth: float
) -> LevelPlan:
    """Return the counts for the holes in each column, from nose to tail, on some levels from the root on."""
    plans, levels = zip(*(planned_column(each, first, growth) for each in holes), strict=True)
    columns = _with_equal_lines(plans)
    most, between = WIDEST, list[int]()
    if any(column.fin for column in columns):
        columns = tuple(column.evened(_EVEN) for column in _level_with_fin(columns, plans))
        most = _STEEP
    for before, after in pairwise(levels):
        ways = [way for pair in zip(before, after, strict=True) for way in _ways(*pair)]
        between.append(max(smooth_cells(way, sizes, most, FEWEST) for way, sizes in ways))
    nose = [way for level in levels[0] for way in _to_pole(level.sides[0], 0.0)]
    tail = [way for level in levels[-1] for way in _to_pole(level.sides[1], length)]
    lines = columns[0].beside[0] + columns[0].bands, columns[-1].beside[1] + columns[-1].bands
    ends = BodyEnd.of(nose, lines[0]), BodyEnd.of(tail, lines[1])
    return LevelPlan(length, columns, tuple(between), ends)


Way: TypeAlias = tuple[float, tuple[float, float]]
"""A way in s, and the lengths of cells at its ends."""


def _ways(before: ColumnLevel, after: ColumnLevel) -> Iterator[Way]:
    """Yield the ways from one column to the next, along the keel and along the crown where they differ."""
    (start, first), (stop, last) = before.sides[1], after.sides[0]
    yield from dict.fromkeys(
        (float(stop[k, 0] - start[k, 0]), (float(first[k]), float(last[k]))) for k in (0, -1)
    )


def _to_pole(side: Side, pole: float) -> list[tuple[float, float]]:
    """Return the ways in s from a pole to a side, and cells there, the shortest first."""
    nodes, cells = side
    ways = np.abs(nodes[:, 0] - pole)
    return sorted({(float(ways[k]), float(cells[k])) for k in (0, -1)})


def _with_equal_lines(plans: Sequence[ColumnPlan]) -> tuple[ColumnPlan, ...]:
    """Return the plans with wider bands, so that as many lines leave each column as come to the next one."""
    more = np.cumsum([0] + [a.beside[1] - b.beside[0] for a, b in pairwise(plans)])
    bands = max(plan.bands - n for plan, n in zip(plans, more.tolist(), strict=True)) + more
    return tuple(plan.with_bands(cells) for plan, cells in zip(plans, bands.tolist(), strict=True))


def _level_with_fin(columns: Sequence[ColumnPlan], plans: Sequence[ColumnPlan]) -> list[ColumnPlan]:
    """Return columns of which those ahead of a fin above a wing have as many lines below as that.

    They keep at least the bands of `plans`.
    """
    out = list(columns)
    for k in range(len(out) - 1, 0, -1):
        own, after = out[k - 1], out[k]
        if after.fin_alone or own.fin or not any(column.fin for column in out[k:]):
            continue
        wanted = after.collars[0].low + after.collars[0].nose - own.collars[0].edge
        low = min(max(wanted, plans[k - 1].collars[0].low), own.bands - plans[k - 1].collars[0].top)
        out[k - 1] = own.with_bands(own.bands, low)
    return out


def level_patches(plan: LevelPlan, holes: Sequence[Sequence[Hole]]) -> list[Floats]:
    """Return patches (ni, nj, 3) of s, theta and zeta on a level around the holes of columns.

    Those of columns, from nose to tail, then the patches between them, then rows and core of the nose, rows
    and core of the tail.
    """
    levels = _beside_fins([ColumnLevel.of(*each) for each in zip(plan.columns, holes, strict=True)])
    patches = [patch for level in levels for patch in level.patches()]
    for cells, before, after in zip(plan.between, levels[:-1], levels[1:], strict=True):
        (start, first), (stop, last) = before.sides[1], after.sides[0]
        s = start[:, :1] + smooth_arcs(stop[:, 0] - start[:, 0], (first, last), cells)
        patches.append(lines_between(s, start, stop))
    nose, tail = plan.ends
    patches += nose.patches(*levels[0].sides[0])
    back, last = levels[-1].sides[1]
    patches += [_from_tail(patch, plan) for patch in tail.patches(_from_tail(back, plan), last)]
    return patches


def _beside_fins(levels: Sequence[ColumnLevel]) -> list[ColumnLevel]:
    """Return the columns, where those of wings next to fins, and of fins next to wings, differ less."""
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


def _from_tail(nodes: Floats, plan: LevelPlan) -> Floats:
    """Return places (..., 3) with s counted from the tail, or back."""
    return nodes * [-1.0, 1.0, 1.0] + [plan.length, 0.0, 0.0]
