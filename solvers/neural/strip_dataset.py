"""Training strips: boundaries lifted, their Winslow solutions by Picard's iteration to convergence."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Complexes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.conformal.strip import across, harmonic, modes, picard
from meshonet.solvers.neural.operator import walls

MOST_STEPS = 30
CONVERGED = 2e-6  # change of w in a step (radians)
ACCEPTED = 1e-4  # a slower one is still kept below this: the rest is in the highest modes


@dataclass(frozen=True)
class Strips:
    """n strips: `wall`, `far` (n, 2 MODES + 1), `residual` (n, 2 MODES + 1, LEVELS) = Winslow - harmonic."""

    wall: Complexes
    far: Complexes
    residual: Complexes

    def __len__(self) -> int:
        return len(self.wall)

    def __getitem__(self, rows: slice) -> Strips:
        return Strips(self.wall[rows], self.far[rows], self.residual[rows])

    def mirrored(self) -> Strips:
        """Return the strips seen in a mirror: F(theta) -> conj F(-theta) turns mode c_k into conj c_k."""
        return Strips(self.wall.conj(), self.far.conj(), self.residual.conj())


def solve_strips(
    boundaries: Iterable[Boundary], progress: Callable[[int, int], None] | None = None
) -> Strips:
    """Return the strips of O boundaries; those without a lift or a converged solution are left out.

    `progress` is called with how many are done and how many were left out.

    Raises
    ------
    InputError
        no boundary could be used, or one is not an O boundary.
    """
    rows: list[tuple[Complexes, Complexes, Complexes]] = []
    left_out = 0
    for boundary in boundaries:
        if not boundary.periodic:
            raise InputError(f"a {boundary.topology} boundary among the training shapes", "give O boundaries")
        row = _solved(boundary)
        if row is None:
            left_out += 1
        else:
            rows.append(row)
        if progress is not None:
            progress(len(rows), left_out)
    if not rows:
        raise InputError("no boundary could be lifted and solved", "give airfoil O boundaries")
    wall, far, residual = (np.array(column) for column in zip(*rows, strict=True))
    return Strips(wall, far, residual)


def _solved(boundary: Boundary) -> tuple[Complexes, Complexes, Complexes] | None:
    try:
        found = walls(boundary)
    except InputError:
        return None
    a, b = modes(found.wall), modes(found.far)
    base = harmonic(a, b, across().eta)
    c, last = base, np.inf
    for _ in range(MOST_STEPS):
        with np.errstate(all="ignore"):
            c, (change,) = picard(c, 1)
        if not change < 1.0:
            return None
        last = change
        if change < CONVERGED:
            break
    return (a, b, c - base) if last < ACCEPTED else None
