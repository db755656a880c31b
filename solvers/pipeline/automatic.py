"""Methods that call other methods: by topology, on fewer nodes, or by marching for C grids."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.pipeline.methods import OneByOne
from meshonet.solvers.pipeline.named import Wrapper, method_named, solved
from meshonet.solvers.solution import Solution

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.methods import Method

FEWER_NODES = {"winslow": (512, 257), "variational": (257, 129)}
"""Node counts above which a method by default solves on fewer nodes, and these smaller counts."""


@dataclass(frozen=True)
class Auto(OneByOne):
    """Solves by one of three methods, which depends on the topology of the boundary."""

    quad: Method
    o: Method
    c: Method
    name: str = "auto"

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution of a boundary by the method for its topology."""
        return solved(getattr(self, boundary.topology), boundary, start)


@dataclass(frozen=True)
class Fewer(Wrapper):
    """Solves large grids by `method` on fewer nodes. If cells are folded, it tries twice as many nodes."""

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution; large grids are solved on fewer nodes unless `start` is given."""
        above, n = FEWER_NODES.get(self.name, (0, 0))
        if not n or start is not None or max(boundary.ni, boundary.nj) <= above:
            return self.inner(boundary, start)
        from meshonet.solvers.pipeline.coarse import Coarse

        solution = Coarse(self.method, n).solve_one(boundary)
        if count_folded(solution.grid.nodes) == 0:
            return solution
        finer = Coarse(self.method, 2 * n - 1).solve_one(boundary)
        return min(finer, solution, key=lambda each: count_folded(each.grid.nodes))


@dataclass(frozen=True)
class Anew(Wrapper):
    """Solves by `method` without an initial grid, even if one is given."""

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:  # noqa: ARG002
        """Return the solution of a boundary."""
        return self.inner(boundary)


@dataclass(frozen=True)
class AroundWake(OneByOne):
    """Makes C grids by marching, or by the variational method if marching does not suit the boundary."""

    name: str = "auto"

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:  # noqa: ARG002
        """Return the solution of a boundary; an initial grid is not used."""
        from meshonet.solvers.hyperbolic.default_spacing import march_by_default

        return march_by_default(boundary) or Fewer(method_named("variational")).solve_one(boundary)


def elliptic() -> Auto:
    """Return the method ``auto``, which solves Winslow's equations, but marches C grids."""
    winslow = method_named("winslow")
    return Auto(Fewer(winslow), winslow, AroundWake())


def fewer_on_quads(method: Method) -> Auto:
    """Return `method`, except that large four-sided grids are solved on fewer nodes and then interpolated."""
    return Auto(Fewer(method), method, method, method.name)
