"""Base of methods that call another method: on fewer nodes, in several steps, or with layers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.solvers.pipeline.methods import OneByOne
from meshonet.solvers.pipeline.named import solved
from meshonet.solvers.solution import Solution

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.methods import Method


@dataclass(frozen=True)
class Wrapper(OneByOne):
    """Base class of methods that solve by another method and have the name of this method."""

    method: Method

    @property
    def name(self) -> str:
        """Name of the other method."""
        return self.method.name

    def inner(self, boundary: Boundary, initial: Grid | None = None) -> Solution:
        """Return the other method's solution of one boundary."""
        return solved(self.method, boundary, initial)
