"""Neural operators, and the conformal solver they build on, as methods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal, TypeAlias

from meshonet.geometry.arrays import Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.inference import Answer, infer, infer_many, many_of
from meshonet.solvers.solution import Solution

if TYPE_CHECKING:
    from meshonet.solvers.neural.devices import Device

Polish: TypeAlias = Literal["auto", "off"] | int


@dataclass(frozen=True)
class Operator:
    """A neural operator; its settings are those of `meshonet.solvers.neural.inference.infer`."""

    model: str | None = None
    polish: Polish = "auto"
    answer: Answer = "valid"
    device: Device | None = None
    name = "operator"

    @cached_property
    def together(self) -> Topology | None:
        """The topology of boundaries that go through the network in one pass; None if none do."""
        return many_of(self.model, self.device, self.polish)

    def solve(
        self,
        problems: Sequence[Boundary],
        start: Sequence[Grid] | None = None,  # noqa: ARG002 - networks start from nothing
    ) -> list[Solution]:
        """Return a solution for each of the boundaries, by one pass of the network where it can."""
        if len(problems) > 1 and all(problem.topology == self.together for problem in problems):
            return infer_many(problems, self.model, self.polish, device=self.device)
        return [infer(problem, self.model, self.polish, self.answer, self.device) for problem in problems]


@dataclass(frozen=True)
class Conformal:
    """O grids by Picard's iteration in the strip that a conformal map makes of the domain."""

    polish: Polish = "auto"
    name = "conformal"
    together = None

    def solve(
        self,
        problems: Sequence[Boundary],
        start: Sequence[Grid] | None = None,  # noqa: ARG002 - the iteration starts from the harmonic extension
    ) -> list[Solution]:
        """Return a solution for each of the boundaries.

        Raises
        ------
        InputError
            a boundary that is not around a body.
        """
        for problem in problems:
            if problem.topology != "o":
                what = f"method conformal makes o grids, and this boundary is {problem.topology}"
                raise InputError(what, "use another {method}")
        solutions = Operator("base", self.polish).solve(problems)
        return [replace(each, method=self.name, model=None) if each.model else each for each in solutions]
