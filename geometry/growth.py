"""Cells that grow by a constant ratio from a wall outwards."""

from __future__ import annotations

import math

import numpy as np

from geometry.arrays import Floats
from geometry.errors import InputError

LARGEST = 10.0
"""A ratio beyond this between neighbouring cells is refused."""


def growth_ratio(first: float, length: float, cells: int) -> float:
    """Return the ratio g >= 1 of neighbouring cells with which `cells` of them fill `length`.

    first (gⁿ - 1)/(g - 1) = length

    Raises
    ------
    InputError
        equal cells of this size are too long already, or the ratio is above `LARGEST`.

    Examples
    --------
    >>> growth_ratio(1.0, 7.0, 3)
    2.0
    """
    if first * cells > length * (1 + 1e-12):
        raise InputError(
            f"{cells} cells, of which the first is {first:.3g} high, are longer than the far field is away "
            f"({length:.3g})",
            "use a smaller wall spacing or fewer rows",
        )
    low, high = 0.0, math.log(LARGEST)
    if _sum(high, cells) < length / first:
        raise InputError(
            f"{cells} cells from {first:.3g} to the far field at {length:.3g} would grow by more than "
            f"{LARGEST:g} each",
            "use more rows or a larger wall spacing",
        )
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (low, middle) if _sum(middle, cells) > length / first else (middle, high)
    return round(math.exp(0.5 * (low + high)), 15)


def cells_for_growth(first: float, length: float, ratio: float) -> int:
    """Return the fewest cells that, from `first` on, reach `length` without growing by more than `ratio`.

    Examples
    --------
    >>> cells_for_growth(1.0, 7.0, 2.0), cells_for_growth(1.0, 7.1, 2.0), cells_for_growth(1.0, 7.0, 1.0)
    (3, 4, 7)
    """
    if ratio == 1.0:
        return math.ceil(length / first - 1e-9)
    return math.ceil(math.log1p(length / first * (ratio - 1.0)) / math.log(ratio) - 1e-9)


def growing_steps(first: float, length: float, cells: int, constant: int = 1) -> Floats:
    """Return `cells` sizes (cells,) from `first` on that grow by `growth_ratio` and add up to `length`.

    The first `constant` ones are equal; the ratio is that of the others.

    Examples
    --------
    >>> growing_steps(1.0, 9.0, 5, 3).tolist()
    [1.0, 1.0, 1.0, 2.0, 4.0]
    """
    equal = min(constant, cells) - 1
    ratio = growth_ratio(first, length - equal * first, cells - equal)
    return np.asarray(first * ratio ** np.maximum(np.arange(cells) - equal, 0))


def _sum(log_ratio: float, cells: int) -> float:
    """Return (gⁿ - 1)/(g - 1) with g = exp(log_ratio)."""
    if log_ratio == 0.0:
        return float(cells)
    exponent = log_ratio * cells
    return math.expm1(exponent) / math.expm1(log_ratio) if exponent < 600.0 else math.inf
