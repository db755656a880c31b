"""Neural operators as a method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from meshonet.geometry.arrays import Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.solvers.conformal.solve import Polish
from meshonet.solvers.neural.devices import Device
from meshonet.solvers.neural.inference import Answer, infer_many, many_of
from meshonet.solvers.solution import Solution


@dataclass(frozen=True)
class Operator:
    """A neural operator; its settings are those of `meshonet.solvers.neural.inference.infer_many`."""

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
        return infer_many(problems, self.model, self.polish, self.answer, self.device)
