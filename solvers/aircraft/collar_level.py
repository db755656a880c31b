"""The collar of a wing on one level, and the sizes of cells around it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.ties import first_least
from meshonet.solvers.aircraft.collar import (
    Rectangle,
    Within,
    collar,
    corner_nodes,
    lengths,
    outer_cells,
    outer_loop,
    rectangle,
)
from meshonet.solvers.rows.span_spacing import smooth_arcs, smooth_cells
from meshonet.solvers.stacking.tip import least_sine

_CORNER = 4  # smallest number of nodes from the middle of nose or trailing edge to a corner of the rectangle
FEWEST = 6  # smallest number of cells between a collar and the plane of symmetry
_AHEAD = 1.2  # largest ratio of a collar's outermost cell to that of constant growth
_EVEN = 1.15  # largest ratio of neighbouring outermost cells of a collar
WIDEST = 1.25  # growth of cells from a collar to nose, tail, keel and crown
# weights of straight lines, tried in turn: elliptic grids may fold at thin, eccentric trailing edges
_STRAIGHT = 0.0, 0.3, 0.6, 1.0
_SINE, _LINES = 0.15, 0.05  # smallest sines: in a collar, and between its lines before nodes are placed


@dataclass(frozen=True, eq=False)
class Hole:
    """The section of a wing in one of the nested surfaces around the body (such a surface is a level)."""

    section: Floats  # (n, 2) s (along the body) and theta (around it) of its nodes
    scale: Floats  # (2,) length in space of a unit of s, and of theta
    zeta: float  # mean zeta of the section and of the level around it
    within: Within  # limits of s and theta for the collar
    fin: bool = False  # whether it belongs to a fin, whose middle is on the crown: half of its collar is made
    below: float = 0.0  # theta at which the cells below the collar end

    @cached_property
    def box(self) -> Rectangle:
        """Rectangle around the section, as distances along and around the body, in the unit of x, y, z."""
        return rectangle(self.section, self.within, self.scale)

    @property
    def plane(self) -> Floats:
        """Distances (n, 2) of the section's nodes along and around the body, in the unit of x, y, z."""
        return self.section * self.scale

    @property
    def bands(self) -> tuple[float, float]:
        """Widths, measured around the body, of the space for cells below the rectangle `box` and above it."""
        bottom, top = (theta * float(self.scale[1]) for theta in (self.below, self.within[1][1]))
        if self.fin:
            top = self.box.high + self.box.low - bottom
        return self.box.low - bottom, top - self.box.high


@dataclass(frozen=True, eq=False)
class CollarPlan:
    """Numbers of cells in the ring around a wing, the same on all of the nested surfaces around a body."""

    edge: int  # cells from the middle of the collar's rear side to each of its corners
    nose: int  # the same on the front side
    rows: int  # cells across the collar
    low: int  # cells from the keel to the collar
    top: int  # cells from the collar to the crown, or to a fin above
    first: float  # height of the cells at the wing
    straight: float = 0.0  # weight of straight lines (`collar`)
    sine: float = 1.0  # smallest sine of an angle in the collars
    widest: float = math.inf  # largest ratio of the cells above and below the collar to their mean


def planned_corners(holes: Sequence[Hole]) -> tuple[int, int]:
    """Return which nodes of a wing's section are joined by lines to the corners of a rectangle around it.

    The first number counts nodes from the trailing edge, for the rear corners; the second counts nodes from
    the nose, for the front corners. Both are means over the sections `holes`.
    """
    corners = [corner_nodes(hole.plane, hole.box, _CORNER) for hole in holes]
    edge, nose = (round(sum(each) / len(corners)) for each in zip(*corners, strict=True))
    return edge, nose


