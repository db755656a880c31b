"""The airfoil operator: the conformal solver, started from a network's correction of the harmonic base."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.compare import compare
from meshonet.solvers.conformal import solve as conformal
from meshonet.solvers.conformal.solve import Polish
from meshonet.solvers.conformal.strip import LEVELS, across
from meshonet.solvers.neural.confidence import Goal
from meshonet.solvers.neural.operator import Operator
from meshonet.solvers.neural.strip.encoding import CHANNELS, SCALARS, decode, encode
from meshonet.solvers.neural.strip.network import StripNetwork, check_shapes
from meshonet.solvers.solution import Solution


@dataclass(frozen=True)
class StripOperator(Operator):
    """Winslow's solver for airfoils, started from the harmonic grid, with a network's corrections if any.

    `basis` and `scale` convert the network's outputs to these corrections (see `StripTargets`).
    """

    weights: Mapping[str, Floats] = field(default_factory=dict)  # of the network, float64
    basis: Floats = field(default_factory=lambda: np.zeros((0, LEVELS - 2)))
    scale: float = 1.0
    network: StripNetwork | None = None

    @classmethod
    def of_file(cls, name: str, header: Mapping[str, Any], arrays: dict[str, Floats]) -> Self:
        """Return the operator from the header and the arrays of a model file."""
        weights = {key: array.astype(np.float64) for key, array in arrays.items()}
        basis, scale = weights.pop("basis"), float(header["scale"])
        check_shapes(weights)
        outputs, inputs = weights["project.weight"].shape[0], weights["lift.weight"].shape[1]
        fits = basis.shape == (outputs // 2, LEVELS - 2) and inputs == CHANNELS + SCALARS
        if not fits or not np.isfinite(scale):
            raise ValueError("basis, scale or inputs")
        return cls(name, "o", header, weights, basis, scale, StripNetwork(weights))

    def residual(self, wall: Complexes, far: Complexes, hand: NDArray[np.intp] | None = None) -> Complexes:
        """Return corrections of the harmonic extension, as Fourier modes (batch, 2 MODES + 1, LEVELS).

        `wall` and `far` (batch, 2 MODES + 1) are Fourier modes of the strip's two sides. `hand` (batch,) has
        signs from `meshonet.geometry.polygon.mirror.handedness`: with them, mirrored bodies get mirrored
        grids, and symmetric bodies symmetric grids.
        """
        if self.network is None:
            return np.zeros((*wall.shape, LEVELS), complex)
        flip = np.zeros((len(wall), 1), bool) if hand is None else hand[:, None] < 0
        channels, scalars, size = encode(np.where(flip, wall.conj(), wall), np.where(flip, far.conj(), far))
        coefficients = self.network(channels, scalars)
        answer: Complexes = decode(coefficients, self.basis, self.scale, size)
        answer.imag[flip[:, 0]] *= -1.0
        if hand is not None:
            answer.imag[hand == 0] = 0.0
        return answer * across().smooth[:, None]

    def solve(self, boundaries: Sequence[Boundary], polish: Polish = "auto", **_: Any) -> list[Solution]:
        """Return a grid for each O boundary, with exactly the given boundary nodes."""
        self.check(boundaries)
        if not self.network:
            return conformal.solve(boundaries, polish)
        return conformal.solve(boundaries, polish, self.residual, self.name)

    @property
    def goal(self) -> Goal:
        """Name of the method whose grids the operator imitates."""
        return "conformal"

    def expected_error(self, boundary: Boundary, solution: Solution) -> float:
        """Return the relative L2 distance by which a further Picard step moves the nodes of a solution."""
        better = self.solve([boundary], (solution.cycles or 0) + 1)[0]
        if better.model is None:  # the step diverges
            return math.inf
        return compare(solution.grid, better.grid).relative_l2
