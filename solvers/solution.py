"""What a solver returns: the grid, how it was reached and what that took."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid


@dataclass(frozen=True, eq=False)
class Solution:
    """A grid and the story of its making.

    Parameters
    ----------
    grid : the grid.
    method : what made it: ``tfi``, ``winslow``, ``neural`` ...
    model : name of the operator, when one was used.
    residual : norm of the residual over that of the TFI start, when the method has one.
    cycles : cycles on the finest level, when the method has them.
    path : the stages after the method itself, e.g. the guard's ``("repair",)``.
    seconds : wall-clock seconds by stage.
    notes : sentences a user should read, e.g. that a restart was needed.
    boundary : of the grid, when it is not the one that was given: a march ends at a far field of its own.
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