def planned_collar(
    holes: Sequence[Hole], corners: tuple[int, int], first: float, growth: float
) -> "tuple[CollarPlan, list[CollarLevel]]":
    """Return numbers of cells for grids around all sections of a wing, and these grids, one per section.

    `holes` are the sections of the wing from the root on. `corners` is a result of `planned_corners`. Cells
    at the wing are `first` high and grow by at most `growth`.
    """
    edge, nose = corners
    plan = CollarPlan(edge, nose, 4, FEWEST, FEWEST, first)
    for hole in holes:
        away = float(lengths(hole.plane, outer_loop(hole.plane, hole.box, corners)).max())
        last = min(outer_cells(hole.box, corners))
        plan = replace(plan, rows=max(plan.rows, smooth_cells(away, (first, last), growth, 4)))
    tried: list[tuple[CollarPlan, list[CollarLevel]]] = []
    for straight in _STRAIGHT:
        plan = replace(plan, straight=straight)
        levels = [CollarLevel.of(plan, hole) for hole in holes]
        tried.append((replace(plan, sine=min(level.sine for level in levels)), levels))
        if tried[-1][0].sine > _SINE and min(level.between for level in levels) > _LINES:
            break
    plan, levels = first_least(tried, lambda each: -each[0].sine)
    low, top = (
        max(smooth_cells(level.hole.bands[k], (level.beside[k], None), WIDEST, FEWEST) for level in levels)
        for k in (0, 1)
    )
    return replace(plan, low=low, top=low if holes[0].fin else top), levels


