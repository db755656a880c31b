"""The interface of a method, and the table of methods from which choices, help and tests are derived."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple, Protocol

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
        """Return a solution for each of the boundaries `problems`; `start` has an initial grid for each."""
        starts: Sequence[Grid | None] = start or [None] * len(problems)
        return list(map(self.solve_one, problems, starts))

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution of one boundary."""
        raise NotImplementedError


class MethodEntry(NamedTuple):
    """An entry of the table `METHODS`: a method whose module is imported when it is used."""

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
        """Whether the grids follow from the boundary by an explicit formula."""
        return self.kind == "algebraic"

    @property
    def is_class(self) -> bool:
        """Whether `target` is the name of a class, not of a function."""
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
            "Winslow's equations with control functions, which continue the node spacing of the sides into "
            "the interior",
            sweeps=False,
        ),
        "steger-sorenson": MethodEntry(
            "meshonet.solvers.elliptic.steger_sorenson:solve_steger_sorenson",
            "Winslow's equations with source terms; grid lines leave walls at the angle {wall_angle}",
            sweeps=False,
        ),
        "variational": MethodEntry(
            "meshonet.solvers.energy.variational:solve",
            "minimises a functional of angles and lengths; angles are closer to 90 degrees than winslow's",
        ),
        "hyperbolic": MethodEntry(
            "meshonet.solvers.hyperbolic.march:hyperbolic", "marches row by row from the wall"
        ),
        "conformal": MethodEntry(
            "meshonet.solvers.conformal.solve:conformal",
            "Winslow's equations around a body, on the rectangle to which a conformal map takes the region",
        ),
        "operator": MethodEntry(
            "meshonet.solvers.neural.inference:OperatorMethod", "a neural operator", kind="network"
        ),
    }
)
"""Methods by name, which are loaded when used; ``operator:NAME`` is the neural operator NAME."""
