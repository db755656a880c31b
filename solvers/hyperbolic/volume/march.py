"""Volumes marched from multi-patch surfaces, with exact first-cell height.

Folded cells are marched again with other smoothing (`settings`). The equations are in
``kernels/surfaces/step.c``.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.elementary import exp
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.quality.bad_cell import BadCell
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids, least_jacobian, worst_solids
from meshonet.geometry.surface.hollows import Hollows, hollows_of
from meshonet.geometry.surface.planes import Plane
from meshonet.geometry.surface.surface import Surface
from meshonet.geometry.threads import MANY_VISITS, threads_for
from meshonet.kernels._native import respace_lines, surface_march
from meshonet.solvers.hyperbolic.volume.blocks import blocks_of, volume_grid
from meshonet.solvers.hyperbolic.volume.graph import MarchGraph, march_graph
from meshonet.solvers.hyperbolic.volume.limited_growth import growth_of_levels, limit_growth, slower_steps
from meshonet.solvers.hyperbolic.volume.settings import Smoothing, VolumeMarch, attempts_for
from meshonet.solvers.hyperbolic.volume.symmetry import in_planes, symmetry_of
from meshonet.solvers.solution import Solution, timed
from meshonet.solvers.stages import filling

__all__ = ["VolumeMarch", "march_surface"]

FADE = 12.0  # cells over which the correction of first cells fades out along a line
SWEEPS = 10  # of the smoothing of steps along lines
_SLOWER = 2  # further marches by smaller steps where cells grow too much
_POOR = 0.35  # least scaled Jacobian for which no other smoothing is tried
WORST = 10  # folded cells named in the error message
_SAMPLES = 2000  # nodes of a part, evenly drawn, by which its distance from others is measured


class _Volume(NamedTuple):
    """Blocks of a march with `made` layers of cells, `folded` of them folded."""

    blocks: tuple[Block, ...]
    made: int
    folded: int


@timed
def march_surface(
    surface: Surface, settings: VolumeMarch, *, wing: bool = False, remedy: str = ""
) -> Solution:
    """Return the volume grid between a surface and a far field, with one block for each patch.

    Directions i and j are as in the patch; k goes from wall (``bottom``) to far field (``top``). Sides in
    planes of symmetry are patches ``symmetry``, sides at free edges are patches ``free``; all other sides are
    connected. Chan and Steger, Appl. Math. Comput. 51 (1992) 181; ``kernels/surfaces/step.c`` lists the
    differences.

    Parameters
    ----------
    wing : for wings, try other smoothing also if a scaled Jacobian is below 0.35, not only if cells fold.
    remedy : advice in the error message about folded cells; empty for the usual advice.

    Raises InputError if settings are impossible or grids of two parts would overlap. Raises NoValidGridError,
    with the worst cells, if in every attempt a corner Jacobian or a Bezier coefficient is not positive.
    """
    steps, far = settings.steps(surface.size), settings.distance(surface.size)
    _check_parts(surface, far)
    planes, inside, assumed = symmetry_of(surface, settings.symmetry, far)
    nodes = in_planes(surface, planes, inside)
    hollows = hollows_of(surface)
    volume, tries = _best(surface, planes, inside, nodes, hollows, steps, settings.limit, wing=wing)
    if volume.made < len(steps) or volume.folded:
        raise _refusal(volume, len(steps), tries, surface, hollows, remedy)
    grid = volume_grid(surface, volume.blocks, np.any(inside, axis=0))
    notes = [*surface.notes, *assumed]
    if tries > 1:
        others = "the others had folded cells or a smaller scaled Jacobian"
        notes.append(f"the best of {tries} marches is used: {others}")
    return Solution(
        grid, "hyperbolic", notes=tuple(note for note in notes if note),
        first_cells={"bottom": settings.first_cell}, growth=settings.limit,
    )  # fmt: skip


def _best(
    surface: Surface, planes: tuple[Plane, ...], inside: Bools, nodes: Floats, hollows: Hollows,
    steps: Floats, growth: float, *, wing: bool,
) -> tuple[_Volume, int]:  # fmt: skip
    """Return the first volume that is good enough, or the best one, and the number of attempts.

    Good volumes have no folded cells and, for a `wing`, no scaled Jacobian below 0.35. If cells grow by more
    than `growth`, the march is repeated with smaller steps.
    """
    best: _Volume | None = None
    most = (0, -math.inf, 0.0)
    tries = 0
    for smoothing in attempts_for(concave=len(hollows.edges) > 0, wing=wing):
        tries += 1
        graph = march_graph(surface, planes, inside, hollows.distance, smoothing.splay, smoothing.boost)

        def marched(steps: Floats, graph: MarchGraph = graph, smoothing: Smoothing = smoothing) -> Floats:
            lines = _respaced(march_levels(surface, graph, nodes, steps, smoothing), graph, steps)
            for plane, flags in zip(planes, inside, strict=True):
                lines[plane.axis, surface.open_edges[flags]] = plane.value
            return lines

        lines = marched(steps)
        volume, worth = _volume(surface, lines), 0.0
        if volume.made == len(steps) and not volume.folded:
            grown = _with_growth(surface, lines, marched, steps, growth)
            volume, worth = grown or (volume, least_jacobian(volume.blocks))
            worth = worth if wing else _POOR
        score = min(volume.made, len(steps)), -volume.folded, worth
        if best is None or score > most:
            best, most = volume, score
        if worth >= _POOR:
            break
    return best or volume, tries


def _volume(surface: Surface, lines: Floats) -> _Volume:
    made = lines.shape[2] - 1
    blocks = blocks_of(surface, lines) if made else ()
    return _Volume(blocks, made, sum(count_folded_solids(block.nodes, BEZIER) for block in blocks))


def _with_growth(
    surface: Surface, lines: Floats, marched: Callable[[Floats], Floats], steps: Floats, growth: float
) -> tuple[_Volume, float] | None:
    """Return the best valid volume whose cells grow by at most `growth` along lines, and its least Jacobian.

    None if there is none. Several marches with decreasing steps are made, with nodes moved along the lines.
    """
    tried = [(lines, steps)]
    for _ in range(_SLOWER):
        levels = growth_of_levels(tried[-1][0])
        if levels.max() <= growth:
            break
        slower = slower_steps(tried[-1][1], levels, growth)
        tried.append((marched(slower), slower))
        if tried[-1][0].shape[2] <= len(slower):
            break
    best, most = None, (False, 0.0)
    for made, wanted in tried:
        if made.shape[2] > len(wanted):
            limit_growth(made, growth)
            volume = _volume(surface, made)
            even = bool(growth_of_levels(made).max() <= growth)
            score = even, 0.0 if volume.folded else least_jacobian(volume.blocks)
            if score[1] > 0.0 and score > most:
                best, most = (volume, score[1]), score
    return best


def march_levels(
    surface: Surface, graph: MarchGraph, nodes: Floats, steps: Floats, smoothing: Smoothing
) -> Floats:
    """Return the levels (k, 3, n) of a march by `steps` (m,): m + 1 levels, or fewer if the march fails."""
    levels = np.empty((len(steps) + 1, 3, len(nodes)))
    levels[0] = nodes[graph.order].T
    numbers = smoothing.numbers(0.5 * surface.size)
    threads = threads_for(len(nodes), MANY_VISITS)
    with filling("grid", "level", levels[1:, 0, 0]):
        made, _, _ = surface_march(levels, np.cumsum(steps), graph, numbers, threads)
    return levels[: made + 1]


def _respaced(levels: Floats, graph: MarchGraph, steps: Floats) -> Floats:
    """Return the lines (3, n, levels) of a march, with exact first-cell heights."""
    made = len(levels) - 1
    lines = np.empty((3, levels.shape[2], made + 1))
    if made < 2:
        lines[:, graph.order] = np.moveaxis(levels, 0, -1)
        return lines
    fade = exp(-np.arange(made) / FADE)
    respace_lines(levels, steps[:made], fade, graph.order, SWEEPS, lines, threads_for(lines[0].size))
    return lines


def _refusal(
    volume: _Volume, cells: int, tries: int, surface: Surface, hollows: Hollows, remedy: str
) -> NoValidGridError:
    if volume.made < cells:
        problem = f"the march stops after {volume.made} of {cells} cells from the wall"
    else:
        columns = sum((block.counts[0] - 1) * (block.counts[1] - 1) for block in volume.blocks)
        problem = f"{volume.folded} of {cells * columns} cells are folded"
    problem += f" after {tries} tries with other smoothing"
    worst = _worst(volume.blocks)
    under = [int(surface.lattices[cell.block or 0][cell.i, cell.j]) for cell in worst]
    edge = hollows.nearest(surface, np.array(under)) if under else hollows.sharpest()
    smoother = "smoother patches"
    if edge is not None:
        problem += f"; walls meet at an angle of {edge[0]:.0f} degrees at {surface.place(edge[1])}"
        smoother = "a wider or rounded edge there"
    elif under:
        problem += f", the worst above {surface.place(under[0])}"
    remedy = remedy or f"give a nearer {{far_field}}, or {smoother}"
    if not volume.made:
        remedy = "use a smaller {first_cell}"
    return NoValidGridError(f"{problem}; {remedy}", worst)


def _worst(blocks: tuple[Block, ...]) -> list[BadCell]:
    """Return folded cells with the smallest corners, of each block in turn."""
    cells: list[BadCell] = []
    for number, block in enumerate(blocks):
        worst = worst_solids(block.nodes, WORST, BEZIER)
        cells += [replace(cell, block=number) for cell in worst]
    return cells[:WORST]


def _check_parts(surface: Surface, far: float) -> None:
    """Raise InputError if the grids of two parts of a surface, marched to `far`, would overlap."""
    for a, b in combinations(_parts(surface), 2):
        gap = _distance(surface.nodes[a], surface.nodes[b])
        if gap < 2.0 * far:
            places = f"at {surface.place(int(a[0]))} and {surface.place(int(b[0]))}"
            problem = f"parts of the surface, {places}, are {gap:.4g} apart: their grids would overlap"
            remedy = f"give one of them, or a {{far_field}} below {0.5 * gap:.4g}"
            raise InputError(problem, remedy)


def _parts(surface: Surface) -> list[Indices]:
    parts: list[Indices] = []
    for lattice in surface.lattices:
        nodes = np.unique(lattice)
        touched = [part for part in parts if np.isin(nodes, part).any()]
        parts = [part for part in parts if not any(part is other for other in touched)]
        parts.append(np.unique(np.concatenate([nodes, *touched])))
    return parts


def _distance(a: Floats, b: Floats) -> float:
    """Return about the smallest distance between points (n, 3) and (m, 3)."""
    a, b = (points[:: 1 + len(points) // _SAMPLES] for points in (a, b))
    return float(np.sqrt(min(((b - point) ** 2).sum(axis=1).min() for point in a)))
