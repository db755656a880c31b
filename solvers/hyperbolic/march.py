"""Hyperbolic grids for boundary layers, marched from the wall, with exact first-cell height.

The distance to march is corrected until the far field is reached; folded cells are marched again with more
dissipation. The equations are in ``kernels/hyperbolic/march.c``.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import exp
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.spacing.growth import cells_for_growth, check_growth, growth_ratio
from meshonet.geometry.spacing.y_plus import first_cell_note
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import hyperbolic_march, redistribute
from meshonet.solvers.hyperbolic.front import Front, distance_to_march
from meshonet.solvers.hyperbolic.level_spacing import Edge, even_shares, fastest, level_steps
from meshonet.solvers.hyperbolic.settings import (
    ATTEMPTS,
    OPEN_ATTEMPTS,
    RISING,
    SHARP_ATTEMPTS,
    MarchSettings,
    attempts_around_base,
)
from meshonet.solvers.layers.limited import limit_growth
from meshonet.solvers.solution import Solution, timed
from meshonet.solvers.stages import filling

FADE_ROWS = 12.0  # rows over which the correction of the first cell fades out
NEAREST, FARTHEST = 1.001, 1.025  # accepted distances of the last level, relative to the far field
MOST_GROWTH = 1.5  # largest growth ratio that is tried; with larger ones levels do not get away from the wall
SPARE_WAY = 1.6  # if the number of rows is free, ratio of the distance that they could reach to the distance
EVENINGS = 6  # most marches in which steps are corrected so that growth is even
WITHIN = 0.998  # fraction of the growth beyond 1 that these aim at
TRIED = 8  # numbers of rows that are tried, at the least, before a limit of growth counts as out of reach
GAIN = 0.25  # least part of the excess over this limit that twice the rows take away, fewer in proportion
AT_CORNERS = 12  # most marches from a front with concave corners, whose first steps are corrected
ALIKE = 1e-6  # relative error of first cells from which these corrections go on
EQUAL = 1e-9  # relative difference of steps that are equal
AREA_SMOOTHING = 0.16  # coefficient of a smoothing step of the areas along a level


@dataclass(frozen=True)
class MarchLayers:
    """Requirements for the rows of cells of a marching method."""

    first: float  # first-cell height, in the unit of the boundary
    growth: float | None  # largest growth ratio; None: not limited
    free: bool  # whether their number follows from `growth`; it is then a multiple of `multiple`
    constant: int  # number of rows with the first-cell height
    multiple: int = 1


@timed
def hyperbolic(
    boundary: Boundary, *, wall_spacing: float, growth: float | None = None, free_rows: bool = False,
    constant: int = 1, multiple: int = 1,
) -> Solution:  # fmt: skip
    """Return an O or C grid marched from the wall of `boundary`; the wall nodes are bitwise kept.

    The far field of the solution is the last level of the march. The ends of C rows move along the sides west
    and east, which are assumed to be straight. If cells fold in all attempts, the returned grid is folded.

    Parameters
    ----------
    boundary : its far field gives the distance of the march, its `nj` the number of rows.
    wall_spacing : first-cell height in chords, met to 1e-8.
    growth : largest growth ratio.
    free_rows : whether the number of rows follows from `growth`, as a multiple of `multiple`.
    constant : number of rows with the first-cell height.

    Raises InputError if the boundary is four-sided, spacing or growth is out of range, or rows are too few.
    Raises SolverError if no attempt gives finite nodes.
    """
    check_layers(wall_spacing, growth)
    if boundary.topology == "quad":
        raise InputError(
            f"hyperbolic marching cannot make topology {boundary.topology}",
            "use it around a body (topology o or c), or from a surface in space with {layers}, or another "
            "method without a wall spacing",
            parameter="method",
        )
    first = wall_spacing * boundary.chord
    layers = MarchLayers(first, growth, free_rows, constant, multiple)
    nodes = marched(Front(boundary, first), boundary.nj - 1, layers)
    return _solution(boundary, nodes, first)


def marched(front: Front, rows: int, layers: MarchLayers) -> Floats:
    """Return the nodes (ni, nj, 2) of a march with `rows` rows of cells, or with more if `layers` permits it.

    Raises InputError if rows are too few, and SolverError if no attempt gives finite nodes.
    """
    growth, multiple = layers.growth, layers.multiple
    least = cells = _rows(rows, front.outer - front.inner, layers)
    if layers.free:
        cells = -(-cells // multiple) * multiple
    nodes = _unfolded(front, cells, layers)
    excess: list[float] = []
    while growth:
        excess.append(float(fastest(nodes).max()) - math.log(growth))
        if not excess[-1] > 0.0:
            break
        cells += -(-(1 + (cells - least) // 8) // multiple) * multiple
        beyond = min(excess) > (1.0 - GAIN * (cells / least - 1.0)) * excess[0]
        if cells > 2 * least + 8 or (beyond and len(excess) > TRIED):
            problem = f"no number of rows keeps to a growth of {growth:g}"
            base = ", or close the base with {te} wedge" if front.narrow else ""
            raise InputError(problem, f"allow more, use a smaller {{first_cell}}{base}", parameter="growth")
        nodes = _unfolded(front, cells, layers)
    if cells > rows and not layers.free:
        raise _too_few(rows, cells, growth or MOST_GROWTH, multiple)
    return nodes


def _unfolded(front: Front, cells: int, layers: MarchLayers) -> Floats:
    """Return nodes (ni, cells + 1, 2) of the attempt with the fewest folded cells, or raise SolverError."""
    best, least = None, math.inf
    attempts: Sequence[MarchSettings] = SHARP_ATTEMPTS if front.edge else ATTEMPTS
    if front.narrow:
        ratio = growth_ratio(layers.first, front.outer - front.inner, cells)
        attempts = attempts_around_base(ratio, concave=front.concave)
    elif front.ends is not None:
        attempts = OPEN_ATTEMPTS
    for settings in attempts:
        nodes = _evened(front, cells, layers, settings)
        folded = math.inf if nodes is None else count_folded(nodes)
        if folded < least:
            best, least = nodes, folded
        if folded == 0:
            break
    if best is None:
        raise SolverError("the march diverged from every start; use more nodes around the body or fewer rows")
    return best


def check_layers(wall_spacing: float, growth: float | None = None) -> None:
    """Raise InputError if `wall_spacing` (in chords) or `growth` is out of the range of `hyperbolic`."""
    if not 1e-9 <= wall_spacing <= 0.1:
        problem = f"a first cell of {wall_spacing:g} chords"
        raise InputError(problem, "use 1e-9 to 0.1", parameter="first_cell")
    check_growth(growth, MOST_GROWTH)


def _too_few(cells: int, needed: int, growth: float, multiple: int) -> InputError:
    """Return the error for a march of too few cells from the wall, `multiple` times the requested number."""
    problem = f"{cells + 1} rows of nodes cannot reach the far field growing by {growth:g} each"
    before = " before {refine}" if multiple > 1 else ""
    return InputError(problem, f"use {-(-needed // multiple) + 1} rows or more{before}")


def _rows(cells: int, distance: float, layers: MarchLayers) -> int:
    """Return the number of cells from the wall to the far field, increased if the limit requires it."""
    first, allowed, equal = layers.first, layers.growth or MOST_GROWTH, layers.constant - 1
    if equal * first >= distance:
        problem = f"{layers.constant} layers of {first:.3g} reach the far field"
        raise InputError(problem, "use fewer", parameter="constant_layers")
    free_way = distance - equal * first
    if layers.growth and layers.free:
        return equal + cells_for_growth(first, SPARE_WAY * free_way, allowed)
    needed = equal + cells_for_growth(first, free_way, allowed)
    if layers.growth and needed > cells:
        return needed
    if needed > cells:
        raise _too_few(cells, needed, allowed, layers.multiple)
    growth_ratio(first, free_way, cells - equal)  # raises when even equal cells reach too far
    return cells


def _evened(front: Front, cells: int, layers: MarchLayers, settings: MarchSettings) -> Floats | None:
    """Return the nodes of a march whose steps are corrected so that cells grow by at most the limit.

    They may still grow faster at concave corners and beside narrow bases, if only more rows would help there.
    """
    growth, constant = layers.growth, layers.constant
    nodes, steps = _marched(front, cells, layers, settings, edge=None if growth else front.edge)
    for _ in range(EVENINGS):
        if nodes is None or growth is None or cells < 3:
            break
        if float(fastest(nodes).max()) <= math.log(growth):
            break
        rate = math.log(1.0 + (growth - 1.0) * WITHIN)
        shares = even_shares(nodes, steps, rate, constant)
        if not shares.any():  # even equal steps grow too fast along some lines
            break
        nodes, steps = _marched(front, cells, layers, settings, edge=None, shares=shares)
    if nodes is not None and growth is not None:
        faster = fastest(nodes) > math.log(growth)
        # beside a concave corner even equal steps grow; other levels need more rows there and beside a base,
        # since nodes moved along some lines but not along their neighbours bend cells as narrow as those are
        more_rows = front.concave or (front.narrow and layers.free)
        more_rows = more_rows and bool((faster & (np.diff(steps) > EQUAL * steps[1:])).any())
        if faster.any() and not more_rows:
            limit_growth(nodes, growth, constant)
    return nodes


def _marched(
    front: Front, cells: int, layers: MarchLayers, settings: MarchSettings, *, edge: Edge | None,
    shares: Floats | None = None,
) -> tuple[Floats | None, Floats]:  # fmt: skip
    """Return nodes (ni, cells + 1, 2) that reach the far field of `front`, None if not finite, and steps."""
    start, first, constant = front.start(), layers.first, layers.constant
    levels = np.empty((2, cells + 1, len(start)))
    levels[:, 0] = start.T
    knobs = (
        settings.dissipation, settings.even, settings.tolerated, settings.bend, 1.0 + settings.theta,
        AREA_SMOOTHING, settings.sweeps, round(RISING * cells),
    )  # fmt: skip
    threads = threads_for(levels[0].size)
    distance = distance_to_march(front, first, cells, settings, constant, edge)
    widening = front.widening
    for _ in range(AT_CORNERS if front.concave else 4):
        steps = level_steps(first, distance, cells, constant, edge, shares)
        with filling("grid", "row", levels[0, 1:, 0]):
            hyperbolic_march(levels[0], levels[1], steps, *knobs, front.ends, widening, None, threads)
        reached = front.reach(levels)
        if not math.isfinite(reached):
            return None, steps
        alike, near = True, NEAREST <= reached / front.outer <= FARTHEST
        if front.concave and widening is not None:
            # were nodes moved afterwards, only the lines from the corner would, past their neighbours
            wrong = norms((levels[:, 1] - levels[:, 0]).T) / front.heights(first)
            wrong[[0, -1]] = wrong[[1, -2]]  # both ends move as far as their neighbours, whatever their areas
            widening = widening / wrong
            alike = float(np.abs(wrong - 1.0).max()) <= ALIKE
        if alike and near:
            break
        if not near:
            distance *= (0.75 * NEAREST + 0.25 * FARTHEST) * front.outer / reached
            equal = cells if shares is None else np.count_nonzero(np.cumsum(shares) == 0.0)
            if distance <= equal * first:  # of a march that ran away
                return None, steps
    nodes = front.nodes(levels)
    front.close(nodes)
    _snap(nodes, front.heights(first), steps)
    _equalise(nodes, min(constant, cells - 1), front.heights(1.0))
    return (nodes if np.isfinite(nodes[..., 0].sum() + nodes[..., 1].sum()) else None), steps


def _snap(nodes: Floats, heights: Floats, steps: Floats) -> None:
    """Move nodes along lines, in place, to first cells of `heights` (ni,); less away from the wall."""
    rows = nodes.shape[1]
    rate = math.log(steps[-1] / steps[-2]) if rows > 2 else 1.0
    fade = exp(-np.maximum(np.arange(rows) - 1.0, 0.0) / max(FADE_ROWS, 1.5 / max(rate, 1e-3)))
    if rows > 2:
        redistribute(nodes[..., 0], nodes[..., 1], heights, fade, threads_for(nodes[..., 0].size))


def _equalise(nodes: Floats, constant: int, widening: Floats) -> None:
    """Make the first `constant` cells of lines as high as the first one, in place; less along a wake."""
    away = np.arange(nodes.shape[1])
    fade = exp(-np.maximum(away - constant, 0.0) / FADE_ROWS)
    fade[-1] = 0.0
    share = 1.0 / widening[:, None] ** 2
    for _ in range(4 if constant > 1 else 0):  # pieces are straight: each pass leaves less
        step = np.diff(nodes, axis=1)
        height = np.hypot(step[..., 0], step[..., 1])
        arc = np.pad(np.cumsum(height, axis=1), ((0, 0), (1, 0)))
        wanted = arc[:, 1:2] * away
        behind = wanted[:, constant] - arc[:, constant]
        move = share * np.where(away <= constant, wanted - arc, behind[:, None] * fade)
        out = np.maximum(move[:, :-1], 0.0) / height
        back = np.minimum(move[:, 1:], 0.0) / height
        nodes[:, :-1] += out[..., None] * step
        nodes[:, 1:] += back[..., None] * step


def _solution(boundary: Boundary, nodes: Floats, first: float) -> Solution:
    """Return the solution of `nodes`, with the boundary that they have now."""
    parts = tuple(
        replace(part, stop=nodes.shape[1] - 1) if part.side in ("west", "east") else part
        for part in boundary.patches
    )
    edges = replace(
        boundary, north=nodes[:, -1], west=nodes[0], east=nodes[-1], patches=parts, sensors=None, notes=()
    )
    facts = {"method": "hyperbolic", "wall_spacing": first}
    return Solution(
        Grid.from_nodes(nodes, boundary.topology, parts, boundary.name, facts), "hyperbolic",
        notes=(_first_cell_note(boundary, nodes, first),),
        boundary=edges, first_cells={"south": first},
    )  # fmt: skip


def _first_cell_note(boundary: Boundary, nodes: Floats, first: float) -> str:
    behind = boundary.wake
    wall = nodes[behind : len(nodes) - behind]
    heights = np.hypot(*(wall[:, 1] - wall[:, 0]).T)
    some = wall[:: max(len(wall) // 16, 1)]
    length = float(np.hypot(*np.diff(some, axis=1).T).sum(axis=0).mean())
    growth = growth_ratio(first, length, nodes.shape[1] - 1)
    low, high = float(heights.min()), float(heights.max())
    return first_cell_note(low, high, first, growth, chord=boundary.chord)
