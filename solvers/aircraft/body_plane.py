"""Nodes of one level around a body: a collar around the section of a wing, and the rest out to nose and tail.

::

    theta = pi   +---------+---------------+---------+
    crown        |         |      top      |         |     nose and tail have cores, whose nodes are the same
                 |  nose   +---------------+  tail   |     (s, theta) on all levels; beside the collar lines
                 |         | collar ( <=> )|         |     follow the section from level to level
                 |         +---------------+         |
                 |         |      low      |         |
    theta = 0    +---------+---------------+---------+
    keel         s = 0                        s = length

All in (s, theta); collars are made in lengths in space, as units of s and theta have them at the section.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import arctan2, cos, sin
from meshonet.geometry.surface.pole_core import PoleCore, core_of
from meshonet.solvers.aircraft.collar import (
    Rectangle,
    collar,
    corner_nodes,
    lengths,
    outer_cells,
    outer_loop,
    rectangle,
)
from meshonet.solvers.rows.span_spacing import smooth_arcs, smooth_cells
from meshonet.solvers.stacking.tip import least_sine

_CORNER = 4
"""Least number of nodes from the middle of a nose or edge to the corners of the rectangle."""
_FEWEST = 6
"""Least number of cells between a collar and the plane of symmetry."""
_POLE_CELL = 0.5
"""Cells at nose and tail over those beside the collar."""
_AHEAD = 1.2
"""Largest outermost cell of a collar, over that of cells which grow by a constant ratio."""
_EVEN = 1.15
"""Largest ratio of neighbouring outermost cells of a collar."""
_WIDEST = 1.25
"""Growth of cells from a collar to nose, tail, keel and crown."""
_STRAIGHT = 0.0, 0.3, 0.6, 1.0
"""Shares of straight lines in collars that are tried, until no angle has a sine below the next number.

