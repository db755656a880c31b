"""Local relaxation at re-entrant corners, where the solution is singular and coarse levels help little."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.polygon.corners import find_corners, turning
from meshonet.kernels._native import MultigridLevel
from meshonet.solvers.algebraic.tfi import Four
from meshonet.solvers.elliptic.coarsening import Direction

REENTRANT = np.radians(30.0)
"""Smallest excess of a corner's interior angle over 180 degrees for local relaxation."""

REACH = 32  # cells to each side of the corner, and inwards

SWEEPS = 8  # local sweeps after each sweep of the level

LEAST = 120  # smallest number of cells per direction of a level with local relaxation

Window = tuple[slice, slice]

Corner = tuple[str, int]


class CornerPatch:
    """A `window` (two index ranges) of nodes at a corner of a multigrid `level`, for local relaxation.

    The solution is singular at re-entrant corners. Additional sweeps there restore most of the convergence
    rate: Bai, Brandt, SIAM J. Sci. Stat. Comput. 8 (1987) 109-134.
    """

    def __init__(
        self, level: MultigridLevel, xi: Direction, eta: Direction, window: Window, scratch: Floats
    ) -> None:
        self._level, self._window = level, window
        x, y = (np.array(plane[window], order="C") for plane in (level.x, level.y))
        of_xi, of_eta = _part(xi, window[0]), _part(eta, window[1])
        self._own = MultigridLevel(x, y, of_xi, of_eta, False, scratch, True)

    def smooth(self, forced: bool) -> None:
        """Relax the nodes near the corner in place; the right-hand side is 0 unless `forced`."""
        level, own, window = self._level, self._own, self._window
        own.x[...], own.y[...] = level.x[window], level.y[window]
        if forced:
            own.fx[...], own.fy[...] = level.fx[window], level.fy[window]
        own.smooth(forced, SWEEPS)
        level.x[window], level.y[window] = own.x, own.y


def _part(direction: Direction, nodes: slice) -> tuple[Floats, Floats, Floats]:
    """Return the weights of the differences at some `nodes` of `direction`."""
    forward, backward, centred = (weights[nodes].copy() for weights in direction.differences)
    return forward, backward, centred


def reentrant(edges: Four) -> list[Corner]:
    """Return side and node index of each re-entrant corner of the edges south, north, west and east."""
    sharp: list[Corner] = []
    for side, edge in zip(("south", "north", "west", "east"), edges, strict=True):
        outwards = -1.0 if side in {"south", "east"} else 1.0
        turns = outwards * turning(edge)
        sharp += [(side, int(k)) for k in find_corners(edge) if turns[k] > REENTRANT]
    return sharp


def patches(
    level: MultigridLevel, xi: Direction, eta: Direction, corners: list[Corner], scratch: Floats
) -> list[CornerPatch]:
    """Return a patch of nodes of a multigrid `level` around each of `corners`, which `reentrant` found."""
    if min(xi.cells, eta.cells) < LEAST:
        return []
    return [CornerPatch(level, xi, eta, _window(xi, eta, side, index), scratch) for side, index in corners]


def _window(xi: Direction, eta: Direction, side: str, index: int) -> Window:
    along, across = (xi, eta) if side in {"south", "north"} else (eta, xi)
    at = int(np.searchsorted(along.positions, index))
    beside = slice(max(at - REACH, 0), min(at + REACH, along.cells) + 1)
    inside = (
        slice(0, REACH + 1) if side in {"south", "west"} else slice(across.cells - REACH, across.cells + 1)
    )
    return (beside, inside) if side in {"south", "north"} else (inside, beside)
