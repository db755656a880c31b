"""Elliptic grids: initial grid, cycles, stopping criterion, and other attempts on divergence."""

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import SolverError
from meshonet.solvers.elliptic.control import Controls, thomas_middlecoff
from meshonet.solvers.elliptic.multigrid import Multigrid, Settings
from meshonet.solvers.iteration import check_settings, initial_nodes
from meshonet.solvers.progress import cycle_ended
from meshonet.solvers.solution import Outcome, Solution, timed

ATTEMPTS = (Settings(), Settings(coarsest=32, sweeps=4), Settings(coarsest=64, sweeps=8))
"""Settings tried in turn when the residual grows, stalls or is not finite, as around slits and spikes."""

CONTINUATION = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Factors of the control functions for continuation from solution to solution, if the full ones diverge."""

SOLVED = 1e-4  # relative residual that counts as discretisation level when there is no better estimate

SOLVED_BY_INTERPOLATION = 16.0
"""Largest residual of transfinite interpolation, in units of its round-off, for which it is the solution."""


class _DivergedError(Exception):
    """The residual is not finite, or it grew or stalled."""


@timed
def solve(
    boundary: Boundary, *, tol: float | None = None, max_cycles: int = 30, initial: Grid | None = None,
    controls: Controls | None = None, method: str = "winslow",
) -> Solution:  # fmt: skip
    """Solve Winslow's equations for the nodes inside `boundary`, with or without control functions.

    The wake of a C boundary is fixed. At re-entrant corners the resulting grid may be folded;
    `meshonet.solvers.pipeline.fallback.guard` can repair it.

    Parameters
    ----------
    tol : residual at which the iteration ends, relative to the residual of the transfinite interpolation.
        None: it ends when the estimated error of the solution is below the discretisation error.
    max_cycles : largest number of multigrid cycles.
    initial : grid with the same node counts from which the iteration starts; None: nested iteration.

    Raises InputError if a setting is out of range, or if `initial` has other node counts. Raises SolverError
    if all attempts diverge.
    """
    check_settings(boundary, tol, max_cycles, initial)
    notes: tuple[str, ...] = ()
    outcome = Outcome.DONE
    attempts: list[tuple[Settings, tuple[float, ...]]] = [(settings, (1.0,)) for settings in ATTEMPTS]
    if controls is not None:
        attempts.append((ATTEMPTS[-1], CONTINUATION))
    for k, (settings, steps) in enumerate(attempts):
        start = initial if k == 0 else None
        try:
            for part in steps:
                weaker = None if controls is None else controls.scaled(part)
                nodes, residual, cycles = _attempt(boundary, tol, max_cycles, start, settings, weaker, method)
                start = boundary.grid(nodes) if part != 1.0 else None
        except _DivergedError as error:
            notes += (f"attempt {k + 1} diverged ({error})",)
            continue
        if tol is not None and residual > tol:
            outcome = Outcome.UNCONVERGED
            notes += (f"stopped after {cycles} cycles at residual {residual:.1e}, short of {tol:g}",)
        facts = {"method": method, "residual": residual, "cycles": cycles}
        grid = boundary.grid(nodes, facts)
        return Solution(grid, method, residual=residual, cycles=cycles, notes=notes, outcome=outcome)
    name = "Winslow's equations" if controls is None else f"the equations of {method}"
    problem = f"{name} diverged from every start ({'; '.join(notes)})"
    raise SolverError(f"{problem}; use more nodes, variational or tfi")


def solve_thomas_middlecoff(
    boundary: Boundary, *, tol: float | None = None, max_cycles: int = 30, initial: Grid | None = None
) -> Solution:
    """Solve Winslow's equations with the control functions of `thomas_middlecoff`; see `solve`."""
    return solve(
        boundary, tol=tol, max_cycles=max_cycles, initial=initial, controls=thomas_middlecoff(boundary),
        method="thomas-middlecoff",
    )  # fmt: skip


def _attempt(
    boundary: Boundary, tol: float | None, max_cycles: int, initial: Grid | None, settings: Settings,
    controls: Controls | None, method: str,
) -> tuple[Floats, float, int]:  # fmt: skip
    """Return nodes, relative residual and cycles of one attempt. Raises _DivergedError."""
    nodes = planar_nodes(boundary.ni, boundary.nj)
    edges = (boundary.south, boundary.north, boundary.west, boundary.east)
    levels = Multigrid(nodes, edges, boundary.periodic, settings, controls)
    if initial is None:
        start = levels.nested_iteration()
    else:
        levels.interpolate_edges(0)
        start = levels.residual()
        nodes[...] = initial_nodes(boundary, initial)
    noise = _round_off(boundary)
    if start <= SOLVED_BY_INTERPOLATION * noise:  # a rectangle, say
        levels.interpolate_edges(0)
        return nodes, 0.0, 0
    goal = max((SOLVED if tol is None else tol) * start, noise)
    estimate = tol is None and initial is None
    residuals = [levels.residual()]
    corrections: list[float] = []
    cycle_ended(method, nodes, 0, residuals[0] / start)
    while not residuals[-1] <= goal and len(corrections) < max_cycles:
        corrections.append(levels.cycle())
        residuals.append(levels.residual())
        cycle_ended(method, nodes, len(corrections), residuals[-1] / start, corrections[-1])
        if _diverges(residuals, start, 1.5 if settings == ATTEMPTS[0] else 10.0):
            raise _DivergedError(f"residual {residuals[-1] / start:.1e} after {len(corrections)} cycles")
        if estimate and residuals[-1] < 0.5 * start and _at_discretisation_level(corrections):
            break
    return nodes, residuals[-1] / start, len(corrections)


def _round_off(boundary: Boundary) -> float:
    """Return the residual due to rounding: that of alpha x_xi_xi, with steps h and coordinates of size x."""
    edges = [getattr(boundary, side) for side in SIDES]
    size = max(float(np.abs(edge).max()) for edge in edges)
    step = float(np.sqrt(np.mean(np.concatenate([np.diff(edge, axis=0) for edge in edges]) ** 2)))
    return 4.0 * float(np.finfo(float).eps) * size * step**2


def _diverges(residuals: list[float], start: float, growth: float) -> bool:
    """Return whether the residual is not finite, grows by `growth`, or stands still well above round-off."""
    if not np.isfinite(residuals[-1]):
        return True
    if len(residuals) < 3 or residuals[-1] < 1e-6 * start:
        return False
    stalled = len(residuals) > 8 and residuals[-1] > 0.9 * residuals[-4]
    return stalled or residuals[-1] > growth * residuals[-2]


def _at_discretisation_level(corrections: list[float]) -> bool:
    """Return whether the error left by the cycles is below that of the discretisation.

    The first correction is about three times the discretisation error of a second-order scheme. With the last
    correction c and the ratio ρ of the last two, the error left is about c ρ / (1 - ρ).
    """
    if len(corrections) < 2 or corrections[-1] == 0.0:
        return False
    rate = corrections[-1] / corrections[-2]
    return rate < 0.9 and corrections[-1] * rate / (1.0 - rate) <= corrections[0] / 3.0
