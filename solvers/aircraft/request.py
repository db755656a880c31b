"""Options of the grid of an aircraft: those of a stack that it has a use for, and its number of cells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from meshonet.geometry.errors import InputError
from meshonet.solvers.keywords import refuse_given, request_from
from meshonet.solvers.stacking.request import StackRequest

_OTHERS = ("layers", "revolve", "axis", "copies")
"""Options of other stacks."""
_FEWEST_CELLS, _MOST_CELLS = 20_000, 200_000_000


@dataclass(frozen=True)
class AircraftRequest(StackRequest):
    """Options of the grid of an aircraft: those of `StackRequest`, and its number of cells.

    Parameters
    ----------
    cells : int, optional
        About how many cells there are, in place of `around`.

    Raises
    ------
    InputError
        As `StackRequest`, or a number of cells out of range.
    """

    cells: int | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.cells is not None and not _FEWEST_CELLS <= self.cells <= _MOST_CELLS:
            remedy = f"use {_FEWEST_CELLS} to {_MOST_CELLS}"
            raise InputError(f"{self.cells} cells", remedy, parameter="cells")


def aircraft_request(**parameters: Any) -> AircraftRequest:
    """Return the request with the parameters, fields of `AircraftRequest`.

    Raises InputError: as `AircraftRequest`, a parameter that an aircraft has no use for, or both `cells` and
    `around`.
    """
    refuse_given("an aircraft", {name: name in parameters for name in _OTHERS})
    if "cells" in parameters and "around" in parameters:
        raise InputError("{cells} and {around} both say how fine the grid is", "give one of them")
    return request_from(AircraftRequest, "an aircraft", parameters)
