"""Methods by their names, with settings: functions of one boundary, or classes of their own."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

from meshonet.geometry.errors import InputError
from meshonet.solvers.pipeline.methods import METHODS, OneByOne

if TYPE_CHECKING:
    from meshonet.geometry.blocks.boundary import Boundary
    from meshonet.geometry.blocks.grid import Grid
    from meshonet.solvers.pipeline.methods import Method
    from meshonet.solvers.solution import Solution


def solved(method: Method, boundary: Boundary, start: Grid | None) -> Solution:
    """Return the solution of one boundary by `method`."""
    return method.solve([boundary], None if start is None else [start])[0]


@dataclass(frozen=True)
class Each(OneByOne):
    """A grid generation method that calls `target` for each boundary. Raises InputError: unknown settings."""

    name: str  # in `METHODS`
    # a function of a boundary, its settings and perhaps ``initial``, a grid to start from; or ``module:name``
    # of one, which is loaded when it is needed
    target: str | Callable[..., Solution]
    settings: Mapping[str, Any] = field(default_factory=dict)  # keywords of the function

    def __post_init__(self) -> None:
        if self.settings:
            _check_settings(self.name, self.function, self.settings)

    @property
    def function(self) -> Callable[..., Solution]:
        """The function that makes the grid of a boundary."""
        return resolve_name(self.target) if isinstance(self.target, str) else self.target

    def takes(self, setting: str) -> bool:
        """Return whether the function has a parameter called `setting`."""
        return setting in inspect.signature(self.function).parameters

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution of a boundary by `function`; many functions ignore the initial grid `start`."""
        more = {"initial": start} if start is not None and self.takes("initial") else {}
        return self.function(boundary, **self.settings, **more)


@dataclass(frozen=True)
class Wrapper(OneByOne):
    """Base class of methods that call another `method` and have its name."""

    method: Method

    @property
    def name(self) -> str:
        """Name of the method that is called."""
        return self.method.name

    def inner(self, boundary: Boundary, initial: Grid | None = None) -> Solution:
        """Return the solution of one boundary by the method that this object calls, `self.method`."""
        return solved(self.method, boundary, initial)


class UnknownSettingError(InputError):
    """Error: a method does not have a setting."""

    def __init__(self, method: str, setting: str) -> None:
        super().__init__(f"method {method} has no {{{setting}}}", f"leave {{{setting}}} out")
        self.setting = setting


def _check_settings(name: str, function: Callable[..., Any], settings: Mapping[str, Any]) -> None:
    known = inspect.signature(function).parameters
    for setting in settings:
        if setting not in known:
            raise UnknownSettingError(name, setting)


def method_named(name: str, **settings: Any) -> Method:
    """Return the method with the given name and settings.

    Raises InputError if there is no such method, or if it does not have one of the `settings`.

    >>> method_named("winslow", tol=1e-8).settings
    {'tol': 1e-08}
    """
    base, _, model = name.partition(":")
    if base not in METHODS or (model and base != "operator"):
        known = "use one of " + ", ".join(METHODS)
        raise InputError(f"method {name!r} is not known", known, parameter="method")
    row = METHODS[base]
    if not row.is_class:
        return Each(base, row.target, settings)
    target = resolve_name(row.target)
    settings |= {"model": model} if model else {}
    _check_settings(base, target, settings)
    method: Method = target(**settings)
    return method
