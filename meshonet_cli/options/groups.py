"""Groups of options in help texts, dataclasses of options, and errors for invalid values."""

import dataclasses
import functools
import inspect
from collections.abc import Callable
from typing import Annotated, Any, Literal, get_args, get_origin

import typer

from meshonet_cli.terminal.errors import option

IO, SAMPLING, BOUNDARY_LAYER = "Input and output", "Sampling", "Boundary layer"
DOMAIN, VOLUME = "Multi-block grids", "Volumes"
METHOD, CHECKS = "Method", "Checks"
"""Headings of the groups of options in help texts."""
GROUPS = (IO, SAMPLING, BOUNDARY_LAYER, DOMAIN, VOLUME, METHOD, CHECKS)  # in the order of the help text


def option_of(group: str) -> Callable[..., Any]:
    """Return a function that declares an option of the group `group`, as a default value or in `Annotated`.

    The function takes the names of the option, its ``default``, and the arguments ``metavar``, ``help``,
    ``min`` and ``max`` of `typer.Option`. Without names, the option is named after the parameter; without
    ``metavar``, the choices are shown. Help texts show defaults that are numbers or words.
    """

    def declared(*names: str, default: Any = None, **settings: Any) -> Any:
        return dataclasses.field(
            default=default, metadata={"names": names, "rich_help_panel": group, **settings}
        )

    return declared


def expanded(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` with single options as parameters, in place of dataclasses that group options.

    The given `function` has, for each group, one parameter, whose annotation is the dataclass::

        def tfi(boundary: Boundaries, grids: GridOptions, sides: SideOptions): ...
    """
    options: list[inspect.Parameter] = []
    blocks: list[tuple[str, Any, list[str]]] = []
    for parameter in inspect.signature(function).parameters.values():
        block = parameter.annotation
        if not (isinstance(block, type) and dataclasses.is_dataclass(block)):
            options += _taken_by_typer(parameter.name, block, parameter.default)
            continue
        blocks.append((parameter.name, block, []))
        for field in dataclasses.fields(block):
            for each in _taken_by_typer(field.name, field.type, field):
                blocks[-1][2].append(each.name)
                options.append(each)

    @functools.wraps(function)
    def call(**values: Any) -> Any:
        for name, made, own in blocks:
            values[name] = made(**dict(zip(own, map(values.pop, own), strict=True)))
        return function(**values)

    call.__signature__ = inspect.Signature(options)  # type: ignore[attr-defined]
    call.__annotations__ = {}
    return call


def _taken_by_typer(name: str, kind: Any, default: Any) -> list[inspect.Parameter]:
    """Return an option or argument in the form that typer takes; nothing for a field that is neither."""
    declared = default
    if get_origin(kind) is Annotated:
        kind, declared = get_args(kind)
    if isinstance(default, dataclasses.Field):
        default = inspect.Parameter.empty if default.default is dataclasses.MISSING else default.default
    if isinstance(declared, dataclasses.Field):
        if not declared.metadata:
            return []
        settings = dict(declared.metadata)
        names = settings.pop("names") or [option(name)]
        for each in (kind, *get_args(kind)):
            if get_origin(each) is Literal:
                settings.setdefault("metavar", "|".join(get_args(each)))
        shown = isinstance(default, int | float | str) and not isinstance(default, bool) and default != ""
        declared = typer.Option(*names, show_default=shown, **settings)
    kind = Annotated[kind, declared]
    return [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=kind)]


def bad_value(text: str, what: str, remedy: str, parameter: str) -> Exception:
    """Return the error for an option with the value `text`; `what` says what the value should be."""
    from meshonet.geometry.errors import InputError

    return InputError(f"{text!r} is not {what}", remedy, parameter=parameter)


def numbers(text: str | None, counts: tuple[int, ...], what: str, remedy: str, parameter: str) -> Any:
    """Return the numbers in the text of an option, or None for None; `counts` lists how many are permitted.

    Raises InputError for any other text. The error says what the text should be (`what`), and a `remedy`.

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
    """Return the text of an option as a number. Raises InputError if it is no number."""
    try:
        return float(text)
    except ValueError:
        raise bad_value(text, "a number", remedy, parameter) from None


def by_name(text: str, kind: Callable[[str], Any], remedy: str, parameter: str) -> dict[str, Any]:
    """Return the values of an option NAME=VALUE,NAME=VALUE by name; `kind` converts the text of a value.

    Raises InputError if the text has another form, or if a name is repeated.

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
    """Raise InputError if one of the options `others` is given, but not the option `needed`."""
    from meshonet.geometry.errors import InputError

    for name, value in others.items():
        if value is not None and not present:
            remedy = f"give {{{needed}}} as well, or drop {{{name}}}"
            raise InputError(f"{{{name}}} without {{{needed}}}", remedy)
