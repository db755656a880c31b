"""The airfoil O operator: lift, harmonic base, network, Picard polish, evaluation at any resolution.

A boundary's two walls are lifted to a periodic strip, where the harmonic extension of the walls nearly solves
Winslow's equations; the network adds the difference, Picard's iteration polishes, and the separable sum is
evaluated at the grid's nodes. Polished until it changes nothing the answer is the same without the network,
in less time: unless a model is named, the network answers only alone or before a given number of steps.
Compact bodies the lift cannot take go to the model for bodies, unless a model was named, other boundaries to
the elliptic solver, and the solution says so.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.conformal.lift import Lift, lift_body, mirrored
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.polygon.mirror import Axis, handedness
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.conformal.bisector import halve_corners
from meshonet.solvers.conformal.evaluate import StripGrid
from meshonet.solvers.conformal.strip import MODES, across, harmonic, modes, picard
from meshonet.solvers.neural.weights import Model, load_model
from meshonet.solvers.solution import Solution

Polish = Literal["auto", "off"] | int

AUTO_STEPS = 8  # the most steps that "auto" takes
SETTLED = 2e-4  # and the change (radians) below which it stops: what is left is a tenth of that, or less
WILD = 0.5  # a change of phi above this means that Picard's iteration diverges
SHARPEST = {
    "wall": 0.017,
    "far field": 1e-3,
}  # amplitude (radians) that a wall may have beyond half the modes
ROUGHEST = 0.1  # of an airfoil's wall, when it is spacing that is uneven and not the body
TURNED = np.radians(25.0)  # a turn at one node of a wall whose spacing is uneven: its line halves the angle
BENT = np.radians(85.0)  # a turn at one node, trailing corners aside: of a body with other corners


def infer(boundary: Boundary, model: str | None = None, polish: Polish = "auto") -> Solution:
    """Return the grid inside `boundary`, by the operator shipped for its topology where there is one.

    Parameters
    ----------
    boundary : ``o`` goes to the operator; ``quad`` to the variational method, which measures best for a
        single grid; ``c`` is marched where that is possible, and else variational too.
    model : name of a shipped model or path to a ``.safetensors`` file; ``base`` is the harmonic base with no
        network, which None takes with ``auto`` polish, and the shipped model otherwise.
    polish : Picard steps after the network: a number, ``off`` for none, ``auto`` until they change nothing.

    Returns
    -------
    Solution
        its boundary nodes are bitwise those of `boundary`.

    Raises
    ------
    InputError
        a model that does not exist or cannot be read.
    """
    if not boundary.periodic:
        from meshonet.solvers.energy.variational import solve
        from meshonet.solvers.pipeline.select import solve_automatic

        if model is not None:
            told = f"model {model} makes o grids, and this boundary is {boundary.topology}"
            raise InputError(told, "use another model, or leave --model out")
        if not boundary.around_body:
            return solve_automatic(boundary, solve, "variational")
        found = solve_automatic(boundary, solve, "auto")
        note = f"no shipped model makes {boundary.topology} grids: this one is {found.method}"
        return replace(found, notes=(note, *found.notes))
    return infer_strips([boundary], model, polish)[0]


def infer_strips(
    boundaries: Sequence[Boundary], model: str | None = None, polish: Polish = "auto"
) -> list[Solution]:
    """Return what `infer` does for each of some O boundaries, with one pass of the network for all.

    Raises
    ------
    InputError
        a model that does not exist or cannot be read.
    """
    alone = model == "base" or (model is None and polish == "auto")
    network = None if alone else load_model(model)
    across()  # like the model, made once a process: neither is part of a grid's time
    begun = time.perf_counter()
    lifted = [_lifted(boundary) for boundary in boundaries]
    starts = iter(_starts([found for found, _ in lifted if isinstance(found, Walls)], network))
    shared = (time.perf_counter() - begun) / max(len(boundaries), 1)
    named = model is not None or polish != "auto"
    return [
        _refused(boundary, found, time.perf_counter() - shared, named=named)
        if isinstance(found, InputError)
        else _gridded(boundary, found, rough, next(starts), polish, network, time.perf_counter() - shared)
        for boundary, (found, rough) in zip(boundaries, lifted, strict=True)
    ]


def _refused(boundary: Boundary, error: InputError, begun: float, *, named: bool) -> Solution:
    """Return the grid of a body that the operator cannot take; `named`: model or polish were asked for."""
    why = f"the operator cannot take this body ({error.problem})"
    return (None if named else _around(boundary, why, begun)) or _elliptic(boundary, why, begun)


def _gridded(
    boundary: Boundary, found: Walls, rough: bool, start: Complexes, polish: Polish, network: Model | None,
    begun: float,
) -> Solution:  # fmt: skip
    c, changes = _polished(start, polish)
    if changes and not changes[-1] < WILD:
        return _elliptic(boundary, "the operator's polish diverged", begun)
    nodes, finite = _evaluated(boundary, found, c)
    if rough and count_folded(nodes):
        nodes, finite = _evaluated(boundary, found._replace(corners=_turns(found)), c)
    if rough and count_folded(nodes):
        with suppress(SolverError):
            other = _elliptic(boundary, "the operator folds cells of uneven spacing", begun)
            if not count_folded(other.grid.nodes):
                return other
    spent = time.perf_counter() - begun
    model = network.name if network else "base"
    facts = {"method": "operator", "model": model, "polish": len(changes)}
    return Solution(
        boundary.grid(nodes, facts, finite=finite),
        "operator",
        model=model,
        residual=changes[-1] if changes else None,
        cycles=len(changes),
        seconds={"grid": spent},
    )


class Walls(NamedTuple):
    """A body's two walls in the strip.

    `lift` to the plane; F on the `wall` and on the `far` field (n,), where F = w - i theta is periodic and
    n = ni - 1; the wall's nodes `z`; its trailing `corners`; the `axis` of a boundary that is its own mirror
    image, and which of the two mirror images it is otherwise (`hand`).
    """

    lift: Lift
    wall: Complexes
    far: Complexes
    z: Complexes
    corners: tuple[int, ...]
    axis: Axis | None
    hand: int


def walls(boundary: Boundary) -> Walls:
    """Return the walls of an O boundary in the strip. Raises InputError when the body cannot be lifted."""
    z, far = mirrored(boundary.south[:-1]), mirrored(boundary.north[:-1])
    hand, (point, direction) = handedness(z, far)
    # near the origin: the map's branch points feel what far places round off
    lift, w, corners = lift_body(z - z[0], swap=hand < 0)
    theta = 2.0 * np.pi * np.arange(len(z)) / len(z)
    away = lift.to_strip(far - z[0])
    lift = replace(lift, centre=lift.centre + z[0])
    away -= 2j * np.pi * np.round((away.imag - w.imag).mean() / (2.0 * np.pi))
    axis = None if hand else (point.conjugate(), direction.conjugate())
    return Walls(lift, w - 1j * theta, away - 1j * theta, z, corners, axis, hand)


def _roughness(found: Walls) -> bool:
    """Return whether uneven spacing outruns the strip's modes a little, so that a grid may fold.

    Airfoils have at most 0.013 in the wall, 0.06 where nodes are evenly spaced around the leading edge;
    polygons at least 0.02; a square far field has 0.01. Raises InputError when the strip does not resolve it.
    """
    n = len(found.wall)
    k = np.minimum(np.arange(n), n - np.arange(n))
    rough = False
    for name, F in (("wall", found.wall), ("far field", found.far)):
        sharp = float(np.abs(np.fft.fft(F))[(k > MODES // 2) & (k <= MODES)].sum() / n)
        if sharp > SHARPEST[name]:
            rough = name == "wall" and sharp < ROUGHEST and bool(found.corners) and not _bent(found)
            if not rough:
                raise InputError(f"its {name} has corners or spacing that the strip does not resolve")
    return rough


def _bent(found: Walls) -> bool:
    """Return whether the body has a corner that is no trailing one."""
    turn = np.abs(_turn(found))
    turn[list(found.corners)] = 0.0
    return bool(turn.max() > BENT)


def _turns(found: Walls) -> tuple[int, ...]:
    """Return the trailing corners, and the nodes at which the wall turns so much that lines may cross it."""
    others = set(np.flatnonzero(_turn(found) > TURNED).tolist()) - set(found.corners)
    return (*found.corners, *sorted(others))


def _turn(found: Walls) -> Floats:
    """Return the angle (n,) by which the wall turns at every node."""
    return turning(np.stack([found.z.real, found.z.imag], axis=1), closed=True)


def _lifted(boundary: Boundary) -> tuple[Walls | InputError, bool]:
    """Return the walls in the strip, or why there are none, and whether the body's is rough."""
    try:
        found = walls(boundary)
        return found, _roughness(found)
    except InputError as error:
        return error, False


