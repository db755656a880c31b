"""The conformal solver as a method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.solvers.conformal.solve import Polish, solve
from meshonet.solvers.solution import Solution


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
        solutions = solve(problems, self.polish)
        return [replace(each, method=self.name, model=None) if each.model else each for each in solutions]
