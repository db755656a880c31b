"""Moves wall nodes of a four-sided domain along their walls until grid lines leave them at right angles.

Each iteration solves for the grid (one cycle from the previous one), measures the angles of grid lines to the
wall normals, and moves the wall nodes to reduce them. If H is the distance of the walls, an equal
displacement sin(k s) of both walls changes the angles by k tanh(k H/2) times its amplitude, an opposite one
by k coth(k H/2). Sum and difference of the angles are therefore divided by these factors, for each wave
number k. This is done with few nodes; the resulting map from old to new positions along a wall is smooth and
is used for any number of nodes.
"""

import math
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.resample import patches_in_place
from meshonet.geometry.curves.curve import Curve, wall_line
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.elementary import log, product, sin, tanh
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.along_curve import on_corners
from meshonet.solvers.elliptic.control import Controls, Factors
from meshonet.solvers.elliptic.multigrid import Multigrid
from meshonet.solvers.elliptic.wall_control import leaning, lines_from_side

COUNTS = 129, 49  # largest numbers of nodes along and between the walls in the iteration
ROUNDS = 60  # largest number of iterations

UPRIGHT = math.sin(math.radians(0.05))
"""Sine of the largest remaining angle between a grid line and the wall normal."""

RELAXATION = 0.7  # part of the linearised displacement that a round moves by
RAMP = 0.03  # distance from ends and kinks, over the length of the wall, within which nodes slide less
ROOM = 0.4  # largest relative change of a step between wall nodes in an iteration


def slide_walls(boundary: Boundary) -> tuple[Boundary, Controls | None]:
    """Return the quad `boundary` with nodes moved on south and north, and a control function for the solver.

    The grid lines of an elliptic grid inside the new boundary leave both walls at right angles, except next
    to oblique west and east sides and at kinks of the walls. The control function φ(ξ) preserves the node
    spacing, averaged over both given walls. If this spacing is even, None is returned in its place.

    Raises InputError if the topology is not ``quad``.
    """
    if boundary.around_body:
        problem = f"walls of topology {boundary.topology} cannot slide"
        raise InputError(problem, "slide those of channels", parameter="slide")
    curves = wall_line(boundary.south), wall_line(boundary.north)
    knots = curves[0].knots, curves[1].knots
    m, n = (min(count, most) for count, most in zip((boundary.ni, boundary.nj), COUNTS, strict=True))
    if m < 5 or n < 5:
        return boundary, _controls(*knots, boundary.nj)
    few = np.linspace(0.0, boundary.ni - 1.0, m)
    index = np.arange(float(boundary.ni))
    starts = np.interp(few, index, knots[0]), np.interp(few, index, knots[1])
    ends = _slid(boundary, curves, starts, n)
    sides = []
    for side, curve, old, start, end in zip(("south", "north"), curves, knots, starts, ends, strict=True):
        new = on_corners(monotone_cubic(start, end, old), _inner_corners(curve))
        edge = curve.at(new)
        edge[[0, -1]] = getattr(boundary, side)[[0, -1]]
        sides.append(edge)
    slid = replace(boundary, south=sides[0], north=sides[1], sensors=None)
    return replace(slid, patches=patches_in_place(boundary, slid)), _controls(*knots, boundary.nj)


def _inner_corners(curve: Curve) -> Floats:
    return curve.corners[(curve.corners > 0) & (curve.corners < curve.length)]


def _controls(south: Floats, north: Floats, nj: int) -> Controls | None:
    """Return φ(ξ) for the mean spacing of two walls with arc lengths (n,), None if it is even."""
    steps = log(np.diff(0.5 * (south / south[-1] + north / north[-1])))
    ratios = np.zeros(len(south))
    ratios[1:-1] = np.diff(steps)
    if np.abs(ratios).max() < 1e-6:
        return None
    return Controls(Factors(ratios[None], np.ones((1, nj))), Factors.none(len(south), nj))


