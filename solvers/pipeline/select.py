"""Which method makes a grid, and on how many nodes, when the user leaves that open."""

from __future__ import annotations

from collections.abc import Callable

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.pipeline.coarse import solve_coarse
from meshonet.solvers.solution import Solution

FEWER = {"auto": (512, 257), "winslow": (512, 257), "variational": (257, 129)}
"""Nodes along a direction above which a method solves on fewer unless told, and how many.

Over random domains at 513 x 513 the mean angle is then within 0.01 degrees of the full solve's.
"""


def solve_automatic(boundary: Boundary, method: Callable[[Boundary], Solution], name: str) -> Solution:
    """Solve with `method` in full, or through fewer nodes where that measures as good and takes less time.

    Parameters
    ----------
    boundary : only large quads are solved on fewer nodes; where those fold, on twice as many. C boundaries
        by ``auto`` are marched (`meshonet.solvers.hyperbolic.default_spacing`) or else minimised, on fewer nodes too: Winslow's lines
        lean by 70 degrees along the wake, where small cells face large ones of the far field.
    method : a solver of boundary to solution.
    name : of the method, as in `FEWER`; others solve in full.

    Returns
    -------
    Solution
        that of `method` or of `solve_coarse`, which the provenance of the grid tells.
    """
    if name == "auto" and boundary.topology == "c":
        return _around_wake(boundary)
    if boundary.topology != "quad":
        return method(boundary)
    return _through_fewer(boundary, method, name)


def _around_wake(boundary: Boundary) -> Solution:
    """Return the C grid that is marched, or where that does not suit the one of least energy."""
    from meshonet.solvers.energy.variational import (
        solve as minimise,  # which evaluates by `meshonet.solvers.pipeline.coarse`
    )
    from meshonet.solvers.hyperbolic.default_spacing import march_unasked

    return march_unasked(boundary) or _through_fewer(boundary, minimise, "variational")


def _through_fewer(boundary: Boundary, method: Callable[[Boundary], Solution], name: str) -> Solution:
    above, n = FEWER.get(name, (0, 0))
    if not n or max(boundary.ni, boundary.nj) <= above:
        return method(boundary)
    solution = solve_coarse(boundary, method, n, smooth=True)
    if count_folded(solution.grid.nodes) == 0:
        return solution
    finer = solve_coarse(boundary, method, 2 * n - 1, smooth=True)
    return min(finer, solution, key=lambda one: count_folded(one.grid.nodes))
