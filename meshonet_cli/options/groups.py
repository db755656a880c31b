"""Groups of options in help texts, dataclasses of options, and errors for invalid values."""

import dataclasses
import functools
import inspect
from collections.abc import Callable
from typing import Annotated, Any, get_origin

import typer

IO, SAMPLING, BOUNDARY_LAYER = "Input and output", "Sampling", "Boundary layer"
DOMAIN, VOLUME = "Multi-block grids", "Volumes"
METHOD, CHECKS = "Method", "Checks"
"""Headings of the groups of options in help texts."""
GROUPS = (IO, SAMPLING, BOUNDARY_LAYER, DOMAIN, VOLUME, METHOD, CHECKS)  # in the order of the help text


def option_of(group: str) -> Callable[..., Any]:
    """Return `typer.Option` for an option of `group`; defaults are shown only in help texts."""
    return functools.partial(typer.Option, rich_help_panel=group, show_default=False)


def expanded(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` with the fields of its dataclass parameters as separate parameters.

    The function receives the options of a block as one object::

        def tfi(boundary: Boundaries, grids: GridOptions, sides: SideOptions): ...
    """
    options: list[inspect.Parameter] = []
    blocks: list[tuple[str, Any, list[str]]] = []
    for parameter in inspect.signature(function).parameters.values():
        block = parameter.annotation
        if not (isinstance(block, type) and dataclasses.is_dataclass(block)):
            options.append(parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY))
            continue
        blocks.append((parameter.name, block, []))
        for each in inspect.signature(block).parameters.values():
            if get_origin(each.annotation) is Annotated:
                blocks[-1][2].append(each.name)
                options.append(each.replace(kind=inspect.Parameter.KEYWORD_ONLY))

    @functools.wraps(function)
    def call(**values: Any) -> Any:
        for name, made, own in blocks:
            values[name] = made(**dict(zip(own, map(values.pop, own), strict=True)))
        return function(**values)

    call.__signature__ = inspect.Signature(options)  # type: ignore[attr-defined]
    call.__annotations__ = {}
    return call


def bad_value(text: str, what: str, remedy: str, parameter: str) -> Exception:
    """Return the InputError for an option whose `text` is not what was expected (`what`)."""
    from meshonet.geometry.errors import InputError

    return InputError(f"{text!r} is not {what}", remedy, parameter=parameter)


def numbers(text: str | None, counts: tuple[int, ...], what: str, remedy: str, parameter: str) -> Any:
    """Return the numbers in the text of an option, None for None; `counts` says how many are permitted.

    Raises InputError: other text.

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


def number(text: str, remedy: str, parameter: str) -> float:
    """Return the number in an option. Raises InputError: other text."""
    try:
        return float(text)
    except ValueError:
        raise bad_value(text, "a number", remedy, parameter) from None


def by_name(text: str, kind: Callable[[str], Any], remedy: str, parameter: str) -> dict[str, Any]:
    """Return the values by name in an option NAME=VALUE,NAME=VALUE; `kind` reads a value.

    Raises InputError: other text; a repeated name.

    >>> by_name("inlet=40,outlet=20", int, "use NAME=N", "count")
    {'inlet': 40, 'outlet': 20}
    """
    values: dict[str, Any] = {}
    for part in text.split(","):
        name, _, value = (word.strip() for word in part.rpartition("="))
        try:
            read = kind(value)
        except ValueError:
            name = ""
        if not name:
            raise bad_value(part.strip(), "a name with a value", remedy, parameter)
        if name in values:
            raise bad_value(text, "one value for each name", f"give {name} once", parameter)
        values[name] = read
    return values


def only_with(needed: str, present: bool, **others: object) -> None:
    """Raise InputError if one of the `others` is given without the option `needed`."""
    from meshonet.geometry.errors import InputError

    for name, value in others.items():
        if value is not None and not present:
            remedy = f"give {{{needed}}} as well, or drop {{{name}}}"
            raise InputError(f"{{{name}}} without {{{needed}}}", remedy)
