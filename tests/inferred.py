"""Grids of boundaries by the method that `meshonet infer` takes, before they are checked."""

from collections.abc import Sequence
from typing import Any

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.pipeline.choose_method import method_of
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.solution import Solution


def infer_many(
    boundaries: Sequence[Boundary], model: str | None = None, polish: int | str = "auto", **settings: Any
) -> list[Solution]:
    """Return a solution of each boundary, with settings by the names of options."""
    named = {} if model is None else {"model": model}
    return method_of(GridRequest(settings={"polish": polish, **named, **settings})).solve(boundaries)


def infer(
    boundary: Boundary, model: str | None = None, polish: int | str = "auto", **settings: Any
) -> Solution:
    """Return the solution of one boundary."""
    return infer_many([boundary], model, polish, **settings)[0]
