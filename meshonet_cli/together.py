"""Members whose grids are made together: read ahead and solved in one go, then handed on one by one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice

from geometry.arrays import Topology
from geometry.boundary import Boundary
from geometry.errors import MeshonetError
from geometry.sampling import Sampling
from geometry.shape import Shape, edges_of
from meshonet_cli.delivery import Todo
from solvers.solution import Solution

AHEAD = 64
"""Members that are read and solved together."""


class Sampled:
    """A shape whose boundary is there already, or the reason why it has none."""

    def __init__(self, name: str, found: Boundary | Exception) -> None:
        self.name, self._found = name, found

    def boundary(self, sampling: Sampling) -> Boundary:  # noqa: ARG002 - sampled with the same before
        """Return the boundary, or raise what sampling it raised."""
        if isinstance(self._found, Exception):
            raise self._found
        return self._found


class Together:
    """A solver for one boundary that remembers what another one made of many.

    Parameters
    ----------
    alone : solves one boundary.
    many : solves several boundaries in one go.
    topology : of those that `many` solves; None if it solves none.
    """

    def __init__(
        self,
        alone: Callable[[Boundary], Solution],
        many: Callable[[Sequence[Boundary]], list[Solution]],
        topology: Topology | None,
    ) -> None:
        self._alone, self._many, self.topology = alone, many, topology
        self._made: dict[int, Solution] = {}

    def __call__(self, boundary: Boundary) -> Solution:
        """Return the solution of `boundary`."""
        return self._made.pop(id(boundary), None) or self._alone(boundary)

    def ahead(self, todo: Todo[Shape], sampling: Sampling) -> Todo[Shape]:
        """Yield what is to be made, solved `AHEAD` members at a time; one that fails does so in its turn."""
        while group := list(islice(todo, AHEAD)):
            sampled = [_sampled(item.what, sampling) for item, _ in group]
            alike = [one for one in sampled if isinstance(one, Boundary) and one.topology == self.topology]
            self._made = {}  # what was not asked for goes with its boundary, whose id another may get
            if len(alike) > 1:
                with suppress(MeshonetError):  # one of them fails: that is told in its turn
                    solutions = self._many(alike)
                    self._made = {id(one): solution for one, solution in zip(alike, solutions, strict=True)}
            for (item, path), one in zip(group, sampled, strict=True):
                yield replace(item, what=Sampled(item.what.name, one)), path


def _sampled(shape: Shape, sampling: Sampling) -> Boundary | Exception:
    try:
        return edges_of(shape, sampling)
    except (MeshonetError, ArithmeticError, ValueError, OSError) as error:
        return error
