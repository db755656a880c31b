"""Wall cells of planned sizes around an airfoil: numbers of cells on base and sides, and sizes of end cells.

Both sides get as many cells; of an odd number one is centred on the nose, so that nodes of a symmetric
section are symmetric. First cells of the sides are as large as those of the base.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import Floats, along_and_across
from meshonet.geometry.elementary import geomspace
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.along_curve import on_corners
from meshonet.geometry.spacing.laws import LAWS
from meshonet.geometry.spacing.sampling import Sampling, first_within, nodes_beside

if TYPE_CHECKING:
    from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

_EDGE_STEP = 20.0
"""Length of the cell at a sharp trailing edge, in mean cells, times the number of cells of a side.

Measured on O grids: with smaller cells grids are less orthogonal, with larger ones more grids fold there.
"""
_EDGE_PART = 0.24  # the same length for spacing by curvature, default of marched grids, in mean cells
_BASE_GROWTH = 1.06  # largest ratio of neighbouring cells on a base: 46 of 400 cells on one of 8 % chord
_MANY = 192  # fewest cells of a side for which half a base has four, which coarsening by four keeps
_BASE_JUMP = 4.0  # largest ratio of a prescribed cell beside a base to those on it; at 16, cells fold
_ROUND_CELLS = 14  # fewest cells on half a rounded base, if there are 16 times as many in total
_CROWDED, _BASE_SHARE = 0.2, 0.3
"""Fraction of all cells on a base from which on they may grow by `_CROWDED_GROWTH`, and the largest one."""
_CROWDED_GROWTH = 1.25
_LEAN = math.radians(0.8)  # largest angle between surface and first cells, coarsened by four, at a base
_COARSENED = 4  # two halvings, for a family of three grids
_LONGER = 1.2  # factor on the length of that many cells, since they grow away from the corner
_SMALLER = 64.0  # largest factor by which cells beside a base are smaller for this


@dataclass(frozen=True)
class WallCells:
    """Numbers of cells per side of an airfoil and on half its blunt trailing edge; lengths of end cells."""

    half: int
    cells: float
    base_step: float
    te: float
    le: float
    base: tuple[Floats, Floats] | None = None
    """Distances of the nodes on a rounded base from its middle, on the lower and on the upper half."""


def planned_arcs(body: Airfoil, ni: int, sampling: Sampling) -> Floats:
    """Return arc lengths (ni,) of wall nodes; cells at leading and trailing edge are as `sampling` asks."""
    plan = _plan(body, ni - 1, sampling)
    if sampling.spacing == "curvature":
        from meshonet.geometry.spacing.size_field import arcs_by_curvature

        sides = arcs_by_curvature(
            body.curve,
            (body.half_base, body.nose_arc, body.upper_end),
            round(2 * plan.cells),
            chord=body.chord,
            steps=(plan.te, plan.le),
            exact=(sampling.te_spacing is not None or plan.half > 0, sampling.le_spacing is not None),
            hurried=sampling.te_spacing is not None,
            based=plan.half > 0 and plan.base is None,  # cells of a rounded base vary slowly
        )
    else:
        q = np.arange(1, math.ceil(plan.cells)) / plan.cells
        lower = body.half_base + _side(body.nose_arc - body.half_base, plan, sampling, q)
        upper = body.upper_end - _side(body.upper_end - body.nose_arc, plan, sampling, q)
        nose = [body.nose_arc] if float(plan.cells).is_integer() else []
        sides = np.concatenate([[body.half_base], lower, nose, upper[::-1], [body.upper_end]])
    if plan.half == 0:
        return sides
    lower, upper = plan.base or (_half_base(plan, body.half_base),) * 2
    return np.concatenate([lower[:-1], sides, body.curve.length - upper[-2::-1]])


def arcs_to_corners(body: Airfoil, cells: int, sampling: Sampling, first: float, ratio: float) -> Floats:
    """Return arc lengths (cells + 1,) of nodes around a body from corner to corner of a blunt trailing edge.

    Cells at the corners have the length `first` unless `sampling.te_spacing` is given. From there they grow
    by factors of at most `ratio`. All corners of the body are nodes.
    """
    from meshonet.geometry.spacing.size_field import arcs_by_curvature

    plan = _natural(body, WallCells(0, 0.5 * cells, 0.0, 0.0, 0.0), sampling)
    le = sampling.le_spacing * body.chord if sampling.le_spacing else plan.le
    te = sampling.te_spacing * body.chord if sampling.te_spacing else first
    arcs = arcs_by_curvature(
        body.curve,
        (body.half_base, body.nose_arc, body.upper_end),
        cells,
        chord=body.chord,
        steps=(te, le),
        exact=(True, sampling.le_spacing is not None),
        at_edge=math.log(ratio),
        based=True,
    )
    return on_corners(arcs, body.inner_corners, (), sampling.corner_steps(cells)[0])


def half_of_base(cells: int, nodes: int, sampling: Sampling) -> int:
    """Return the number of cells on half of a blunt base that has `nodes` nodes.

    `cells` is the number around the airfoil. Raises InputError: no node in the middle of the base; too few
    cells are left for the sides.
    """
    base = nodes - 1
    if base % (2 * sampling.refined):
        near = nodes_beside(base, 2 * sampling.refined)
        problem = f"a base of {base + 1} nodes has none in its middle, where an O grid begins"
        if base % 2 == 0:
            halves = f"each half of a base of {base + 1} nodes has {base // 2} cells"
            problem = f"{halves}, and {{refine}} needs a multiple of {sampling.refined}"
        raise InputError(problem, f"use {near}", parameter="base_nodes")
    if base + 4 > cells:
        problem = f"{base + 1} of {cells + 1} nodes on the base leave too few for the sides"
        raise InputError(
            problem, f"use at most {(cells - 4) // 2 * 2 + 1} or a finer {{res}}", parameter="base_nodes"
        )
    return base // 2


def _plan(body: Airfoil, cells: int, sampling: Sampling) -> WallCells:
    """Return the numbers of cells of base and sides, and the cell sizes at their ends."""
    wanted_te = sampling.te_spacing and sampling.te_spacing * body.chord
    wanted_le = sampling.le_spacing and sampling.le_spacing * body.chord
    plan = _natural(body, WallCells(0, 0.5 * cells, 0.0, 0.0, 0.0), sampling)
    if body.half_base:
        fixed = bool(wanted_te) or not LAWS[sampling.spacing].sets_ends
        corner = _corner_step(body, plan.te, cells, sampling)
        half, step = _base_cells(body.half_base, wanted_te or corner, cells, fixed=fixed)
        if not body.base_is_round:
            nodes = sampling.base_nodes
            half_cells = half_of_base(cells, nodes, sampling) if nodes else 0
            half, step = _whole_base(body.half_base, step, half_cells, half, sampling.corner_steps(cells))
            if cells < 2 * half + 4:
                problem = f"{2 * half + 1} of {cells + 1} nodes on the base leave too few for the sides"
                raise InputError(problem, "use a finer {res}")
        if body.base_is_round and not wanted_te and half < min(_ROUND_CELLS, cells // 16):
            half = min(_ROUND_CELLS, cells // 16)
            step = body.half_base / half
        plan = _natural(body, WallCells(half, 0.5 * cells - half, step, 0.0, 0.0), sampling)
        plan = replace(plan, te=step)
        if body.base_is_round and half > 2 and not wanted_te:
            from meshonet.geometry.shapes.airfoil.trailing_edge import half_rounds

            base = half_rounds(body.curve, body.half_base, half)
            te = 0.5 * sum(float(part[-1] - part[-2]) for part in base)
            left = cells - sum(len(part) - 1 for part in base)
            plan = replace(plan, cells=0.5 * left, te=te, base=base)
    elif body.inner_corners.size:  # the cells up to a corner next to a sharp edge are those of a base
        corners = body.inner_corners
        nearest = min(float(corners.min()), body.curve.length - float(corners.max()))
        plan = replace(plan, te=min(plan.te, nearest / sampling.corner_steps(cells)[0]))
    plan = replace(plan, te=wanted_te or plan.te, le=wanted_le or plan.le)
    side = min(body.nose_arc - body.half_base, body.upper_end - body.nose_arc)
    if plan.te + plan.le >= side:
        raise InputError(
            f"cells of {plan.te / body.chord:.3g} and {plan.le / body.chord:.3g} chords fill a side",
            "use smaller spacings",
        )
    return plan


def _natural(body: Airfoil, plan: WallCells, sampling: Sampling) -> WallCells:
    """Return the plan with default cell sizes.

    At the nose it is sqrt(r c / 2) π / n, with nose radius r and chord c, as of equal angles on the conformal
    map's circle; for a sharp edge see `_EDGE_STEP`.
    """
    n = plan.cells
    side = 0.5 * (body.upper_end - body.half_base)
    mean = side / n
    if sampling.spacing == "uniform":
        return replace(plan, te=mean, le=mean)
    le = math.pi / n * math.sqrt(0.5 * body.nose_radius * body.chord)
    law = LAWS[sampling.spacing]
    if law.place and law.sets_ends:
        le = side * float(law.place(np.array([1.0 / n]))[0])
        return replace(plan, te=le if not body.half_base else mean * min(0.5, _EDGE_STEP / n), le=le)
    edge = _EDGE_PART if sampling.spacing == "curvature" else min(0.5, _EDGE_STEP / n)
    return replace(plan, te=mean * edge, le=min(max(le, 0.05 * mean), 0.7 * mean))


def _corner_step(body: Airfoil, step: float, cells: int, sampling: Sampling) -> float:
    """Return the length of cells beside a base, at most `step`, less where a surface turns."""
    if sampling.spacing != "curvature" or body.base_is_round:
        return step
    coarser = min(_COARSENED, sampling.corner_steps(cells)[0]) if sampling.refined == 1 else sampling.refined
    reach = _LONGER * coarser * step
    straight = min(_straight_length(body, end, reach) for end in (body.half_base, body.upper_end))
    return max(min(step, straight / (_LONGER * coarser)), step / _SMALLER)


def _straight_length(body: Airfoil, corner: float, most: float) -> float:
    """Return the length, at most `most`, over which a surface leans by `_LEAN` at most."""
    sign = 1.0 if corner == body.half_base else -1.0
    lengths = geomspace(most / _SMALLER, most, 65)
    tiny = 1e-6 * lengths[0]
    way = sign * body.curve.tangent(np.array([corner + sign * tiny]))[0]
    chords = body.curve.at(corner + sign * lengths) - body.curve.at(np.array([corner]))
    along, across = along_and_across(chords, way)
    lean = np.flatnonzero(np.abs(across) > math.tan(_LEAN) * along)
    return most if len(lean) == 0 else float(lengths[max(lean[0] - 1, 0)])


def _base_cells(half_base: float, step: float, cells: int, *, fixed: bool) -> tuple[int, float]:
    """Return the number of cells of half a base and the size of the one at the corner.

    The number is at least 2, more for wider bases, and as many as `step` needs with a growth of 15 %. With
    fewer, cells fold at the corners; with more, the solver is slow. Beside a `fixed` size, cells are not much
    smaller.
    """
    enough = cells >= 48
    fewest = 4 if cells >= _MANY else 2
    least = max(fewest, round(2 * math.cbrt(half_base / 1.2e-4))) if enough else 1
    least = min(least, max(cells // 24, 1), 12)
    if fixed:
        least = min(least, math.ceil(_BASE_JUMP * half_base / step))
    most = max(least, int(0.5 * _BASE_SHARE * cells))
    if not fixed:
        step = min(step, half_base / least)
    if half_base <= 6 * step:
        half = min(max(least, round(half_base / step)), most)
        return half, half_base / half
    from meshonet.geometry.spacing.tanh_law import TanhLaw

    def growth(half: int, step: float) -> float:
        """Return the logarithm of the largest growth ratio, at the corner: sizes vary like sech²."""
        d = TanhLaw(2 * half * 0.5 * step / half_base, 2 * half * 0.5 * step / half_base).stretch
        return d / half * math.tanh(0.5 * d)

    for half in range(4, most):
        limit = _BASE_GROWTH if 2 * half <= _CROWDED * cells else _CROWDED_GROWTH
        if growth(half, step) < math.log(limit):
            return half, step
    while not fixed and growth(most, step) > math.log(_CROWDED_GROWTH):
        step *= 1.1
    return most, step


def _whole_base(
    half_base: float, step: float, count: int, half: int, steps: tuple[int, ...]
) -> tuple[int, float]:
    """Return cells of half a base, `count` or a multiple of a step, and the corner cell."""
    every = first_within(steps, half)
    cells = count or max(every, round(half / every) * every)
    return cells, min(step, half_base / cells) if cells > 1 else half_base


def _half_base(plan: WallCells, half_base: float) -> Floats:
    """Return distances (half + 1,) from the middle of the base to its corner."""
    part = plan.base_step / (2 * half_base)
    if abs(part * 2 * plan.half - 1.0) < 1e-9:
        return np.linspace(0.0, half_base, plan.half + 1)
    from meshonet.geometry.spacing.tanh_law import TanhLaw

    law = TanhLaw.fitted(2 * plan.half, part, part)
    out = half_base - 2 * half_base * law(np.arange(plan.half + 1) / (2 * plan.half))[::-1]
    out[0], out[-1] = 0.0, half_base
    return np.asarray(out)


def _side(length: float, plan: WallCells, sampling: Sampling, q: Floats) -> Floats:
    ends_set = sampling.te_spacing is not None or sampling.le_spacing is not None
    if plan.cells < 4 and not ends_set:
        return np.asarray(length * q)
    law = LAWS[sampling.spacing]
    if law.place and not (law.sets_ends and (ends_set or plan.half)):
        return np.asarray(length * law.place(q))
    from meshonet.geometry.spacing.tanh_law import TanhLaw

    part = 1.0 if float(plan.cells).is_integer() else 0.5
    return np.asarray(length * TanhLaw.fitted(plan.cells, plan.te / length, plan.le / length, part)(q))
