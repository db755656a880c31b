"""The start of a C grid around a blunt section: wall, base, and wake lines from both corners of the base.

Wake lines start along their surfaces, or turned off a rounded one, and turn into the axis of the wake, as far
apart as the base is wide. Their mean is the line behind a sharp edge (`shapes.wake.wake_line`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import Floats, along_and_across
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.elementary import expm1
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Advice
from meshonet.geometry.polygon.self_intersection import find_crossing
from meshonet.geometry.shapes.airfoil.wall_plan import arcs_to_corners
from meshonet.geometry.shapes.wake import BEHIND_BASE, c_far_field, growing, rise, wake_axis
from meshonet.geometry.spacing.growth import LARGEST, cells_for_growth
from meshonet.geometry.spacing.sampling import (
    DEFAULT_NI,
    DEFAULT_NJ,
    MULTIPLES,
    Sampling,
    first_within,
    nodes_beside,
)
from meshonet.kernels._native import layer_steps

if TYPE_CHECKING:
    from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

GROWTH = 1.2  # growth ratio along wake and base unless given
_WITHIN = 0.92  # fraction of the growth beyond 1 used along wake and base: the lines bend, which adds growth
_STEEPEST = math.radians(85.0)  # largest angle between a wake line at its corner and the axis of the wake
_LEAST_ANGLE = math.radians(60.0)
"""Smallest angle between base and wake line; lines with a smaller one are turned off the surface."""
_MOST_TURNED = math.radians(40.0)
"""Largest such turn. Measured on 90 bases of .02 to .25 chords, half of them with flanks rounded by up to 85
degrees: largest angles are at most 134 degrees, with 30 degrees 144, with 50 degrees 143."""
_LOST = 0.35  # largest change of the distance between both lines, over the width of the base
COARSEST = 1.0 / 12.0  # largest cell on a base, over its width
_SHARE = 0.3  # largest part of the nodes that each wake line has
_SHARE_OF_FEW = 0.2  # the same where nodes are few
_STEEP = 1.5  # growth along a wall of few nodes
LEAST_BASE = 4  # fewest cells on a base
_LEAST_WALL = 24  # fewest cells on a wall


@dataclass(frozen=True, eq=False)
class BaseWake:
    """Lines of nodes around and behind a section with a base (a blunt trailing edge).

    `wall` (n, 2) runs clockwise from the lower to the upper corner of the base. `base` (m, 2) is on the
    straight line between these corners. The wakes `lower` and `upper` (k, 2) run from the corners to the
    outlet. At corners, the nodes of all lines are bitwise equal.
    """

    wall: Floats
    base: Floats
    lower: Floats
    upper: Floats
    north: Floats
    nj: int
    curve: Curve
    name: str
    chord: float
    notes: tuple[str, ...]
    first: float  # height of the first cells at wall and base
    turned: bool  # a wake line leaves its corner at an angle to its surface


def behind_base(body: Airfoil, sampling: Sampling, first: float, growth: float | None) -> BaseWake:
    """Return the lines from which the C grid of a `body` with a blunt trailing edge starts.

    `first` is the first-cell height at the wall, in the unit of the body. `growth` limits the growth ratio
    along trailing edge and wake. Raises InputError: too few nodes.
    """
    ratio = 1.0 + _WITHIN * ((growth or GROWTH) - 1.0)
    points = body.curve.points
    corners = points[1], points[-1]
    steps = sampling.corner_steps((sampling.ni or DEFAULT_NI + 1) - 1)
    base, grown = _base(corners, first, ratio, sampling.base_nodes, steps, growth)
    length = (sampling.wake or sampling.radius) * body.chord
    cells = _wake_cells(sampling, first, length, ratio, steps, growth)
    refined = sampling.refined
    ni = sampling.ni or refined * DEFAULT_NI + 1 + 2 * cells
    on_wall, fewest = ni - 1 - 2 * cells, _LEAST_WALL
    while growth and corner_cell(fewest, first, body.chord) > first:
        fewest += 2
    if on_wall < fewest:
        least = 2 * _whole(cells, MULTIPLES) + fewest
        raise InputError(
            f"{ni} nodes along a C grid, twice {cells + 1} of them behind a base, leave too few for the wall",
            f"use at least {-(-least // refined) + 1}{' before {refine}' if refined > 1 else ''} "
            "or fewer {wake_nodes}",
        )
    corner = first if growth else corner_cell(on_wall, first, body.chord)
    wall = _wall(body, on_wall, sampling, corner, ratio if corner == first else _STEEP)
    axis = wake_axis(body.leading_edge, body.trailing_edge)
    slopes, turned = _slopes(wall, axis)
    lower, upper = _lines(wall, slopes, axis, body.chord, length, first, cells, len(base) - 1)
    centre = 0.5 * (body.leading_edge + body.trailing_edge)
    radius = sampling.radius * body.chord
    north = c_far_field(len(wall) - 1, cells, centre, radius, axis, 0.5 * (lower[-1] + upper[-1]))
    nj = sampling.nj or DEFAULT_NJ
    notes = (*body.outline_notes, *grown)
    return BaseWake(
        wall, base, lower, upper, north, nj, body.curve, body.name, body.unit, notes, first, turned
    )


def _wall(body: Airfoil, cells: int, sampling: Sampling, first: float, ratio: float) -> Floats:
    """Return the nodes (cells + 1, 2) of the wall, from the lower corner of the base to the upper.

    Cells at the corners have the length `first` and grow by `ratio`.
    """
    if sampling.spacing not in ("auto", "curvature"):
        problem = f"{sampling.spacing} spacing around a base, from which a C grid has two wakes"
        raise InputError(problem, "use curvature, or {te} wedge", parameter="spacing")
    arcs = arcs_to_corners(body, cells, sampling, first, ratio)
    nodes = body.curve.at(arcs)
    nodes[0], nodes[-1] = body.curve.points[1], body.curve.points[-1]
    crossing = find_crossing(nodes)
    if crossing is not None:
        problem = f"the wall of {cells + 1} nodes crosses itself at ({crossing.x:.6g}, {crossing.y:.6g})"
        raise InputError(problem, "use more nodes where the section is thin")
    return nodes


def _base(
    corners: tuple[Floats, Floats],
    first: float,
    ratio: float,
    nodes: int | None,
    every: tuple[int, ...],
    growth: float | None,
) -> tuple[Floats, tuple[str, ...]]:
    """Return the nodes (m, 2) of the base from its lower corner; cells grow from `first` at both.

    A note says if the given number of `nodes` makes cells grow by more than `GROWTH`.
    """
    a, b = corners
    width = float(np.hypot(*(b - a)))
    fewest = _fewest(width, first, ratio)
    notes: tuple[str, ...] = ()
    cells = _whole(fewest, every) if nodes is None else nodes - 1
    if cells % every[-1]:
        problem = f"a base of {nodes} nodes has {cells} cells, and {{refine}} needs a multiple of {every[-1]}"
        raise InputError(problem, f"use {nodes_beside(cells, every[-1])}", parameter="base_nodes")
    if nodes is not None:
        least, end = _whole(fewest, every[-1:]) + 1, min(first, width / cells)
        if cells < 3:
            problem = f"{nodes} nodes on a base, from which a C grid has two wakes"
            raise InputError(problem, f"use {least} or more", parameter="base_nodes")
        needed = layer_steps(np.empty(cells), width, end, end, 1)
        more = f"{needed:.3g}" if math.isfinite(needed) else f"more than {LARGEST:g}"
        problem = f"{nodes} nodes on the base, {width:.3g} wide, grow by {more} from first cells of"
        if needed > (growth or LARGEST):
            more = f"use {least} or more"
            if growth is not None and needed <= LARGEST:
                more += f"; without {{growth}}, {nodes} have a note"
            raise InputError(f"{problem} {first:.3g}", more, parameter="base_nodes")
        if needed > (growth or GROWTH):
            notes = (Advice(f"{problem} {first:.3g}; {{base_nodes}} {least} or more keep to {GROWTH:g}"),)
    t = end_fractions(np.array([min(first / width, 1.0 / cells)]), cells)[0]
    out = (1.0 - t)[:, None] * a + t[:, None] * b
    out[0], out[-1] = a, b
    return np.asarray(out), notes


def _fewest(width: float, first: float, ratio: float) -> int:
    """Return the fewest cells of a base with growth at most `ratio`, none larger than `COARSEST`."""
    cells = LEAST_BASE
    while True:
        steps = np.empty(cells)
        end = min(first, width / cells)
        grown = layer_steps(steps, width, end, end, 1)
        if end < first or (grown <= ratio and steps.max() <= max(COARSEST * width, first)):
            return cells
        cells = max(cells + 1, int(1.03 * cells))


def end_fractions(ends: Floats, cells: int) -> Floats:
    """Return m distributions (m, cells + 1) from 0 to 1; both end steps are `ends` (m,), at most 1/cells."""
    out = np.zeros((len(ends), cells + 1))
    steps = np.empty(cells)
    for row, end in zip(out, ends.tolist(), strict=True):
        layer_steps(steps, 1.0, end, end, 1)
        half = cells // 2
        row[1 : half + 1] = np.cumsum(steps[:half])
        row[half + 1 :] = 1.0 - np.concatenate([np.cumsum(steps[:half:-1])[::-1], [0.0]])
    return out


def _wake_cells(
    sampling: Sampling,
    first: float,
    length: float,
    ratio: float,
    every: tuple[int, ...],
    growth: float | None,
) -> int:
    if sampling.wake_nodes is not None:
        return sampling.wake_nodes - 1
    cells = cells_for_growth(first, length, ratio) + 6  # growth sets in slowly, and ends a little faster
    if growth is None and sampling.ni is not None:
        few = corner_cell(0.4 * (sampling.ni - 1), 0.0, length / (sampling.wake or sampling.radius)) > first
        cells = min(cells, round((_SHARE_OF_FEW if few else _SHARE) * (sampling.ni - 1)))
    return _whole(cells, every)


def corner_cell(cells: float, first: float, chord: float) -> float:
    """Return the length of wall cells at a blunt trailing edge: the wanted length `first`, or more.

    It is more if the airfoil has so few `cells` around it that growth ratios from `first` would exceed 1.5.
    """
    side = 0.5 * cells
    return max(first, chord / side * math.pow(_STEEP, -0.5 * side))


def _whole(cells: int, steps: tuple[int, ...]) -> int:
    """Return the least number that is at least `cells` and a multiple of one of the `steps`."""
    step = first_within(steps, 0.25 * cells)
    return -(-cells // step) * step


def _slopes(wall: Floats, axis: Floats) -> tuple[tuple[float, float], bool]:
    """Return the slopes of both wake lines against the axis, and whether one leaves its surface."""
    base = wall[-1] - wall[0]
    slopes, turned = [], False
    for surface, side, way in ((wall[1] - wall[0], base, -1.0), (wall[-2] - wall[-1], -base, 1.0)):
        along, across = (float(x) for x in along_and_across(surface, side))
        tangent = math.pi - math.atan2(-way * across, along) % (2.0 * math.pi)  # angle between it and base
        angle = max(tangent, min(_LEAST_ANGLE, tangent + _MOST_TURNED))
        turned = turned or angle > tangent
        if angle == tangent:
            along, across = (-float(x) for x in along_and_across(surface, axis))
            angle = math.atan2(across, along)
        else:
            along, across = (float(x) for x in along_and_across(side, axis))
            angle = math.atan2(across, along) + way * angle
        slopes.append(math.tan(min(max(angle, -_STEEPEST), _STEEPEST)))
    return (slopes[0], slopes[1]), turned


def _lines(
    wall: Floats,
    slopes: tuple[float, float],
    axis: Floats,
    chord: float,
    length: float,
    first: float,
    cells: int,
    across: int,
) -> tuple[Floats, Floats]:
    """Return the lower and the upper wake line (cells + 1, 2), from the base to the outlet.

    Behind the base, the `across` cells between them get higher as those beside the lines.
    """
    normal = np.array([-axis[1], axis[0]])
    corners = wall[0], wall[-1]
    mean, closing = 0.5 * (slopes[0] + slopes[1]), slopes[0] - slopes[1]
    gap = float(np.hypot(*(wall[-1] - wall[0])))
    near = min(chord, _LOST * gap / max(abs(closing), 1e-9))
    outlet = max(float(along_and_across(corner, axis)[0]) for corner in corners) + length
    # one law for both, or the lines across from node to node would be slanted far behind
    places = growing(first / math.hypot(1.0, 0.5 * closing), length, cells)
    lines = []
    for corner, slope, way in zip(corners, slopes, (-0.5, 0.5), strict=True):
        own = outlet - float(along_and_across(corner, axis)[0])
        x = places * (own / places[-1])
        more = 1.0 - first / math.hypot(1.0, slope) / x[1]  # of its first cell, which is to be as long
        x += more * near * expm1(-x / near)
        x *= own / x[-1]
        y = -mean * chord * expm1(-x / chord) - (slope - mean) * near * expm1(-x / near)
        y += way * across * chord * rise(x / chord, BEHIND_BASE)
        line = corner + x[:, None] * axis + y[:, None] * normal
        line[0] = corner
        line[1] = corner + (line[1] - corner) * (first / float(np.hypot(*(line[1] - corner))))
        lines.append(line)
    return lines[0], lines[1]
