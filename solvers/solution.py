"""What a solver returns: the grid, how the solve ended and what it took."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import wraps
from typing import ParamSpec

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import spelled

P = ParamSpec("P")


class Outcome(Enum):
    """How a solve ended; the value is what to try next, empty when nothing is amiss."""

    DONE = ""
    UNCONVERGED = "the iteration stopped short of its tolerance: allow more {max_cycles} or a larger {tol}"
    FOLDED = "cells are folded: use more nodes, another topology or other corners"

    @property
    def message(self) -> str:
        """What to try next, with parameters by their names in Python."""
        return spelled(self.value)


@dataclass(frozen=True, eq=False)
class Solution:
    """A grid and how it was made.

    Parameters
    ----------
    grid : the grid.
    method : what made it: ``tfi``, ``winslow``, ``operator`` ...
    model : name of the operator, when one was used.
    outcome : how the solve ended.
    residual : norm of the residual over that of the TFI start, when the method has one.
    cycles : cycles on the finest level, when the method has them.
    path : the stages after the method itself, e.g. the guard's ``("repair",)``.
    seconds : wall-clock seconds by stage.
    notes : sentences a user should read, e.g. that a restart was needed.
    boundary : of the grid, when it is not the one that was given: a march ends at a far field of its own.
    first_cells : heights of first cells that were asked for, by side, in the unit of the boundary.
    """

    grid: Grid
    method: str
    model: str | None = None
    residual: float | None = None
    cycles: int | None = None
    path: tuple[str, ...] = ()
    seconds: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    boundary: Boundary | None = None
    outcome: Outcome = Outcome.DONE
    first_cells: Mapping[str, float] = field(default_factory=dict)


def timed(solve: Callable[P, Solution]) -> Callable[P, Solution]:
    """Have a function say in its solution how many seconds it took, as the stage ``grid``."""

    @wraps(solve)
    def run(*args: P.args, **kwargs: P.kwargs) -> Solution:
        begun = time.perf_counter()
        solution = solve(*args, **kwargs)
        return replace(solution, seconds={"grid": time.perf_counter() - begun})

    return run
