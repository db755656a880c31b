"""Choices that do not depend on rounding: the first of the candidates that are equal within `EQUAL`.

Which of two candidates that differ by rounding is better depends on how a symmetric shape is turned.
"""

from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np

from meshonet.geometry.arrays import Floats, Indices

EQUAL = 1e-9  # largest difference of two equal values, divided by the larger one
_NOISE = 1e-7  # relative perturbation of costs: larger than rounding, far smaller than real differences

Item = TypeVar("Item")


def less(a: float, b: float) -> bool:
    """Return whether `a` is less than `b` by more than rounding."""
    return bool(a < b) if np.isinf(a) or np.isinf(b) else bool(a < b - EQUAL * max(abs(a), abs(b)))


def first_least(items: Iterable[Item], key: Callable[[Item], float]) -> Item:
    """Return the first item with the smallest `key`; keys that differ only by rounding count as equal.

    Raises ValueError: there are no items.

    Examples
    --------
    >>> first_least([2.0, 1.0 + 1e-12, 1.0], key=lambda value: value)
    1.000000000001
    """
    left = iter(items)
    try:
        best = next(left)
    except StopIteration:
        raise ValueError("no items") from None
    value = key(best)
    for item in left:
        other = key(item)
        if less(other, value):
            best, value = item, other
    return best


def ascending(values: Floats) -> Indices:
    """Return the indices (n,) that sort `values` (n,); values that are equal up to rounding keep their order.

    Examples
    --------
    >>> ascending(np.array([3.0, 1.0 + 1e-12, 1.0])).tolist()
    [1, 2, 0]
    """
    order = np.argsort(values, kind="stable")
    ordered = values[order]
    apart = np.diff(ordered) > EQUAL * np.abs(ordered[1:])
    rank = np.empty(len(values), dtype=np.intp)
    rank[order] = np.append(0, np.cumsum(apart))[: len(values)]
    return np.argsort(rank, kind="stable")


def nearest_whole(values: Floats) -> Floats:
    """Return the integers nearest to positive `values`; of two that are equally near, the smaller.

    Distances that differ only by rounding count as equal.

    Examples
    --------
    >>> nearest_whole(np.array([2.5 - 1e-13, 2.5 + 1e-13, 2.6])).tolist()
    [2.0, 2.0, 3.0]
    """
    return np.ceil(values - 0.5 - EQUAL * np.maximum(values, 1.0))


def made_unlike(costs: Floats) -> Floats:
    """Return `costs` (..., n), slightly changed so that sums of different costs are hardly ever equal.

    A linear programme then has a single solution. Changes differ by index, and are far smaller than
    real differences of costs.
    """
    digits = np.mod(1e3 * np.sqrt(np.arange(costs.size) + 0.618), 1.0)
    return costs + _NOISE * np.abs(costs) * digits.reshape(costs.shape)
