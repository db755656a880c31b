"""The groups of options in help texts, and what all options have in common."""

from collections.abc import Callable
from functools import partial
from typing import Any

import typer

IO, SAMPLING, BOUNDARY_LAYER = "Input and output", "Sampling", "Boundary layer"
DOMAIN, VOLUME = "Domains of many blocks", "Volumes from surfaces"
METHOD, CHECKS = "Method", "Checks"
GROUPS = (IO, SAMPLING, BOUNDARY_LAYER, DOMAIN, VOLUME, METHOD, CHECKS)  # in the order of the help text


def option_of(group: str) -> Callable[..., Any]:
    """Return `typer.Option` for an option of `group`; a default is shown where the help text has it."""
    return partial(typer.Option, rich_help_panel=group, show_default=False)


def bad_value(text: str, what: str, remedy: str, parameter: str) -> Exception:
    """Return the InputError for an option's `text`, which is not `what` it should be."""
    from meshonet.geometry.errors import InputError

    return InputError(f"{text!r} is not {what}", remedy, parameter=parameter)


def only_with(needed: str, present: bool, **others: object) -> None:
    """Raise InputError when one of the `others` is there (not None) without the option `needed`."""
    from meshonet.geometry.errors import InputError

    for name, value in others.items():
        if value is not None and not present:
            remedy = f"give {{{needed}}} as well, or drop {{{name}}}"
            raise InputError(f"{{{name}}} without {{{needed}}}", remedy)
