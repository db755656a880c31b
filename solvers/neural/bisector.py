"""Lines that leave a corner of the wall halve its angle.

The two cells at a corner of exterior angle A have angles there that add up to A: the larger is smallest when
both are A/2. Winslow's equations get there only as the cells shrink; a nudge of phi around the corner's first
node gets there at once, and dies out within a few cells.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geometry.arrays import Complexes
from geometry.lift import Lift
from solvers.neural.evaluate import StripGrid

CELLS = 5.0  # reach of a nudge, in cells either way
LARGEST = 0.4  # of a cell's width in theta: beyond it the neighbours would suffer
SWEEPS = 2  # over the corners, which feel each other a little
STEPS = 3  # of the secant method


def halve_corners(grid: StripGrid, lift: Lift, wall: Complexes, corners: tuple[int, ...]) -> None:
    """Add to `grid` the nudges that make the first lines off `corners` bisectors in the plane.

    `wall` is (n,) nodes counter-clockwise in the plane, `corners` indices into it.
    """
    n, step = len(wall), 2.0 * np.pi / len(wall)
    if not corners or len(grid.eta) < 4:
        return
    width = CELLS
    if len(corners) == 2:
        between = (corners[0] - corners[1]) % n
        width = min(CELLS, 0.5 * min(between, n - between))
    first = np.array([grid.at(c, 1) for c in corners])
    pull = np.array([[_along(a - b, n, width) for b in corners] for a in corners])
    shift = np.zeros(len(corners))
    for _ in range(SWEEPS):
        for k, c in enumerate(corners):
            rest = float(pull[k] @ shift - shift[k])
            shift[k] = _secant(lift, wall, c, complex(first[k]) + 1j * rest, float(shift[k]), LARGEST * step)
    across = grid.eta / grid.eta[1] * np.exp(-(grid.eta / grid.eta[1] - 1.0) / CELLS) * (1.0 - grid.eta)
    across /= across[1]
    reach = int(np.ceil(6.0 * width))
    for c, s in zip(corners, shift, strict=True):
        if s == 0.0:
            continue
        rows = np.arange(c - reach, c + reach + 1)
        along = s * np.array([_along(int(r) - c, n, width) for r in rows])
        for part in _pieces(rows, n):
            where = rows[part] % n
            grid.nudge(slice(int(where[0]), int(where[-1]) + 1), along[part], across)


def _along(offset: int, n: int, width: float) -> float:
    return float(np.exp(-((np.sin(np.pi * offset / n) / (np.pi * width / n)) ** 2)))


def _pieces(rows: NDArray[np.intp], n: int) -> list[slice]:
    """Return slices of `rows` that do not cross the seam, at most n rows in all."""
    if len(rows) > n:
        rows = rows[:n]
    cuts = [0, *(int(k) + 1 for k in np.flatnonzero(np.diff(rows % n) < 0)), len(rows)]
    return [slice(a, b) for a, b in pairwise(cuts)]


def _secant(lift: Lift, wall: Complexes, c: int, w: complex, start: float, limit: float) -> float:
    """Return the shift of phi that makes the angles at corner c equal; `start` when none is found."""
    corner, ahead, behind = wall[c], wall[(c + 1) % len(wall)], wall[c - 1]

    def unequal(s: float) -> float:
        line = lift.to_plane(np.array([w + 1j * s]))[0] - corner
        return float(_turn(behind - corner, line) - _turn(line, ahead - corner))

    a, b = start, start + 0.05 * limit
    fa, fb = unequal(a), unequal(b)
    for _ in range(STEPS):
        if fa == fb:
            break
        a, b, fa = b, float(np.clip(b - fb * (b - a) / (fb - fa), -limit, limit)), fb
        fb = unequal(b)
    return b if np.isfinite(fb) and abs(fb) <= abs(unequal(start)) else start


def _turn(a: complex, b: complex) -> float:
    """Return the angle from b counter-clockwise to a, in [0, 2 pi)."""
    return float(np.mod(np.angle(a / b), 2.0 * np.pi))