Elliptic grids may fold at a thin trailing edge that lies far from the middle of the rectangle.
"""
_SINE = 0.15


@dataclass(frozen=True, eq=False)
class LevelPlan:
    """Counts that all levels share, and what nose and tail have in common on all of them.

    Parameters
    ----------
    length : arc length of the meridian.
    edge, nose : nodes from the middles of trailing edge and nose to the corners of a collar's rectangle.
    rows : cells across a collar.
    low, top : cells from keel and crown to a collar.
    first, growth : height of the cells at the wing, and their growth.
    ends : nose and tail.
    straight : of the lines of collars (`collar`).
    """

    length: float
    edge: int
    nose: int
    rows: int
    low: int
    top: int
    first: float
    growth: float
    ends: tuple[_End, ...] = ()
    straight: float = 0.0


def planned(sections: list[tuple[Floats, Floats]], length: float, first: float, growth: float) -> LevelPlan:
    """Return the counts for sections from the root on: (n, 2) s and theta, (2,) lengths of their units."""
    corners = [corner_nodes(s * c, rectangle(s, length, c), _CORNER) for s, c in sections]
    edge, nose = (round(sum(each) / len(corners)) for each in zip(*corners, strict=True))
    plan = LevelPlan(length, edge, nose, 4, _FEWEST, _FEWEST, first, growth)
    for section, scales in sections:
        plane = section * scales
        box = rectangle(section, length, scales)
        away = float(lengths(plane, outer_loop(plane, box, (edge, nose))).max())
        last = min(outer_cells(box, (edge, nose)))
        plan = replace(plan, rows=max(plan.rows, smooth_cells(away, (first, last), growth, 4)))
    for straight in _STRAIGHT:
        plan = replace(plan, straight=straight)
        levels = [_Level.of(plan, section, scales) for section, scales in sections]
        if all(level.sine > _SINE for level in levels):
            break
    low, top = (
        max(smooth_cells(level.bands[k], (level.last[1 + k], None), _WIDEST, _FEWEST) for level in levels)
        for k in (0, 1)
    )
    plan = replace(plan, low=low, top=top)
    ends = tuple(
        _End.of([(level.ways[k], level.ends[k]) for level in levels], 2 * corner + low + top)
        for k, corner in enumerate((nose, edge))
    )
    return replace(plan, ends=ends)


@dataclass(frozen=True, eq=False)
class _End:
    """Nose or tail: what all levels have in common there.

    Parameters
    ----------
    theta : (n,) angles of the lines out of the pole.
    core : what replaces the pole, in the plane of polar coordinates s, theta.
    at, step : s where the core's rows end, and its last step there.
    cells : number of cells from there to the collar.
    """

    theta: Floats
    core: PoleCore
    at: float
    step: float
    cells: int

    @classmethod
    def of(cls, levels: list[tuple[float, float]], lines: int) -> _End:
        """Return the end for ways from the pole to the collar, and cells there, of some levels."""
        way, last = levels[0]
        theta = np.linspace(0.0, np.pi, lines + 1)
        pole = _POLE_CELL * last
        count = smooth_cells(way, (pole, last), _WIDEST, 2 * _FEWEST)
        s = smooth_arcs(np.array([way]), (pole, last), count)[0]
        polar = np.stack(
            [s * cos(theta)[:, None], s * sin(theta)[:, None], np.zeros((len(theta), len(s)))], axis=-1
        )
        core = core_of(polar, 2, max(count // 2, 3))
        at, step = float(s[core.at]), float(s[core.at + 1] - s[core.at])
        cells = max(smooth_cells(far - at, (step, size), _WIDEST, _FEWEST) for far, size in levels)
        return cls(theta, core, at, step, cells)

    def patches(self, far: float, last: float, theta: Floats) -> tuple[Floats, Floats]:
        """Return rows and core (., ., 2) in s from the pole and theta, out to `far` with `theta` there."""
        arcs = self.at + smooth_arcs(np.array([far - self.at]), (self.step, last), self.cells)[0]
        t = (arcs - arcs[0]) / (arcs[-1] - arcs[0])
        arcs[-1] = far
        lines = _lattice_with(arcs, self.theta, theta, t * t * (3.0 - 2.0 * t))
        rows = _polar(self.core.rows[:-1, :, :2]).swapaxes(0, 1)
        rows[0, :, 1], rows[-1, :, 1] = 0.0, np.pi
        return np.concatenate([rows, lines], axis=1), _polar(self.core.nodes[..., :2])


@dataclass(frozen=True, eq=False)
class _Level:
    """One level: its collar, and the sizes of cells around it.

    Parameters
    ----------
    plan, box, scale : counts, the rectangle, lengths in space of units of s and theta.
    ring : (n, rows + 1, 2) the collar, in lengths in space.
    last : lengths in space of its outermost cells at the front, below, above and at the back.
    """

    plan: LevelPlan
    box: Rectangle
    scale: Floats
    ring: Floats
    last: tuple[float, float, float, float]

    @classmethod
    def of(cls, plan: LevelPlan, section: Floats, scale: Floats) -> _Level:
        """Return the level of a section (n, 2)."""
        plane = section * scale
        box = rectangle(section, plan.length, scale)
        edge, nose, half = plan.edge, plan.nose, (len(plane) - 1) // 2
        outer = outer_loop(plane, box, (edge, nose))
        behind, before = outer_cells(box, (edge, nose))
        share = np.abs(np.arange(len(plane)) - half) / half
        last = before + (behind - before) * share
        for way, side, cells in (
            (box.low, slice(half + nose, -edge), plan.low),
            (np.pi * float(scale[1]) - box.high, slice(edge, half - nose + 1), plan.top),
        ):  # the band there may be short
            last[side] = np.minimum(
                last[side], way * (1.0 - 1.0 / _WIDEST) / (1.0 - math.pow(_WIDEST, -cells))
            )
        grown = smooth_arcs(lengths(plane, outer), (plan.first, None), plan.rows)
        last = _graded(np.minimum(last, _AHEAD * (grown[:, -1] - grown[:, -2])))
        ring = collar(plane, outer, plan.rows, plan.first, last, plan.straight)
        step = norms(ring[:, -1] - ring[:, -2])
        parts = (
            step[half - nose + 1 : half + nose], step[half + nose : -edge - 1],
            step[edge + 1 : half - nose + 1], np.concatenate([step[:edge], step[-edge:]]),
        )  # fmt: skip
        return cls(plan, box, scale, ring, tuple(float(np.median(part)) for part in parts))  # type: ignore[arg-type]

    @property
    def sine(self) -> float:
        """The least sine of an angle in the collar."""
        return least_sine(np.pad(self.ring[::-1], ((0, 0), (0, 0), (0, 1))))

    @property
    def ways(self) -> tuple[float, float]:
        """Lengths in s from the nose, and from the tail, to the rectangle."""
        unit = float(self.scale[0])
        return self.box.front / unit, self.plan.length - self.box.back / unit

    @property
    def ends(self) -> tuple[float, float]:
        """Lengths in s of the cells of nose and tail beside the rectangle.

        They lie between those of the collar and those of the bands above and below it.
        """
        behind, before = outer_cells(self.box, (self.plan.edge, self.plan.nose))
        ahead, aft = (math.sqrt(a * b) for a, b in ((self.last[0], before), (self.last[3], behind)))
        return ahead / float(self.scale[0]), aft / float(self.scale[0])

    @property
    def bands(self) -> tuple[float, float]:
        """Lengths in space from the rectangle to keel and crown."""
        return self.box.low, np.pi * float(self.scale[1]) - self.box.high

    @cached_property
    def low_and_top(self) -> tuple[Floats, Floats]:
        """Theta of the lines from the keel to the rectangle, and from there to the crown."""
        out = []
        for cells, way, step in zip((self.plan.low, self.plan.top), self.bands, self.last[1:3], strict=True):
            out.append(smooth_arcs(np.array([way]), (step, None), cells)[0])
        rho = float(self.scale[1])
        low, top = (self.box.low - out[0][::-1]) / rho, (self.box.high + out[1]) / rho
        low[0], top[-1] = 0.0, np.pi
        return low, top

    @property
    def across(self) -> tuple[Floats, Floats]:
        """Theta of the lines of nose and tail, from keel to crown."""
        outer, half, rho = self.ring[:, -1, 1], (len(self.ring) - 1) // 2, float(self.scale[1])
        edge, nose = self.plan.edge, self.plan.nose
        low, top = self.low_and_top
        front = outer[half + nose : half - nose - 1 : -1] / rho
        back = np.concatenate([outer[2 * half - edge : 2 * half], outer[: edge + 1]]) / rho
        ahead, behind = (np.concatenate([low, side[1:-1], top]) for side in (front, back))
        return ahead, behind


def level_patches(plan: LevelPlan, section: Floats, scale: Floats) -> list[Floats]:
    """Return patches (ni, nj, 2) of s and theta on a level around a `section` (n, 2).

    Collar, top, low, rows and core of the nose, rows and core of the tail. `scale` (2,) are the lengths in
    space of units of s and theta at the section.
    """
    level = _Level.of(plan, section, scale)
    ring, half = level.ring / scale, (len(section) - 1) // 2
    low, top = level.low_and_top
    upper = ring[plan.edge : half - plan.nose + 1, -1, 0]
    lower = ring[half + plan.nose : 2 * half - plan.edge + 1, -1, 0]
    patches = [ring, _lattice(upper, top), _lattice(lower, low)]
    for k, end in enumerate(plan.ends):
        for patch in end.patches(level.ways[k], level.ends[k], level.across[k]):
            patches.append(patch * [-1.0, 1.0] + [plan.length, 0.0] if k else patch)
    return patches


def _graded(sizes: Floats) -> Floats:
    """Return sizes (n,) around a closed loop, made smaller until neighbours differ little."""
    for _ in range(len(sizes)):
        least = _EVEN * np.minimum(np.roll(sizes[:-1], 1), np.roll(sizes[:-1], -1))
        sizes = np.minimum(sizes, np.append(least, least[:1]))
    return sizes


def _lattice(s: Floats, theta: Floats) -> Floats:
    return np.stack(np.broadcast_arrays(s[:, None], theta[None]), axis=-1)


def _lattice_with(s: Floats, root: Floats, theta: Floats, weight: Floats) -> Floats:
    """Return nodes (m, n, 2) on lines whose theta goes from that at the root to the level's own."""
    across = root[:, None] + (theta - root)[:, None] * weight
    return np.stack(np.broadcast_arrays(s[None], across), axis=-1)


def _polar(nodes: Floats) -> Floats:
    x, y = nodes[..., 0], nodes[..., 1]
    return np.stack([np.sqrt(x * x + y * y), arctan2(np.where(np.abs(y) < 1e-15, 0.0, y), x)], axis=-1)
