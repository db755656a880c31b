"""What the options of `solve-pde` make of a solver."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Literal

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.solution import Solution

Method = Callable[[Boundary], Solution]
Coarse = int | Literal["auto"] | None


def at_any_resolution(method: partial[Solution], coarse: Coarse, refine: int = 0, name: str = "") -> Method:
    """Return `method`, solving on `coarse` nodes a direction and evaluating at the boundary's when given.

    Without any it solves in full; ``auto`` leaves that to the method's `name` and the size, but a tolerance,
    a number of cycles or a grid to start from means the full grid. With `refine`, it solves on boundaries
    that are as often coarser first.

    Raises
    ------
    InputError
        coarse and refine together; coarse and a grid to start from: that has the counts of the result.
    """
    if refine:
        from meshonet.solvers.pipeline.sequence import solve_refined

        if isinstance(coarse, int):
            raise InputError("--coarse and --refine both solve on fewer nodes first", "give one of them")
        return partial(solve_refined, method=method, levels=refine)
    settings: dict[str, Any] = method.keywords
    if coarse == "auto" and not settings:
        from meshonet.solvers.pipeline.select import solve_automatic

        return partial(solve_automatic, method=method, name=name)
    if not isinstance(coarse, int):
        return method
    if settings.get("initial") is not None:
        raise InputError("a coarse solve has no use for a grid to start from", "drop --initial or --coarse")
    from meshonet.solvers.elliptic.solve import solve_thomas_middlecoff
    from meshonet.solvers.elliptic.steger_sorenson import solve_steger_sorenson
    from meshonet.solvers.pipeline.coarse import solve_coarse

    # the sweeps know no control functions
    uncontrolled = method.func not in (solve_thomas_middlecoff, solve_steger_sorenson)
    return partial(solve_coarse, method=method, n=coarse, smooth=uncontrolled)


def solver_of(name: str) -> Callable[..., Solution]:
    """Return the solver behind a value of ``--method``: Winslow's where that is no other one's."""
    if name == "variational":
        from meshonet.solvers.energy.variational import solve as minimise

        return minimise
    if name == "steger-sorenson":
        from meshonet.solvers.elliptic.steger_sorenson import solve_steger_sorenson

        return solve_steger_sorenson
    from meshonet.solvers.elliptic.solve import solve, solve_thomas_middlecoff

    return solve_thomas_middlecoff if name == "thomas-middlecoff" else solve


def given(**settings: Any) -> dict[str, Any]:
    """Return the settings that have a value, so that a solver's own defaults stand for the others."""
    return {name: value for name, value in settings.items() if value is not None}
