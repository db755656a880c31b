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

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import arctan2, cos, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.tanh_law import TanhLaw
from meshonet.geometry.surface.pole_core import PoleCore, core_of
from meshonet.solvers.aircraft.collar import Rectangle, collar, corner_nodes, outer_loop
from meshonet.solvers.rows.span_spacing import spaced_cells, two_sided

MARGIN = 0.28
"""Distance of a collar's outer rectangle from the section, in chords."""
_SHARE = 0.5
"""Part of the way from the section to nose, tail, keel or crown that a collar takes at most."""
_CORNER = 4
"""Least number of nodes from the middle of a nose or edge to the corners of the rectangle."""
_FEWEST = 6
"""Least number of cells between a collar and the plane of symmetry."""
_POLE_CELL = 0.5
"""Cells at nose and tail over those beside the collar."""
_LONGEST = 3.0
"""Largest cells between a collar and nose or tail, over those beside the collar."""
_WIDEST = 1.25
"""Growth of cells from a collar to keel and crown, by which these are counted."""


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
    fans : s (n,) and theta (m,) of the lines of nose and tail on the body, from the poles.
    cores : what replaces their poles, in the plane of polar coordinates s, theta.
    """

    length: float
    edge: int
    nose: int
    rows: int
    low: int
    top: int
    first: float
    growth: float
    fans: tuple[tuple[Floats, Floats], ...] = ()
    cores: tuple[PoleCore, ...] = ()


def planned(sections: list[tuple[Floats, Floats]], length: float, first: float, growth: float) -> LevelPlan:
    """Return the counts for sections from the root on: (n, 2) s and theta, (2,) lengths of their units."""
    root, scale = sections[0]
    edge, nose = corner_nodes(root * scale, rectangle(root, length, scale), _CORNER)
    rows, low, top = 0, _FEWEST, _FEWEST
    half = (len(root) - 1) // 2
    for section, scales in sections:
        plane = section * scales
        box = rectangle(section, length, scales)
        outer = outer_loop(plane, box, (edge, nose))
        size = (box.back - box.front) / (half - edge - nose)
        margin = float(np.median(norms(outer - plane)))
        rows = max(rows, spaced_cells(margin, (first, 1e9), growth, 2.0 * size, 4))
        low = max(low, spaced_cells(box.low, (1e9, size), _WIDEST, box.low / _FEWEST, _FEWEST))
        top = max(top, spaced_cells(np.pi * float(scales[1]) - box.high, (size, 1e9), _WIDEST, 1e9, _FEWEST))
    plan = LevelPlan(length, edge, nose, rows, low, top, first, growth)
    box = rectangle(root, length, scale)
    across = _across(plan, root * scale, box, scale)
    size = (box.back - box.front) / (half - edge - nose) / float(scale[0])
    fans, cores = [], []
    for far, theta in zip(_ways(box, length, scale), across, strict=True):
        ends = _POLE_CELL * size, size
        cells = spaced_cells(far, ends, _WIDEST, _LONGEST * size, _FEWEST)
        s = two_sided(np.array([far]), ends, _WIDEST, cells)[0]
        s[-1] = far
        polar = np.stack(
            [s * cos(theta)[:, None], s * sin(theta)[:, None], np.zeros((len(theta), len(s)))], axis=-1
        )
        fans.append((s, theta))
        cores.append(core_of(polar, 2, max((len(s) - 1) // 2, 3)))
    return LevelPlan(length, edge, nose, rows, low, top, first, growth, tuple(fans), tuple(cores))


def level_patches(plan: LevelPlan, section: Floats, scale: Floats) -> list[Floats]:
    """Return patches (ni, nj, 2) of s and theta on a level around a `section` (n, 2).

    Collar, top, low, rows and core of the nose, rows and core of the tail. `scale` (2,) are the lengths in
    space of units of s and theta at the section.
    """
    plane = section * scale
    box = rectangle(section, plan.length, scale)
    outer = outer_loop(plane, box, (plan.edge, plan.nose))
    ring = collar(plane, outer, plan.rows, plan.first, plan.growth) / scale
    half = (len(plane) - 1) // 2
    low, top = _bands(plan, outer, box, scale)
    upper = ring[plan.edge : half - plan.nose + 1, -1, 0]
    lower = ring[half + plan.nose : 2 * half - plan.edge + 1, -1, 0]
    patches = [ring, _lattice(upper, top), _lattice(lower, low)]
    across = _across(plan, plane, box, scale)
    for k, (far, theta) in enumerate(zip(_ways(box, plan.length, scale), across, strict=True)):
        (s, theta_root), core = plan.fans[k], plan.cores[k]
        t = np.clip((np.arange(len(s)) - core.at) / (len(s) - 1 - core.at), 0.0, 1.0)
        weight = t * t * (3.0 - 2.0 * t)
        lines = _lattice_with(s + weight * (far - s[-1]), theta_root, theta, weight)
        rows = _polar(core.rows[:-1, :, :2]).swapaxes(0, 1)
        rows[0, :, 1], rows[-1, :, 1] = 0.0, np.pi
        for patch in (np.concatenate([rows, lines[:, core.at :]], axis=1), _polar(core.nodes[..., :2])):
            if k:
                patch = patch * [-1.0, 1.0] + [plan.length, 0.0]
            patches.append(patch)
    return patches


def rectangle(section: Floats, length: float, scale: Floats) -> Rectangle:
    """Return the rectangle around a section (n, 2) of s and theta, in lengths in space.

    Raises InputError: the section meets the plane of symmetry.
    """
    (front, low), (back, high) = (section * scale).min(axis=0), (section * scale).max(axis=0)
    end, girth = length * float(scale[0]), np.pi * float(scale[1])
    margin = MARGIN * (back - front)
    if low <= 0.0 or high >= girth or front <= 0.0 or back >= end:
        problem = "the wing meets the plane of symmetry above or below the body, or its nose or tail"
        raise InputError(problem, "move the wing, or make it smaller", place="wings")
    return Rectangle(
        float(front - min(margin, _SHARE * front)),
        float(back + min(margin, _SHARE * (end - back))),
        float(low - min(margin, _SHARE * low)),
        float(high + min(margin, _SHARE * (girth - high))),
    )


def _ways(box: Rectangle, length: float, scale: Floats) -> tuple[float, float]:
    """Return s from the nose, and from the tail, to a rectangle."""
    return box.front / float(scale[0]), length - box.back / float(scale[0])


def _bands(plan: LevelPlan, outer: Floats, box: Rectangle, scale: Floats) -> tuple[Floats, Floats]:
    """Return theta of the lines from the keel to the rectangle, and from there to the crown."""
    half, rho = (len(outer) - 1) // 2, float(scale[1])
    size = (box.back - box.front) / (half - plan.edge - plan.nose)
    out = []
    for cells, way in ((plan.low, box.low), (plan.top, np.pi * rho - box.high)):
        step = min(size, way / cells)
        law = TanhLaw.fitted(cells, step / way, _last(step, way, cells))
        out.append(way * law(np.linspace(0.0, 1.0, cells + 1)))
    low, top = (box.low - out[0][::-1]) / rho, (box.high + out[1]) / rho
    low[0], top[-1] = 0.0, np.pi
    return low, top


def _last(first: float, length: float, cells: int) -> float:
    """Return the last of cells that grow evenly from the first over a length, over this length."""
    even = length / cells
    return min(even * even / first, 0.5 * length) / length


def _across(plan: LevelPlan, plane: Floats, box: Rectangle, scale: Floats) -> tuple[Floats, Floats]:
    """Return theta of the lines of nose and tail, from keel to crown."""
    outer = outer_loop(plane, box, (plan.edge, plan.nose))
    half, rho = (len(outer) - 1) // 2, float(scale[1])
    low, top = _bands(plan, outer, box, scale)
    front = outer[half + plan.nose : half - plan.nose - 1 : -1, 1] / rho
    back = np.concatenate([outer[2 * half - plan.edge : 2 * half, 1], outer[: plan.edge + 1, 1]]) / rho
    return tuple(np.concatenate([low, side[1:-1], top]) for side in (front, back))  # type: ignore[return-value]


def _lattice(s: Floats, theta: Floats) -> Floats:
    return np.stack(np.broadcast_arrays(s[:, None], theta[None]), axis=-1)


def _lattice_with(s: Floats, root: Floats, theta: Floats, weight: Floats) -> Floats:
    """Return nodes (m, n, 2) on lines whose theta goes from that at the root to the level's own."""
    across = root[:, None] + (theta - root)[:, None] * weight
    return np.stack(np.broadcast_arrays(s[None], across), axis=-1)


def _polar(nodes: Floats) -> Floats:
    x, y = nodes[..., 0], nodes[..., 1]
    return np.stack([np.sqrt(x * x + y * y), arctan2(np.where(np.abs(y) < 1e-15, 0.0, y), x)], axis=-1)
