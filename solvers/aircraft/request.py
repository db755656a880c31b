"""Options of the grid of an aircraft: those of a stack that it has a use for."""

from __future__ import annotations

from typing import Any

from meshonet.solvers.keywords import refuse_given
from meshonet.solvers.stacking.request import StackRequest, stack_request

_OTHERS = ("layers", "revolve", "axis", "cells", "copies")
"""Options of other stacks."""


def aircraft_request(**parameters: Any) -> StackRequest:
    """Return the request with the parameters, fields of `StackRequest`.

    Raises InputError: as `stack_request`, or a parameter that an aircraft has no use for.
    """
    refuse_given("an aircraft", {name: name in parameters for name in _OTHERS})
    return stack_request(**parameters)
