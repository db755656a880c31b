"""Result of a solver: the grid, the outcome of the computation, and its cost."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import wraps
from typing import TYPE_CHECKING, ParamSpec

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import spelled

if TYPE_CHECKING:
    from meshonet.geometry.aircraft.dimensions import AircraftDimensions
    from meshonet.geometry.rows.dimensions import RowDimensions
    from meshonet.solvers.neural.confidence import Confidence

P = ParamSpec("P")


class Outcome(Enum):
    """How a computation ended; the value is advice on what to try next, empty after success."""

    DONE = ""
    UNCONVERGED = "the iteration stopped short of its tolerance: allow more {max_cycles} or a larger {tol}"
    FOLDED = "cells are folded: use more nodes, another topology or other corners"

    @property
    def message(self) -> str:
        """Advice on what to try next; parameters have their Python names."""
        return spelled(self.value)


@dataclass(frozen=True, eq=False)
class Solution:
    """A grid and how it was made.

    Parameters
    ----------
    grid : the grid.
    method : name of the method: ``tfi``, ``winslow``, ``operator`` ...
    model : name of the neural operator, if one was used.
    outcome : how the computation ended.
    residual : norm of the residual, divided by the norm for the TFI grid, if the method has one.
    cycles : number of cycles on the finest level, if the method has them.
    path : stages after the method itself, such as ``("repair",)``.
    seconds : wall-clock seconds by stage.
    notes : sentences for the user, for example about a restart.
    boundary : boundary of the grid, if a march ended at another far field than the given one.
    confidence : expected error of the grid of a neural operator.
    first_cells : prescribed first-cell heights by side, in the unit of the boundary.
    dimensions : dimensions of the blade row or aircraft, if the grid belongs to one.
    growth : prescribed largest ratio of neighbouring cells along lines from walls.
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
    confidence: Confidence | None = None
    first_cells: Mapping[str, float] = field(default_factory=dict)
    dimensions: RowDimensions | AircraftDimensions | None = None
    growth: float = math.inf


def timed(solve: Callable[P, Solution]) -> Callable[P, Solution]:
    """Return `solve`, changed so that ``seconds["grid"]`` of its solution is the duration of the call."""

    @wraps(solve)
    def run(*args: P.args, **kwargs: P.kwargs) -> Solution:
        begun = time.perf_counter()
        solution = solve(*args, **kwargs)
        return replace(solution, seconds={"grid": time.perf_counter() - begun})

    return run
