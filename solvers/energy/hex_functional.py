"""The functionals of variational volumes.

Let u, v, w be the edges along xi, eta and zeta at a corner of a cell, each divided by its target length, J =
det(u, v, w), and l the lengths of the edges of one family. The functional for angles is::

    E = mean over the corners of cells of
            (1-q) (|u × v|² + |v × w|² + |w × u|²) / (3J) + q (|u|² |v|² |w|² / J²)^p
      + β mean of the squares of N^(1/3) Δ_e log l, all three families, along all three directions e

The first term is a discrete form of Winslow's functional. It is infinite at J = 0, so that a minimisation
keeps a valid grid valid. The second term is 1/sin² of the corner's solid angle, to the power p. The third
distinguishes equal cells from alternating thin and thick ones. For folded grids, J is replaced by χ = (J +
√(J² + ε²)) / 2 > 0.

Target lengths are the mean length of each direction inside six faces, and close to the given lengths for
given blocks.

The other functional favours cells like cubes. With T the Jacobian matrix of a cell's trilinear map, whose
columns are u, v, w divided by one common length::

    E = mean over cells of the integral of |T|² / (3 det(T)^⅔)

The integrand is 1 for cubes of any size. It is the inverse of the mean ratio, and metric 303 of the
target-matrix optimisation paradigm.

Ivanenko, Charakch'yan, USSR Comput. Maths. Math. Phys. 28 (1988) 126-133 (the barrier); Garanzha, Comput.
Maths. Math. Phys. 40 (2000) 1617-1637 (regularisation); Knupp, SIAM J. Sci. Comput. 23 (2001) 193-218 (cells
like cubes).
"""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class HexWeights:
    """Weights of the terms: `shape` q, `smoothness` β, `power` p (1 or 2).

    Power 0 selects the functional for cubes, with q = 1 and β = 0. A minimisation ends after two consecutive
    steps, each of which lowers the value by less than the fraction `gain` of it.
    """

    shape: float = 0.9
    smoothness: float = 2e-3
    power: int = 2
    gain: float = 5e-4

    @property
    def of_cubes(self) -> bool:
        """Whether edges of all directions are divided by the same length."""
        return self.power == 0


OPTIMAL = HexWeights()
"""Default weights of grids."""
CUBES = HexWeights(1.0, 0.0, power=0, gain=1e-6)
"""Functional for cells like cubes."""
Energy = Literal["angles", "shape"]
ENERGIES: dict[Energy, HexWeights] = {"angles": OPTIMAL, "shape": CUBES}
"""Weights by the name of the functional."""
UNFOLDING = HexWeights(0.02, power=1)
"""Weights close to Winslow's functional, which untangles the most cells."""
OPENING = HexWeights(0.3, power=1), HexWeights(0.9, power=1)
"""Intermediate weights from `UNFOLDING` to `OPTIMAL`, without which nearly flat cells stay flat."""
