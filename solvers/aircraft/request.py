"""Options of the grid of an aircraft: those of a stack that it has a use for."""

from __future__ import annotations

from typing import Any

from meshonet.geometry.errors import InputError
from meshonet.solvers.stacking.request import StackRequest, stack_request

_OTHERS = ("layers", "revolve", "axis", "cells", "copies")
"""Options of other stacks."""


def aircraft_request(**parameters: Any) -> StackRequest:
    """Return the request with the parameters, fields of `StackRequest`.

    Raises InputError: as `stack_request`, or a parameter that an aircraft has no use for.
    """
    check_aircraft_options(**{name: name in parameters for name in _OTHERS})
    return stack_request(**parameters)


def check_aircraft_options(**given: object) -> None:
    """Raise InputError for the first of the options, by name, that is given: neither None nor False."""
    for name, value in given.items():
        if value is not None and value is not False:
            raise InputError(f"an aircraft has no {{{name}}}", f"leave {{{name}}} out")
