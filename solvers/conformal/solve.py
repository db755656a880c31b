"""O grids by a conformal map to a strip, harmonic extension, Picard iteration, evaluation at nodes."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import repeat
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Complexes, Floats, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.conformal.bisector import fading, shifts
from meshonet.solvers.conformal.evaluate import StripGrid
from meshonet.solvers.conformal.strip import across, harmonic, modes, picard
from meshonet.solvers.conformal.walls import StripWalls, is_rough, sharp_turns, walls
from meshonet.solvers.solution import Solution

Polish = Literal["auto", "off"] | int  # steps: a number, ``off`` for none, ``auto`` until they change little

Correction: TypeAlias = Callable[[Complexes, Complexes, NDArray[np.intp]], Complexes]
"""From modes of wall and far field (batch, modes) and handedness (batch,) to modes (batch, modes, LEVELS)."""

AUTO_STEPS = 8  # the most steps that "auto" takes
SETTLED = 2e-4  # change (radians) below which "auto" stops: what is left is a tenth of that, or less
DIVERGED = 0.5  # change of phi (radians) in a step above which Picard's iteration diverges


def solve(
    boundaries: Sequence[Boundary],
    polish: Polish = "auto",
    correction: Correction | None = None,
    model: str | None = None,
    substitute: Callable[[Boundary, str], Solution | None] | None = None,
) -> list[Solution]:
    """Return a grid inside each O boundary; the boundary nodes are bitwise kept.

    `polish` is the number of Picard iterations, ``auto`` or ``off``. They start from harmonic grids.
    `correction` computes, by the network called `model`, terms that are added to these grids. A boundary
    without a conformal map is passed to `substitute`, with the reason. If this function returns None or is
    not given, the elliptic solver makes the grid.
    """
    across()  # made once a process: no part of a grid's time
    begun = time.perf_counter()
    bodies = list(map(_lifted, boundaries))
    added = _corrections(bodies, correction) if correction else repeat(0.0)
    shared = (time.perf_counter() - begun) / max(len(boundaries), 1)
    solutions = []
    for boundary, body in zip(boundaries, bodies, strict=True):
        begun = time.perf_counter() - shared
        if isinstance(body, StripWalls):
            solution = _solved(boundary, body, next(added), polish, model)
        else:
            why = f"the {_called(model)} cannot take this body ({body.problem})"
            solution = (substitute and substitute(boundary, why)) or _elliptic(boundary, why)
        solutions.append(replace(solution, seconds={"grid": time.perf_counter() - begun}))
    return solutions


def conformal(boundary: Boundary, *, polish: Polish = "auto") -> Solution:
    """Return the grid inside an O boundary by Winslow's equations on a strip, the domain's conformal image.

    `polish` is the number of Picard iterations, ``auto`` or ``off``. Raises InputError for other boundaries.
    """
    if boundary.topology != "o":
        what = f"method conformal makes o grids, and this boundary is {boundary.topology}"
        raise InputError(what, "use another {method}")
    return solve([boundary], polish)[0]


def _solved(
    boundary: Boundary, body: StripWalls, added: Complexes | float, polish: Polish, model: str | None
) -> Solution:
    """Return the grid of a body: Picard iteration from its harmonic extension with a correction `added`."""
    steps = AUTO_STEPS if polish == "auto" else 0 if polish == "off" else polish
    start = harmonic(modes(body.wall), modes(body.far), across().eta) + added
    c, changes = picard(start, steps, SETTLED if polish == "auto" else 0.0, DIVERGED)
    if changes and not changes[-1] < DIVERGED:
        return _elliptic(boundary, f"the polish of the {_called(model)} diverged")
    nodes, finite = _evaluated(boundary, body, c)
    if body.rough and count_folded(nodes):
        nodes, finite = _evaluated(boundary, body._replace(corners=sharp_turns(body)), c)
    if body.rough and count_folded(nodes):
        with suppress(SolverError):
            solution = _elliptic(boundary, f"the {_called(model)} folds cells of uneven spacing")
            if not count_folded(solution.grid.nodes):
                return solution
    method = "operator" if model else "conformal"
    facts = {"method": method, **({"model": model} if model else {}), "polish": len(changes)}
    grid = boundary.grid(nodes, facts, finite=finite)
    residual = changes[-1] if changes else None
    return Solution(grid, method, model=model, residual=residual, cycles=len(changes))


def _called(model: str | None) -> str:
    return "operator" if model else "conformal map"


def _lifted(boundary: Boundary) -> StripWalls | InputError:
    """Return the walls in the strip, or the reason why there are none."""
    try:
        body = walls(boundary)
        return body._replace(rough=is_rough(body))
    except InputError as error:
        return error


def _corrections(
    lifted: Sequence[StripWalls | InputError], correction: Correction
) -> Iterator[Complexes | float]:
    bodies = [body for body in lifted if isinstance(body, StripWalls)]
    if not bodies:
        return iter(())
    wall, far = (
        np.array([modes(body.wall) for body in bodies]),
        np.array([modes(body.far) for body in bodies]),
    )
    return iter(correction(wall, far, np.array([body.hand for body in bodies])))


def _evaluated(boundary: Boundary, body: StripWalls, c: Complexes) -> tuple[Floats, bool]:
    nodes = planar_nodes(boundary.ni, boundary.nj)
    grid, shift = StripGrid(c, body.wall, body.far, np.linspace(0.0, 1.0, boundary.nj)), None
    if body.corners and boundary.nj >= 4:
        reach, amounts = shifts(grid, body.lift, body.z, body.corners)
        shift = product(reach, amounts), partial(fading, first=float(grid.eta[1]))
    finite = grid.fill(body.lift, nodes, body.axis, shift)
    nodes[:, 0], nodes[:, -1] = boundary.south, boundary.north
    return nodes, finite


def _elliptic(boundary: Boundary, why: str) -> Solution:
    from meshonet.solvers.elliptic.solve import solve

    solution = solve(boundary)
    return replace(solution, notes=(f"{why}: elliptic solver used", *solution.notes))
