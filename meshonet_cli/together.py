"""Members whose grids are made together: read ahead and solved in one go, then handed on one by one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice

from meshonet.geometry.arrays import Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.shapes.shape import Shape, edges_of
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.solution import Solution
from meshonet_cli.delivery import Todo
from meshonet_cli.member import Item

AHEAD = 64
"""Members that are read and solved together at the most."""

SHARED = 16
"""Members that one of several processes gets at a time at the most."""

NODES = 1 << 22
"""Nodes of grids from which no more members are taken together: some hundred MB."""


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
        while group := _group(todo, sampling):
            alike = [
                one for _, _, one in group if isinstance(one, Boundary) and one.topology == self.topology
            ]
            self._made = {}  # what was not asked for goes with its boundary, whose id another may get
            if len(alike) > 1:
                with suppress(
                    MeshonetError, MemoryError
                ):  # of one of them or of all at once: each is tried in its turn
                    solutions = self._many(alike)
                    self._made = {id(one): solution for one, solution in zip(alike, solutions, strict=True)}
            for item, path, one in group:
                yield replace(item, what=Sampled(item.what.name, one)), path


def shared(sampling: Sampling) -> int:
    """Return how many members go to another process together: fewer when grids are large."""
    nodes = (sampling.ni or 1) * (sampling.nj or 1)
    return max(1, min(SHARED, NODES // nodes))


def _group(todo: Todo[Shape], sampling: Sampling) -> list[tuple[Item[Shape], str, Boundary | Exception]]:
    """Return the next members with their boundaries, as many as are solved together."""
    group, nodes = [], 0
    for item, path in islice(todo, AHEAD):
        one = _sampled(item.what, sampling)
        group.append((item, path, one))
        nodes += one.ni * one.nj if isinstance(one, Boundary) else 0
        if nodes >= NODES:
            break
    return group


def _sampled(shape: Shape, sampling: Sampling) -> Boundary | Exception:
    try:
        return edges_of(shape, sampling)
    except (MeshonetError, MemoryError, ArithmeticError, ValueError, OSError) as error:
        return error
