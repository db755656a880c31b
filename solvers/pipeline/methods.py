"""The interface of a method, and the table of methods from which choices, help and tests are derived.

A method has a name, immutable settings and a function from boundaries to solutions. A new method is a
function ``solve(boundary, *, settings...) -> Solution`` in a file of its own and a row of `METHODS`. Rows
contain the names of functions as text, so that reading the table loads no solver.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pkgutil import resolve_name
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, Protocol

from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from meshonet.geometry.arrays import Topology
    from meshonet.geometry.blocks.boundary import Boundary
    from meshonet.geometry.blocks.grid import Grid
    from meshonet.solvers.solution import Solution

    class Method(Protocol):
        """A way from boundaries to grids: frozen settings and one function."""

        @property
        def name(self) -> str:
            """What it is called, as in `METHODS`."""
            ...

        @property
        def together(self) -> Topology | None:
            """The topology of boundaries that are solved faster in one call; None: all are solved singly."""
            ...

        def solve(self, problems: Sequence[Boundary], start: Sequence[Grid] | None = None) -> list[Solution]:
            """Return a solution for each of the boundaries; `start` may have an initial grid for each.

            Raises MeshonetError: one of the boundaries cannot be solved; callers then solve them one by one.
            """
            ...


class OneByOne:
    """Base class of methods that solve one boundary after the other."""

    together: ClassVar[Topology | None] = None

    def solve(self, problems: Sequence[Boundary], start: Sequence[Grid] | None = None) -> list[Solution]:
        """Return a solution for each of the boundaries; `start` has an optional initial grid for each."""
        starts: Sequence[Grid | None] = start or [None] * len(problems)
        return list(map(self.solve_one, problems, starts))

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution of one boundary."""
        raise NotImplementedError


def solved(method: Method, boundary: Boundary, start: Grid | None) -> Solution:
    """Return the solution of one boundary by `method`."""
    return method.solve([boundary], None if start is None else [start])[0]


@dataclass(frozen=True)
class Each(OneByOne):
    """A method that is a function of one boundary.

    Raises InputError: a setting that the function does not have.
    """

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
        """The function."""
        return resolve_name(self.target) if isinstance(self.target, str) else self.target

    def takes(self, setting: str) -> bool:
        """Return whether the function has this keyword."""
        return setting in inspect.signature(self.function).parameters

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the function's solution of a boundary.

        `start` is used if the function accepts an initial grid.
        """
        more = {"initial": start} if start is not None and self.takes("initial") else {}
        return self.function(boundary, **self.settings, **more)

    def having(self, **settings: Any) -> Each:
        """Return the method with additional settings."""
        return replace(self, settings={**self.settings, **settings})


class UnknownSettingError(InputError):
    """A setting that a method does not have."""

    def __init__(self, method: str, setting: str) -> None:
        super().__init__(f"method {method} has no {{{setting}}}", f"leave {{{setting}}} out")
        self.setting = setting


def _check_settings(name: str, function: Callable[..., Any], settings: Mapping[str, Any]) -> None:
    """Raise InputError for a setting that is not a parameter of `function`, the method `name`."""
    known = inspect.signature(function).parameters
    for setting in settings:
        if setting not in known:
            raise UnknownSettingError(name, setting)


class MethodEntry(NamedTuple):
    """A row of the table: a method that is not loaded yet."""

    target: str  # ``module:name`` of the function of a boundary, or of the class of the method
    summary: str  # for help and documentation, behind the name
    # ``solve-pde`` offers what is solved, ``tfi`` what is algebraic: grids that are formulas of the boundary,
    # not repaired unless that is asked for, and inside boundaries that are sampled in the same way with first
    # cells and without
    kind: Literal["solved", "algebraic", "network"] = "solved"
    # whether relaxing Winslow's equations around kinks suits its grids: not where they have sources
    sweeps: bool = True

    @property
    def solves(self) -> bool:
        """Whether the method solves equations, minimises a functional or marches."""
        return self.kind == "solved"

    @property
    def algebraic(self) -> bool:
        """Whether the grids of the method are explicit formulas of the boundary."""
        return self.kind == "algebraic"

    @property
    def is_class(self) -> bool:
        """Whether the target is a class; its name then starts with a capital letter."""
        return self.target.partition(":")[2][0].isupper()


METHODS: Mapping[str, MethodEntry] = MappingProxyType(
    {
        "tfi": MethodEntry(
            "meshonet.solvers.algebraic.tfi:solve",
            "transfinite interpolation between the four edges",
            kind="algebraic",
        ),
        "winslow": MethodEntry(
            "meshonet.solvers.elliptic.solve:solve", "Winslow's elliptic equations without control functions"
        ),
        "thomas-middlecoff": MethodEntry(
            "meshonet.solvers.elliptic.solve:solve_thomas_middlecoff",
            "Winslow's equations with control functions; the node spacing of the sides continues inside",
            sweeps=False,
        ),
        "steger-sorenson": MethodEntry(
            "meshonet.solvers.elliptic.steger_sorenson:solve_steger_sorenson",
            "Winslow's equations with source terms; grid lines leave walls at the angle {wall_angle}",
            sweeps=False,
        ),
        "variational": MethodEntry(
            "meshonet.solvers.energy.variational:solve",
            "minimises a functional of angles and edge lengths; angles are closer to 90 degrees",
        ),
        "hyperbolic": MethodEntry(
            "meshonet.solvers.hyperbolic.march:hyperbolic", "marches row by row from the wall"
        ),
        "conformal": MethodEntry(
            "meshonet.solvers.conformal.solve:conformal",
            "Winslow's equations around a body, solved in a strip after a conformal map",
        ),
        "operator": MethodEntry(
            "meshonet.solvers.neural.inference:OperatorMethod", "a neural operator", kind="network"
        ),
    }
)
"""Methods by name; ``operator:NAME`` is the neural operator with that name."""


def method_named(name: str, **settings: Any) -> Method:
    """Return the method with the given name and settings.

    Raises InputError: an unknown method; a setting that the method does not have.

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