@dataclass(frozen=True, eq=False)
class CollarLevel:
    """A collar: the ring of cells around a wing's section, in one of the nested surfaces around a body."""

    plan: CollarPlan  # numbers of cells
    hole: Hole  # the section
    ring: Floats  # (n, rows + 1, 2) nodes: lengths along and around the body, in the unit of x, y, z
    between: float  # smallest sine between its lines, before nodes are placed on them
    last: tuple[float, float, float, float]  # outermost cells in space: before, below, above, behind

    @classmethod
    def of(cls, plan: CollarPlan, hole: Hole) -> "CollarLevel":
        """Return the cells around the section `hole` of a wing; `plan` has the numbers of cells."""
        plane, box = hole.plane, hole.box
        edge, nose, half = plan.edge, plan.nose, (len(plane) - 1) // 2
        outer = outer_loop(plane, box, (edge, nose))
        behind, before = outer_cells(box, (edge, nose))
        share = np.abs(np.arange(len(plane)) - half) / half
        last = before + (behind - before) * share
        for way, side, cells in zip(
            hole.bands,
            (slice(half + nose, -edge), slice(edge, half - nose + 1)),
            (plan.low, plan.top),
            strict=True,
        ):  # the band there may be short
            last[side] = np.minimum(last[side], _longest(way, cells, plan.widest))
        grown = smooth_arcs(lengths(plane, outer), (plan.first, None), plan.rows)
        last = _graded(np.minimum(last, _AHEAD * (grown[:, -1] - grown[:, -2])))
        ring, between = collar(plane, outer, plan.rows, plan.first, last, plan.straight)
        step = norms(ring[:, -1] - ring[:, -2])
        parts = (
            step[half - nose + 1 : half + nose], step[half + nose : -edge - 1],
            step[edge + 1 : half - nose + 1], np.concatenate([step[:edge], step[-edge:]]),
        )  # fmt: skip
        outer_steps = tuple(float(np.median(part)) for part in parts)
        return cls(plan, hole, ring, between, outer_steps)  # type: ignore[arg-type]

    @property
    def sine(self) -> float:
        """Smallest sine of the corner angles of the collar's cells (cells around a wing's section)."""
        return least_sine(np.pad(self.ring[::-1], ((0, 0), (0, 0), (0, 1))))

    @property
    def sides(self) -> tuple[float, float]:
        """Smallest and largest coordinate s, along the body, of the collar's rectangular outer edge."""
        unit = float(self.hole.scale[0])
        return self.hole.box.front / unit, self.hole.box.back / unit

    @property
    def ends(self) -> tuple[float, float]:
        """Lengths in s, along the body, of the first cells before and behind the collar around the wing."""
        behind, before = outer_cells(self.hole.box, (self.plan.edge, self.plan.nose))
        unit = float(self.hole.scale[0])
        ahead, aft = (math.sqrt(a * b) for a, b in ((self.last[0], before), (self.last[3], behind)))
        return ahead / unit, aft / unit

    @cached_property
    def beside(self) -> tuple[float, float]:
        """Sizes, measured around the body, of cells next to a wing's grid: just below it, just above it."""
        outer, half = self.ring[:, -1, 1], (len(self.ring) - 1) // 2
        edge, nose = self.plan.edge, self.plan.nose
        corners = (half + nose, len(outer) - 1 - edge), (half - nose, edge)
        inwards = (-1, 1), (1, -1)
        low, top = (
            math.sqrt(
                math.prod(abs(float(outer[k + way] - outer[k])) for k, way in zip(at, ways, strict=True))
            )
            for at, ways in zip(corners, inwards, strict=True)
        )
        return math.sqrt(low * self.last[1]), math.sqrt(top * self.last[2])

    @cached_property
    def low_and_top(self) -> tuple[Floats, Floats]:
        """Circumferential angles of nodes: from the keel (0) to the collar, and from it to the crown (pi)."""
        out = []
        for cells, way, step in zip(
            (self.plan.low, self.plan.top), self.hole.bands, self.beside, strict=True
        ):
            step = min(step, _longest(way, cells))
            out.append(smooth_arcs(np.array([way]), (step, None), cells)[0])
        rho = float(self.hole.scale[1])
        low, top = (self.hole.box.low - out[0][::-1]) / rho, (self.hole.box.high + out[1]) / rho
        low[0], top[-1] = 0.0, np.pi
        return low, top

    @property
    def across(self) -> tuple[Floats, Floats]:
        """Ascending angles around the body of nodes on the front edge and the rear edge of a wing's grid."""
        outer, half, rho = self.ring[:, -1, 1], (len(self.ring) - 1) // 2, float(self.hole.scale[1])
        edge, nose = self.plan.edge, self.plan.nose
        front = outer[half + nose : half - nose - 1 : -1] / rho
        back = np.concatenate([outer[2 * half - edge : 2 * half], outer[: edge + 1]]) / rho
        if not self.hole.fin:
            return front, back
        front, back = front[: nose + 1], back[: edge + 1]
        front[-1] = back[-1] = np.pi
        return front, back

    @property
    def long_sides(self) -> tuple[Floats, Floats]:
        """Coordinates s along the body of nodes on the lower and upper edge of a wing's grid, rear first."""
        s, half = self.ring[:, -1, 0] / self.hole.scale[0], (len(self.ring) - 1) // 2
        edge, nose = self.plan.edge, self.plan.nose
        return s[half + nose : 2 * half - edge + 1][::-1], s[edge : half - nose + 1]

    def collar(self) -> Floats:
        """Return nodes (n, rows + 1, 2) around a wing or half a fin, as s along and theta around the body."""
        ring = self.ring / self.hole.scale
        if not self.hole.fin:
            return ring
        ring = ring[(len(ring) - 1) // 2 :]
        ring[[0, -1], :, 1] = np.pi
        return ring


def _longest(way: float, cells: int, widest: float = math.inf) -> float:
    """Return the longest first cell of a band: at most `widest` means, and not shrinking too fast."""
    shrinking = way * (1.0 - 1.0 / WIDEST) / (1.0 - math.pow(WIDEST, -cells))
    return min(shrinking, way * widest / cells)


def _graded(sizes: Floats) -> Floats:
    """Return sizes (n,) around a closed loop, reduced until neighbours are similar."""
    for _ in range(len(sizes)):
        least = _EVEN * np.minimum(np.roll(sizes[:-1], 1), np.roll(sizes[:-1], -1))
        sizes = np.minimum(sizes, np.append(least, least[:1]))
    return sizes
