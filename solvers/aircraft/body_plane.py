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

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.solvers.aircraft.body_end import BodyEnd
from meshonet.solvers.aircraft.collar_level import (
    FEWEST,
    WIDEST,
    CollarLevel,
    CollarPlan,
    Hole,
    lines_between,
    planned_collar,
)
from meshonet.solvers.rows.span_spacing import smooth_arcs, smooth_cells

WING_PATCHES = 3
"""Patches of a level beside each wing: its collar first."""


@dataclass(frozen=True, eq=False)
class LevelPlan:
    """Counts that all levels share, and what nose and tail have in common on all of them.

    Parameters
    ----------
    length : arc length of the meridian.
    collars : of each wing, from nose to tail.
    between : cells between the collars of neighbouring wings.
    ends : nose and tail.
    """

    length: float
    collars: tuple[CollarPlan, ...]
    between: tuple[int, ...]
    ends: tuple[BodyEnd, BodyEnd]

    @property
    def patches(self) -> int:
        """Number of patches of a level."""
        return WING_PATCHES * len(self.collars) + len(self.between) + 4


def planned(holes: Sequence[Sequence[Hole]], length: float, first: float, growth: float) -> LevelPlan:
    """Return the counts for the holes of each wing, from nose to tail, on some levels from the root on."""
    plans, levels = zip(*(planned_collar(list(each), first, growth) for each in holes), strict=True)
    collars = _with_equal_lines(plans)
    between = []
    for before, after in pairwise(levels):
        ways = [_between(*pair) for pair in zip(before, after, strict=True)]
        between.append(max(smooth_cells(way, sizes, WIDEST, FEWEST) for way, sizes in ways))
    nose = [(level.sides[0], level.ends[0]) for level in levels[0]]
    tail = [(length - level.sides[1], level.ends[1]) for level in levels[-1]]
    ends = (
        BodyEnd.of(nose, 2 * collars[0].nose + collars[0].bands),
        BodyEnd.of(tail, 2 * collars[-1].edge + collars[-1].bands),
    )
    return LevelPlan(length, collars, tuple(between), ends)


def _between(before: CollarLevel, after: CollarLevel) -> tuple[float, tuple[float, float]]:
    """Return the way in s from one collar to the next, and the lengths of the cells there."""
    return after.sides[0] - before.sides[1], (before.ends[1], after.ends[0])


def _with_equal_lines(plans: Sequence[CollarPlan]) -> tuple[CollarPlan, ...]:
    """Return the plans with wider bands, so that as many lines leave each collar as come to the next one."""
    more = np.cumsum([0] + [2 * (a.edge - b.nose) for a, b in pairwise(plans)])
    bands = max(plan.bands - n for plan, n in zip(plans, more.tolist(), strict=True)) + more
    out = []
    for plan, cells in zip(plans, bands.tolist(), strict=True):
        low = round(plan.low * cells / plan.bands)
        out.append(replace(plan, low=low, top=cells - low))
    return tuple(out)


def level_patches(plan: LevelPlan, holes: Sequence[Hole]) -> list[Floats]:
    """Return patches (ni, nj, 3) of s, theta and zeta on a level around holes, from nose to tail.

    Collar, top and low of each wing, then the patches between wings, then rows and core of the nose, rows and
    core of the tail.
    """
    levels = [CollarLevel.of(*each) for each in zip(plan.collars, holes, strict=True)]
    patches = [_on(patch, level.zeta) for level in levels for patch in level.patches()]
    for cells, before, after in zip(plan.between, levels[:-1], levels[1:], strict=True):
        way, sizes = _between(before, after)
        s = before.sides[1] + smooth_arcs(np.array([way]), sizes, cells)[0]
        zeta = lines_between(s, np.array([before.zeta]), np.array([after.zeta]))[..., 1]
        patches.append(_on(lines_between(s, before.across[1], after.across[0]), zeta))
    nose, tail = plan.ends
    first, last = levels[0], levels[-1]
    for patch in nose.patches(first.sides[0], first.ends[0], first.across[0]):
        patches.append(_on(patch, first.zeta))
    for patch in tail.patches(plan.length - last.sides[1], last.ends[1], last.across[1]):
        patches.append(_on(patch * [-1.0, 1.0] + [plan.length, 0.0], last.zeta))
    return patches


def _on(patch: Floats, zeta: Floats | float) -> Floats:
    """Return nodes (ni, nj, 3) of a patch (ni, nj, 2) at zeta."""
    return np.concatenate([patch, np.broadcast_to(zeta, patch.shape[:2])[..., None]], axis=-1)
