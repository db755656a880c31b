"""What variational volumes minimise: open angles, even cells, lengths that change gradually.

With u, v, w the edges along xi, eta and zeta at a corner of a cell, each over the length that is wanted,
J = det(u, v, w) and l the lengths of the edges of one family::

    E = mean over the corners of cells of
            (1-q) (|u × v|² + |v × w|² + |w × u|²) / (3J) + q (|u|² |v|² |w|² / J²)^p
      + β mean of the squares of N^(1/3) Δ_e log l, all three families, along all three directions e

The first term is the discrete form of Winslow's functional: infinite at J = 0, so that a descent keeps a
valid grid valid. The second is 1/sin² of the corner's solid angle, to the power p; the third tells equal
cells from stripes of alternating ones. Folded grids are minimised with χ = (J + √(J² + ε²)) / 2 > 0 in place
of J.

Between six faces the mean length of a direction is wanted, in given blocks about what edges have.

The other functional wants cells like cubes. With T the Jacobian matrix of a cell's trilinear map, its columns
u, v, w over the same length::

    E = mean over cells of the integral of |T|² / (3 det(T)^⅔)

which is 1 for cubes of any size, the inverse of the mean ratio, and metric 303 of the target-matrix paradigm.

Ivanenko, Charakch'yan, USSR Comput. Maths. Math. Phys. 28 (1988) 126-133 (the barrier); Garanzha, Comput.
Maths. Math. Phys. 40 (2000) 1617-1637 (regularisation); Knupp, SIAM J. Sci. Comput. 23 (2001) 193-218 (cells
like cubes).
"""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class HexWeights:
    """Weights of the terms: `shape` q, `smoothness` β, `power` p (1 or 2).

    Power 0 stands for cells like cubes, with q = 1 and β = 0. A descent ends after two steps of which each
    lowers the value by less than `gain` of it.
    """

    shape: float = 0.9
    smoothness: float = 2e-3
    power: int = 2
    gain: float = 5e-4

    @property
    def of_cubes(self) -> bool:
        """Whether edges of all directions are measured by the same length."""
        return self.power == 0


OPTIMAL = HexWeights()
"""What grids are made with."""
CUBES = HexWeights(1.0, 0.0, power=0, gain=1e-6)
"""Cells like cubes."""
Energy = Literal["angles", "shape"]
ENERGIES: dict[Energy, HexWeights] = {"angles": OPTIMAL, "shape": CUBES}
"""What may be minimised, by name."""
UNFOLDING = HexWeights(0.02, power=1)
"""About Winslow's functional, which unfolds the most."""
OPENING = HexWeights(0.3, power=1), HexWeights(0.9, power=1)
"""The way from there to `OPTIMAL`: cells that are nearly flat get stuck otherwise."""
