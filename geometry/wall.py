"""Nodes along the wall of an airfoil: how many cells each stretch gets, and how large they are."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from geometry.arrays import Floats
from geometry.errors import InputError
from geometry.sampling import Sampling, TanhLaw

if TYPE_CHECKING:
    from geometry.airfoil import Airfoil


class Stations(NamedTuple):
    """Arc lengths on an airfoil's curve: lower end of the base, leading edge, upper end of the base."""

    lower: float
    nose: float
    upper: float


def wall_arcs(airfoil: Airfoil, ni: int, sampling: Sampling) -> Floats:
    """Return the arc lengths (ni,) of the wall nodes, from 0 to the length of the curve."""
    cells = ni - 1
    lower, nose, upper = airfoil.stations
    half_base = lower
    length = min(nose - lower, upper - nose)
    n = 0.5 * cells
    te, le = auto_steps(airfoil, n)
    half = 0
    if airfoil.blunt:
        if cells < 6:
            raise InputError(f"{ni} nodes around a blunt airfoil", "use at least 7")
        least = 2 if cells >= 24 else 1
        te = min(te, 1.15 * half_base / least)
        half, base_step = base_cells(half_base, te, least, int(0.175 * cells))
        n = 0.5 * cells - half
        te, le = auto_steps(airfoil, n)
        te = base_step
    elif cells < 4:
        raise InputError(f"{ni} nodes around an airfoil", "use at least 5")
    part = 1.0 if n == int(n) else 0.5
    q = np.arange(1, int(n) + 1) / n
    q = q[q < 1 - 1e-9]
    sides = []
    for side in (nose - lower, upper - nose):
        law = TanhLaw.fitted(n, te / side, le / side, part)
        sides.append(side * law(q))
    middle = [nose] if part == 1.0 else []
    s = np.concatenate([[lower], lower + sides[0], middle, (upper - sides[1])[::-1], [upper]])
    if half:
        law = TanhLaw.fitted(2 * half, base_step / (2 * half_base), base_step / (2 * half_base))
        b = 2 * half_base * law(np.arange(1, 2 * half) / (2 * half))
        b = 0.5 * (b + 2 * half_base - b[::-1]) - half_base
        s = np.concatenate([[0.0], b[half:], s, airfoil.curve.length + b[: half - 1], [airfoil.curve.length]])
    return s


def auto_steps(airfoil: Airfoil, n: float) -> tuple[float, float]:
    lower, nose, upper = airfoil.stations
    length = 0.5 * (upper - lower)
    mean = length / n
    te = mean * min(0.5, K_TE / n)
    le = min(np.pi / n * np.sqrt(0.5 * airfoil.nose_radius * airfoil.chord), 0.7 * mean)
    le = max(le, 0.05 * mean)
    return te, le


K_TE = 27.0


def base_cells(half_base: float, step: float, least: int, most: int) -> tuple[int, float]:
    """Return cells per half base and the size of the one at the corner."""
    if half_base / step <= 6:
        half = min(max(least, round(half_base / step)), max(most, 1))
        return half, half_base / half
    for half in range(4, max(most, 4) + 1):
        law = TanhLaw.fitted(2 * half, step / (2 * half_base), step / (2 * half_base))
        d = np.diff(law(np.arange(half + 1) / (2 * half)))
        if (d[1:] / d[:-1]).max() < 1.15:
            break
    return half, step