def _slid(
    boundary: Boundary, curves: tuple[Curve, Curve], starts: tuple[Floats, Floats], n: int
) -> tuple[Floats, Floats]:
    """Return arc lengths (m,) on both walls for which lines of a grid of m x n nodes are normal to them."""
    m = len(starts[0])
    few = np.linspace(0.0, boundary.nj - 1.0, n)
    sides = [_between(getattr(boundary, side), few) for side in ("west", "east")]
    arcs = [start.copy() for start in starts]
    best, least = (starts[0].copy(), starts[1].copy()), np.inf
    nodes = planar_nodes(m, n)
    edges = curves[0].at(arcs[0]), curves[1].at(arcs[1]), sides[0], sides[1]
    for edge, side in zip(edges[:2], (0, -1), strict=True):
        edge[0], edge[-1] = sides[0][side], sides[1][side]
    levels = Multigrid(nodes, edges, False, controls=_controls(*starts, n))
    levels.nested_iteration()
    for _ in range(2):
        levels.cycle()
    waves = _waves(m)
    relaxation = RELAXATION
    for _ in range(ROUNDS):
        leans = _leans(nodes, curves, arcs)
        lean = float(np.sqrt(np.mean(np.square(leans))))
        if not lean < 4.0 * least:  # NaN, or divergence
            break
        if lean < least:
            best, least = (arcs[0].copy(), arcs[1].copy()), lean
        elif relaxation > 0.1:
            relaxation *= 0.8
        if max(np.abs(sine).max() for sine in leans) < UPRIGHT:
            break
        apart = float(np.hypot(*(nodes[:, -1] - nodes[:, 0]).T).mean())
        moves = _displacements(leans, arcs, waves, apart)
        for k, curve in enumerate(curves):
            arcs[k] = _moved(arcs[k], relaxation * moves[k])
            edge = curve.at(arcs[k])
            edge[[0, -1]] = nodes[[0, -1], -k]
            _move_wall(nodes, edge, k)
        levels.cycle()
    return best


def _between(edge: Floats, places: Floats) -> Floats:
    """Return points on the curve through an edge at fractional indices `places`; the ends are exact."""
    curve = Curve(edge)
    points = curve.at(np.interp(places, np.arange(float(len(edge))), curve.knots))
    points[[0, -1]] = edge[[0, -1]]
    return points


def _leans(nodes: Floats, curves: tuple[Curve, Curve], arcs: list[Floats]) -> list[Floats]:
    """Return the sine (m,) of the angle to each wall's normal, reduced towards ends and kinks."""
    leans = []
    for curve, arc, side in zip(curves, arcs, ("south", "north"), strict=True):
        lean = leaning(lines_from_side(nodes, side), curve.tangent(arc))
        fixed = np.concatenate([[0.0], _inner_corners(curve), [curve.length]])
        away = np.abs(arc[:, None] - fixed).min(axis=1)
        leans.append(lean * np.clip(away / (RAMP * curve.length), 0.0, 1.0))
    return leans


def _waves(m: int) -> Floats:
    """Return sines (m - 2, m - 2) that transform inner values to amplitudes and, up to 2/(m - 1), back."""
    k = np.arange(1, m - 1)
    return sin(np.pi * np.outer(k, k) / (m - 1))


def _displacements(
    leans: list[Floats], arcs: list[Floats], waves: Floats, apart: float
) -> tuple[Floats, Floats]:
    """Return the displacements (m,) along both walls that remove the angles to first order."""
    m = len(arcs[0])
    k = 2.0 * np.pi * np.arange(1, m - 1) / (arcs[0][-1] + arcs[1][-1])
    both, contrary = (
        product(waves, product(waves, lean[1:-1]) * (2.0 / (m - 1)) / (k * response))
        for lean, response in (
            (0.5 * (leans[0] + leans[1]), tanh(0.5 * k * apart)),
            (0.5 * (leans[0] - leans[1]), 1.0 / tanh(0.5 * k * apart)),
        )
    )
    return np.pad(both + contrary, 1), np.pad(both - contrary, 1)


def _moved(arcs: Floats, move: Floats) -> Floats:
    """Return arcs (m,) displaced by `move` (m,), scaled down so that no step changes by more than `ROOM`."""
    steps = np.diff(arcs)
    steps = steps * (1.0 + np.clip(np.diff(move) / steps, -ROOM, ROOM))
    moved = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(moved * (arcs[-1] / moved[-1]))


def _move_wall(nodes: Floats, edge: Floats, k: int) -> None:
    """Put an edge (m, 2) into the first (k = 0) or last row; the displacement of other rows decreases."""
    n = nodes.shape[1]
    share = np.linspace(1.0, 0.0, n) if k == 0 else np.linspace(0.0, 1.0, n)
    shift = edge - nodes[:, -k]
    nodes[1:-1] += share[None, :, None] * shift[1:-1, None]
    nodes[1:-1, -k] = edge[1:-1]