def _starts(found: Sequence[Walls], network: Model | None) -> list[Complexes]:
    """Return where Picard's iteration starts for each of some walls: the base, and what the network adds."""
    ends = [(modes(one.wall), modes(one.far)) for one in found]
    added: Iterable[Complexes | float] = (0.0 for _ in found)
    if network is not None and found:
        a, b = (np.array(side) for side in zip(*ends, strict=True))
        added = network.residual(a, b, np.array([one.hand for one in found]))
    return [harmonic(a, b, across().eta) + more for (a, b), more in zip(ends, added, strict=True)]


def _polished(c: Complexes, polish: Polish) -> tuple[Complexes, list[float]]:
    """Return the modes after polish, and the largest change in each Picard step."""
    changes: list[float] = []
    for _ in range(AUTO_STEPS if polish == "auto" else 0 if polish == "off" else polish):
        c, change = picard(c, 1)
        changes += change
        if not change[0] < WILD or (polish == "auto" and change[0] < SETTLED):
            break
    return c, changes


def _evaluated(boundary: Boundary, found: Walls, c: Complexes) -> tuple[Floats, bool]:
    """Return the nodes of a strip solution, and whether they are finite."""
    nodes = planar_nodes(boundary.ni, boundary.nj)
    grid = StripGrid(c, found.wall, found.far, np.linspace(0.0, 1.0, boundary.nj))
    halve_corners(grid, found.lift, found.z, found.corners)
    finite = grid.fill(found.lift, nodes, found.axis)
    nodes[:, 0], nodes[:, -1] = boundary.south, boundary.north
    return nodes, finite


