"""Options of the grid of an aircraft."""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from meshonet.geometry.errors import InputError
from meshonet.solvers.keywords import refuse_given
from meshonet.solvers.stacking.request import StackRequest

_OTHERS = ("layers", "revolve", "axis", "copies")  # options of stacks that do not apply to an aircraft


@dataclass(frozen=True)
class AircraftRequest(StackRequest):
    """Options for the grid of an aircraft; give a number of `cells` or of nodes `around` wings, not both."""

    what: ClassVar[str] = "an aircraft"
    fewest_cells: ClassVar[int] = 20_000

    @classmethod
    def of(cls, **parameters: Any) -> Self:
        """Return a request with these options. Raises InputError if they are invalid or in conflict."""
        refuse_given(cls.what, {name: name in parameters for name in _OTHERS})
        if "cells" in parameters and "around" in parameters:
            raise InputError("{cells} and {around} both say how fine the grid is", "give one of them")
        return super().of(**parameters)
