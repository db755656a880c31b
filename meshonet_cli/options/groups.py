"""The groups of options in help texts, and what all options have in common."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import typer

IO, SAMPLING, BOUNDARY_LAYER = "Input and output", "Sampling", "Boundary layer"
METHOD, CHECKS = "Method", "Checks"
GROUPS = (IO, SAMPLING, BOUNDARY_LAYER, METHOD, CHECKS)  # in the order of the help text


def option_of(group: str) -> Callable[..., Any]:
    """Return `typer.Option` for an option of `group`; a default is shown where the help text has it."""
    return partial(typer.Option, rich_help_panel=group, show_default=False)


def only_with(needed: str, given: bool, **others: object) -> None:
    """Raise InputError when an option that needs another one is there (not None) without it.

    `needed`: the other option, by its parameter. `given`: whether it is there. `others`: values by parameter.
    """
    from meshonet.geometry.errors import InputError

    for name, value in others.items():
        if value is not None and not given:
            remedy = f"give {{{needed}}} as well, or drop {{{name}}}"
            raise InputError(f"{{{name}}} without {{{needed}}}", remedy)