def _around(boundary: Boundary, why: str, begun: float) -> Solution | None:
    """Return the grid by `hole-o` of a compact body, None where that has folds."""
    from meshonet.solvers.algebraic.resample.grids import thinned
    from meshonet.solvers.neural.quads.around import compact
    from meshonet.solvers.neural.quads.encoding import LATENT
    from meshonet.solvers.neural.quads.inference import infer_quads
    from meshonet.solvers.neural.quads.unrolled import AROUND

    if boundary.ni < LATENT or not compact(boundary):
        return None
    try:
        coarse = infer_quads([thinned(boundary, AROUND, LATENT)], "hole-o", "off")[0]
        if count_folded(coarse.grid.nodes):
            return None  # to unfold it takes longer than to solve
        found = infer_quads([boundary], "hole-o")[0]
    except InputError:
        return None
    if count_folded(found.grid.nodes):
        return None
    return replace(found, notes=(f"{why}: hole-o used",), seconds={"grid": time.perf_counter() - begun})


def _elliptic(boundary: Boundary, why: str, begun: float) -> Solution:
    from meshonet.solvers.elliptic.solve import solve

    found = solve(boundary)
    return replace(
        found,
        notes=(f"{why}: elliptic solver used", *found.notes),
        seconds={"grid": time.perf_counter() - begun},
    )
