"""Requests from keyword parameters, and errors for parameters that do not apply."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, TypeVar

from meshonet.geometry.errors import InputError

Request = TypeVar("Request")


def request_from(kind: type[Request], what: str, parameters: Mapping[str, Any]) -> Request:
    """Return a request of the class `kind`; ``wall_spacing`` is another name of the field ``first_cell``.

    Raises InputError for unknown parameters and wrong values. `what` names the kind of grid in messages.
    """
    named = {"first_cell" if name == "wall_spacing" else name: each for name, each in parameters.items()}
    known = {each.name for each in fields(kind)}  # type: ignore[arg-type]
    refuse_given(what, {name: True for name in named if name not in known})
    return kind(**named)


def refuse_given(what: str, options: Mapping[str, object]) -> None:
    """Raise InputError, with `what`, if one of the `options` is given (not None or False)."""
    for name, value in options.items():
        if value is not None and value is not False:
            raise InputError(f"{what} has no {{{name}}}", f"leave {{{name}}} out")
