"""Groups of options in help texts; blocks of options, dataclasses whose fields are options; bad values."""

import dataclasses
import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Any, get_origin, get_type_hints

import typer

IO, SAMPLING, BOUNDARY_LAYER = "Input and output", "Sampling", "Boundary layer"
DOMAIN, VOLUME = "Domains of many blocks", "Volumes from surfaces"
METHOD, CHECKS = "Method", "Checks"
"""Headings of groups of options in the help; those above likewise."""
GROUPS = (IO, SAMPLING, BOUNDARY_LAYER, DOMAIN, VOLUME, METHOD, CHECKS)  # in the order of the help text


def option_of(group: str) -> Callable[..., Any]:
    """Return `typer.Option` for an option of `group`; a default is shown where the help text has it."""
    return functools.partial(typer.Option, rich_help_panel=group, show_default=False)


def expanded(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` with the fields of its dataclass parameters as parameters of their own.

    The options of a block are declared once, with their defaults, and the function has them by group::

        @expanded
        def tfi(boundary: Boundaries, grids: GridOptions, sides: SideOptions): ...
    """
    signature, hints = inspect.signature(function), get_type_hints(function, include_extras=True)

    @functools.wraps(function)
    def call(**values: Any) -> Any:
        return function(**_filled(signature, hints, values))

    ordered = sorted(
        (each.replace(kind=inspect.Parameter.KEYWORD_ONLY) for each in _options(signature, hints)),
        key=lambda each: each.default is not inspect.Parameter.empty,
    )
    call.__signature__ = signature.replace(parameters=ordered)  # type: ignore[attr-defined]
    call.__annotations__ = {each.name: each.annotation for each in ordered}
    return call


def _fields(block: Any) -> tuple[inspect.Signature, dict[str, Any]]:
    return inspect.signature(block), get_type_hints(block, include_extras=True)


def _options(signature: inspect.Signature, hints: Mapping[str, Any]) -> Iterator[inspect.Parameter]:
    """Yield the options among parameters, which are annotated as such, and those of blocks."""
    for name, parameter in signature.parameters.items():
        if dataclasses.is_dataclass(hints[name]):
            yield from _options(*_fields(hints[name]))
        elif get_origin(hints[name]) is Annotated:
            yield parameter.replace(annotation=hints[name])


def _filled(signature: inspect.Signature, hints: Mapping[str, Any], values: dict[str, Any]) -> dict[str, Any]:
    """Return parameters by name, blocks made of the values of their options."""
    made: dict[str, Any] = {}
    for name in signature.parameters:
        if dataclasses.is_dataclass(hints[name]):
            made[name] = hints[name](**_filled(*_fields(hints[name]), values))
        elif name in values:
            made[name] = values[name]
    return made


def bad_value(text: str, what: str, remedy: str, parameter: str) -> Exception:
    """Return the InputError for an option's `text`, which is not `what` it should be."""
    from meshonet.geometry.errors import InputError

    return InputError(f"{text!r} is not {what}", remedy, parameter=parameter)


def numbers(text: str | None, counts: tuple[int, ...], what: str, remedy: str, parameter: str) -> Any:
    """Return the numbers of an option, as many as one of `counts`, None for None, or raise InputError.

    >>> numbers("0,57.5", (2,), "a vector", "use DX,DY", "pitch")
    (0.0, 57.5)
    """
    if text is None:
        return None
    try:
        values = tuple(float(word) for word in text.split(","))
    except ValueError:
        values = ()
    if len(values) not in counts:
        raise bad_value(text, what, remedy, parameter)
    return values


def only_with(needed: str, present: bool, **others: object) -> None:
    """Raise InputError when one of the `others` is there (not None) without the option `needed`."""
    from meshonet.geometry.errors import InputError

    for name, value in others.items():
        if value is not None and not present:
            remedy = f"give {{{needed}}} as well, or drop {{{name}}}"
            raise InputError(f"{{{name}}} without {{{needed}}}", remedy)
