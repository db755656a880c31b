"""The interface of all trained operators, from boundaries to solutions."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from meshonet.geometry.arrays import Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.conformal.solve import Polish
from meshonet.solvers.neural.confidence import Goal, expected_error
from meshonet.solvers.solution import Solution

BATCH = 64  # most boundaries that are solved together, for the memory that they take


@dataclass(frozen=True)
class Operator(ABC):
    """Base class of trained neural operators; `meshonet.solvers.neural.registry.load` returns one."""

    batched: ClassVar[bool] = True  # many boundaries take less time together than one by one

    name: str  # of a shipped model, or what its file says
    topology: Topology  # of the grids that it makes
    header: Mapping[str, Any]  # what its file says of itself: recipe and held-out figures

    @classmethod
    @abstractmethod
    def of_file(cls, name: str, header: Mapping[str, Any], arrays: dict[str, Floats]) -> Self:
        """Return the operator from the header and the arrays of a model file.

        Raises InputError, KeyError, IndexError, ValueError, TypeError, AttributeError or OverflowError if
        header or arrays do not belong to an operator of this class.
        """

    @abstractmethod
    def solve(
        self,
        boundaries: Sequence[Boundary],
        polish: Polish = "auto",
        *,
        paste: bool = True,
        dtype: str = "float64",
        threads: int = 1,
    ) -> list[Solution]:
        """Return a grid inside each boundary; it may have folded cells.

        `polish` is the number of improving steps after the network. With `paste`, given boundary nodes
        replace predicted ones. `dtype` is the arithmetic of U-Nets, ``float64`` or ``float32``; grids differ
        by about 1e-6. `threads` is the number of batches of U-Nets that run at the same time. Operators
        ignore parameters that do not apply to them. Raises InputError if the topology is not supported.
        """

    @property
    def goal(self) -> Goal:
        """Name of the method whose grids the operator imitates."""
        return "winslow"

    def expected_error(self, boundary: Boundary, solution: Solution) -> float:
        """Return the estimated relative L2 error of a result of `solve`; see `confidence.expected_error`."""
        return expected_error(solution.grid, boundary, self.goal)

    def check(self, boundaries: Sequence[Boundary]) -> None:
        """Raise InputError unless all boundaries have the operator's topology."""
        for boundary in boundaries:
            if boundary.topology != self.topology:
                problem = f"model {self.name} makes {self.topology} grids, and this boundary is"
                raise InputError(f"{problem} {boundary.topology}", "use another model", source=boundary.name)


def in_batches(boundaries: Sequence[Boundary], threads: int = 1) -> Iterator[list[int]]:
    """Yield lists of at most `BATCH` indices of boundaries with equal node counts; each index occurs once.

    Lists for the same node counts have about equal lengths, and are enough to occupy all `threads`.
    """
    groups: dict[tuple[int, int], list[int]] = {}
    for k, boundary in enumerate(boundaries):
        groups.setdefault((boundary.ni, boundary.nj), []).append(k)
    for group in groups.values():
        fewest = -(-len(group) // BATCH)
        count = min(-(-fewest // threads) * threads, len(group))
        for k in range(count):
            yield group[k * len(group) // count : (k + 1) * len(group) // count]
