"""Cells that grow by a constant ratio away from a wall."""

import math

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import exp, power, product
from meshonet.geometry.errors import InputError

LARGEST = 10.0  # largest growth ratio that is accepted


def check_growth(growth: float | None, most: float = LARGEST) -> None:
    """Raise InputError unless a growth ratio is greater than 1 and at most `most`."""
    if growth is not None and not 1.0 < growth <= most:
        remedy = f"give the ratio of neighbouring cells, such as 1.15, at most {most:g}"
        raise InputError(f"a growth of {growth:g}", remedy, parameter="growth")


def growth_ratio(first: float, length: float, cells: int) -> float:
    """Return the growth ratio g >= 1 with which `cells` cells, the first of size `first`, fill `length`.

    With n = `cells`, first (gⁿ - 1)/(g - 1) = length. Raises InputError: `cells` cells of size `first` exceed
    `length`; g is above `LARGEST`.

    >>> growth_ratio(1.0, 7.0, 3)
    2.0
    """
    if first * cells > length * (1 + 1e-12):
        problem = (
            f"{cells} cells, of which the first is {first:.3g} high, are longer than the far field is away"
        )
        raise InputError(f"{problem} ({length:.3g})", "use a smaller wall spacing or fewer rows")
    wanted, most = length / first, math.log(LARGEST)
    if _sum(most, cells) < wanted:
        problem = f"{cells} cells from {first:.3g} to the far field at {length:.3g} would grow by more than"
        raise InputError(f"{problem} {LARGEST:g} each", "use more rows or a larger wall spacing")
    if cells == 1 or wanted <= cells:
        return 1.0
    rate = min(math.log(wanted) / (cells - 1), most)  # the last cell alone is as long: above the root
    for _ in range(100):  # Newton's method on the logarithm of the sum, which is convex
        total = _sum(rate, cells)
        slope = cells / -math.expm1(-rate * cells) + 1.0 / math.expm1(-rate)
        change = math.log(total / wanted) / slope
        rate -= change
        if abs(change) < 1e-15 or rate <= 0.0:
            break
    return round(math.exp(max(rate, 0.0)), 15)


def cells_for_growth(first: float, length: float, ratio: float) -> int:
    """Return the least number of cells, the first of size `first`, that fill `length` with growth <= `ratio`.

    >>> cells_for_growth(1.0, 7.0, 2.0), cells_for_growth(1.0, 7.1, 2.0), cells_for_growth(1.0, 7.0, 1.0)
    (3, 4, 7)
    """
    if ratio == 1.0:
        return math.ceil(length / first - 1e-9)
    return math.ceil(math.log1p(length / first * (ratio - 1.0)) / math.log(ratio) - 1e-9)


def growing_steps(first: float, length: float, cells: int, constant: int = 1) -> Floats:
    """Return cell sizes (cells,) whose sum is `length`: first `constant` cells of size `first`, then growing.

    >>> growing_steps(1.0, 9.0, 5, 3).tolist()
    [1.0, 1.0, 1.0, 2.0, 4.0]
    """
    equal = min(constant, cells) - 1
    ratio = growth_ratio(first, length - equal * first, cells - equal)
    return np.asarray(first * power(ratio, np.maximum(np.arange(cells) - equal, 0)))


def growth_rate(place: Floats, first: float, length: float, rate: float) -> float:
    """Return the rate g for which cells of sizes first · exp(g · place) fill `length`.

    `place` (n,) rises from 0. Newton's method starts at `rate`, which must be at least g, as the sum of
    the sizes is convex in g.
    """
    for _ in range(100):
        sizes = first * exp(rate * place)
        change = (float(sizes.sum()) - length) / float(product(place, sizes))
        rate -= change
        if abs(change) < 1e-14:
            break
    return rate


def _sum(log_ratio: float, cells: int) -> float:
    """Return (gⁿ - 1)/(g - 1) with g = exp(log_ratio)."""
    if log_ratio == 0.0:
        return float(cells)
    exponent = log_ratio * cells
    return math.expm1(exponent) / math.expm1(log_ratio) if exponent < 600.0 else math.inf
