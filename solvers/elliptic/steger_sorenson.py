"""Elliptic grids with prescribed angle of grid lines and first-cell height at chosen edges.

Cycles alternate with corrections of the sources at the edges (`wall_control`), first on few nodes.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import arcsin
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.algebraic.resample.grids import refine_grid, thinned
from meshonet.solvers.elliptic.control import Controls, Factors
from meshonet.solvers.elliptic.multigrid import Multigrid
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.elliptic.wall_control import ControlledEdge, first_heights, lines_from_side
from meshonet.solvers.iteration import check_settings
from meshonet.solvers.solution import Solution, timed

FEW = 129  # nodes along a direction up to which sources are sought first
ROUNDS = 80, 12  # rounds of correction at the most, on few nodes and on all
FIRST = 2  # cycles before the first correction
PATIENCE = 12  # rounds without improvement after which the best so far is taken
CLOSE = 0.002  # error (sine of an angle, logarithm of a height; root mean square) at which correction stops
THINNEST = 0.5  # least first-cell height by sources, in those of Winslow's solution
RELAXATION = 0.5  # relaxation factor of the linearised correction


@timed
def solve_steger_sorenson(
    boundary: Boundary, *, heights: Mapping[str, float] | None = None, angle: float = 90.0,
    tol: float | None = None, max_cycles: int = 30, initial: Grid | None = None,
) -> Solution:  # fmt: skip
    """Solve Winslow's equations with sources that control angles and first-cell heights at edges.

    The least first-cell height is half the height without sources; smaller heights are raised to it. Notes
    state the remaining error of the angles, and whether sources were weakened because cells folded.

    Parameters
    ----------
    heights : first-cell height of each controlled side of a quad or O boundary, in its unit. With 0, only the
        angle of the side is controlled. None controls the angles at south and north, or at the body.
    angle : angle in degrees between an edge and the lines that leave it.
    tol, max_cycles, initial : as in `solve`.

    Raises InputError as `solve`, and if a side cannot be controlled or the angle is out of range. Raises
    SolverError if all attempts diverge.
    """
    check_settings(boundary, tol, max_cycles, initial)
    heights = _checked(boundary, heights, angle)
    start = initial.nodes if initial is not None else solve(boundary).grid.nodes
    edges = _edges(boundary, heights, angle, start)
    counts = min(boundary.ni, FEW), min(boundary.nj, FEW)
    if counts != (boundary.ni, boundary.nj) and initial is None:
        small = thinned(boundary, *counts)
        nodes = solve(small).grid.nodes.copy(order="K")
        few = _edges(small, heights, angle, nodes)
        _seek(nodes, small, few, ROUNDS[0])
        for edge, coarse in zip(edges, few, strict=True):
            edge.resample(coarse)
        nodes, rounds = refine_grid(nodes, boundary), ROUNDS[1]
    else:
        nodes, rounds = start.copy(order="K"), ROUNDS[0]
    _seek(nodes, boundary, edges, rounds)
    solution, part = _settled(boundary, start, nodes, edges, tol, max_cycles)
    notes = (*solution.notes, _angle_note(solution.grid.nodes, edges, part))
    return replace(solution, notes=notes)


def largest_lean(nodes: Floats, boundary: Boundary) -> float:
    """Return the largest deviation from 90 degrees of grid lines at south or north, except at corners."""
    sides = ("south", "north")
    edges = _edges(boundary, dict.fromkeys(sides, 0.0), 90.0, nodes)
    sine = max(float(np.abs(edge.errors(nodes)[0]).max()) for edge in edges)
    return math.degrees(math.asin(min(sine, 1.0)))


def _checked(boundary: Boundary, heights: Mapping[str, float] | None, angle: float) -> Mapping[str, float]:
    if boundary.topology == "c":
        problem, remedy = "steger-sorenson has no C grids", "use topology o or method hyperbolic"
        raise InputError(problem, remedy, parameter="method")
    if min(boundary.ni, boundary.nj) < 3:
        problem = f"{boundary.ni}x{boundary.nj} nodes are too few to control lines at walls"
        raise InputError(problem, "use at least 3x3", parameter="res")
    if not 30.0 <= angle <= 150.0:
        raise InputError(f"an angle of {angle:g} degrees at walls", "use 30 to 150", parameter="wall_angle")
    walls = ("south", "north") if not boundary.around_body else ("south",)
    for side in heights or ():
        if boundary.around_body and side != "south":
            problem = f"{side} in topology {boundary.topology} cannot be controlled"
            raise InputError(problem, "control its wall, south")
    return heights or dict.fromkeys(walls, 0.0)


def _edges(
    boundary: Boundary, heights: Mapping[str, float], angle: float, nodes: Floats
) -> list[ControlledEdge]:
    """Return the controlled edges, with heights limited to those that sources can reach from `nodes`."""
    edges = []
    closed = boundary.periodic
    for side, height in heights.items():
        count = boundary.nj if side in ("south", "north") else boundary.ni
        free = float(np.median(first_heights(lines_from_side(nodes, side))))
        held = max(height, THINNEST * free) if height else 0.0
        edges.append(ControlledEdge(side, getattr(boundary, side), count, angle, held, closed))
    return edges


def _sum(edges: Sequence[ControlledEdge], boundary: Boundary) -> Controls:
    none = Factors.none(boundary.ni, boundary.nj)
    return sum((edge.controls() for edge in edges), Controls(none, none))


def _seek(nodes: Floats, boundary: Boundary, edges: Sequence[ControlledEdge], rounds: int) -> None:
    """Iterate on the sources of `edges` and on `nodes`, in place, until angles and heights are right."""
    four = boundary.south, boundary.north, boundary.west, boundary.east
    work = planar_nodes(boundary.ni, boundary.nj)
    levels = Multigrid(work, four, boundary.periodic, controls=_sum(edges, boundary))
    work[...] = nodes
    for _ in range(FIRST):
        levels.cycle()
    best, least, since, relaxation = [edge.sources.copy() for edge in edges], np.inf, 0, RELAXATION
    for _ in range(rounds):
        error = _error(work, edges)
        if error < least:
            best, least, since = [edge.sources.copy() for edge in edges], error, 0
            nodes[...] = work
        else:
            since += 1
        if least < CLOSE or since > PATIENCE:
            break
        if not error < 3.0 * least:
            _restore(edges, best)
            work[...] = nodes
            relaxation *= 0.5
            if relaxation < 0.05:
                break
        for edge in edges:
            edge.correct(work, relaxation)
        levels.control(_sum(edges, boundary))
        levels.cycle()
    _restore(edges, best)


def _error(nodes: Floats, edges: Sequence[ControlledEdge]) -> float:
    """Return the root mean square of the errors at the edges, infinite when `nodes` are not finite."""
    if not np.isfinite(nodes[..., 0].sum() + nodes[..., 1].sum()):
        return np.inf
    errors = [error for edge in edges for error in edge.errors(nodes)]
    return float(max(np.sqrt(np.mean(np.square(error))) for error in errors))


def _restore(edges: Sequence[ControlledEdge], sources: Sequence[Floats]) -> None:
    for edge, kept in zip(edges, sources, strict=True):
        edge.sources[...] = kept


def _settled(
    boundary: Boundary, start: Floats, nodes: Floats, edges: Sequence[ControlledEdge], tol: float | None,
    max_cycles: int,
) -> tuple[Solution, float]:  # fmt: skip
    """Return the solution with fixed sources, and their largest factor with no more folds than `start`."""
    folded, most = count_folded(start), max(_error(start, edges), 5.0 * CLOSE)
    controls = _sum(edges, boundary)
    for part in (1.0, 0.5, 0.25):
        try:
            solution = solve(
                boundary, tol=tol, max_cycles=max_cycles,
                initial=Grid.from_nodes(nodes if part == 1.0 else start, boundary.topology),
                controls=controls.scaled(part), method="steger-sorenson",
            )  # fmt: skip
        except SolverError:
            continue
        nearer = solution.grid.nodes
        if count_folded(nearer) <= folded and _error(nearer, edges) <= most:
            return solution, part
    begun = boundary.grid(start)
    return solve(boundary, tol=tol, max_cycles=max_cycles, initial=begun, method="steger-sorenson"), 0.0


def _angle_note(nodes: Floats, edges: Sequence[ControlledEdge], part: float) -> str:
    off = [np.degrees(arcsin(np.clip(np.abs(edge.errors(nodes)[0]), 0.0, 1.0))) for edge in edges]
    sides, most = ", ".join(edge.side for edge in edges), max(map(np.max, off))
    note = f"lines leave {sides} at {edges[0].angle:g} degrees, off by {most:.1f} at most"
    note += f" and {np.mean(np.concatenate(off)):.2f} on average"
    if part < 1.0:
        note += f"; sources weakened to {part:g} of what that takes, which diverged or folded cells"
    return note
