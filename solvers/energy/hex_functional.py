"""The functionals of variational volumes.

Ivanenko, Charakch'yan, USSR Comput. Maths. Math. Phys. 28 (1988) 126-133; Garanzha, Comput. Maths. Math.
Phys. 40 (2000) 1617-1637; Knupp, SIAM J. Sci. Comput. 23 (2001) 193-218 (cubes).
"""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class HexWeights:
    """Weights of a functional of hexahedra that prefers right angles or, if `power` is 0, cells like cubes.

    u, v, w are the edges at a corner of a cell, each divided by its target length, and J = det(u, v, w). l is
    the length of an edge along one of the three index directions, divided by its target length. Δ_e log l is
    the difference of log l between two such edges that are neighbours in index direction e. N is the number
    of cells, q is `shape`, β `smoothness` and p `power`. If p is not 0, the functional is::

        E = mean over the corners of cells of
                (1-q) (|u × v|² + |v × w|² + |w × u|²) / (3J) + q (|u|² |v|² |w|² / J²)^p
          + β mean of the squares of N^(1/3) Δ_e log l, for all three l, along all three directions e

    For a new grid inside six faces, the target length in an index direction is the mean edge length along it.
    For a given grid, target lengths are its smoothed edge lengths. If p is 0, the functional is, with a
    cell's Jacobian matrix T (trilinear map)::

        E = mean over cells of the integral of |T|² / (3 det(T)^⅔)

    While cells are folded, J is replaced by χ = (J + √(J² + ε²)) / 2 > 0, with a number ε that is reduced as
    they unfold. A minimisation ends after two consecutive steps, each of which lowers the value by less than
    the fraction `gain`.
    """

    shape: float = 0.9
    smoothness: float = 2e-3
    power: int = 2
    gain: float = 5e-4

    @property
    def of_cubes(self) -> bool:
        """Whether the weights select the functional of cubes, which is least for cubic cells."""
        return self.power == 0


OPTIMAL = HexWeights()  # default weights of grids
CUBES = HexWeights(1.0, 0.0, power=0, gain=1e-6)  # functional for cells like cubes
Energy = Literal["angles", "shape"]
ENERGIES: dict[Energy, HexWeights] = {"angles": OPTIMAL, "shape": CUBES}
"""Weights by the name of the functional."""
UNFOLDING = HexWeights(0.02, power=1)  # weights close to Winslow's functional, which untangles the most cells
OPENING = HexWeights(0.3, power=1), HexWeights(0.9, power=1)
"""Intermediate weights from `UNFOLDING` to `OPTIMAL`, without which nearly flat cells stay flat."""
