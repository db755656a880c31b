"""Steps along the lines of a ring: they grow from the first one by one ratio up to the cells of the core."""

import math

import numpy as np

from meshonet.geometry.arrays import Floats, growth_ratios
from meshonet.geometry.elementary import exp
from meshonet.geometry.spacing.growth import LARGEST

TRIED = 8  # number of row counts that are tried, from the smallest on
_HALVINGS = 60  # of the range that the ratio lies in: to the last digit
_CLOSE = 1e-9  # of the length, to which steps fill it


def ring_steps(lengths: Floats, sizes: Floats, rows: int, first: float | None) -> Floats:
    """Return the steps (k, rows) between nodes on k lines with `lengths` (k,).

    `sizes` (k,) are the lengths of the cells beyond the ends of the lines. Along a line, steps change by one
    ratio from `first` to the size of the cell beyond, then stay equal. If `first` is None, they change by one
    ratio along the whole line, up to this size. With a ratio of at most `LARGEST`, they may not fill it.
    """
    most = math.log(LARGEST)
    low, high = np.full(len(lengths), 0.0 if first else -most), np.full(len(lengths), most)
    shrink = np.full(len(lengths), False) if first is None else sizes < first
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        longer = (_steps(sizes, rows, first, middle).sum(axis=1) < lengths) != shrink
        low, high = np.where(longer, middle, low), np.where(longer, high, middle)
    return _steps(sizes, rows, first, 0.5 * (low + high))


def _steps(sizes: Floats, rows: int, first: float | None, rate: Floats) -> Floats:
    """Return steps (k, rows) with the log ratio `rate` (k,), up to the sizes."""
    grown = exp(rate[:, None] * np.arange(rows))
    if first is None:
        return np.asarray(sizes[:, None] * grown[:, ::-1])
    size, shrink = sizes[:, None], sizes[:, None] < first
    return np.where(shrink, np.maximum(first / grown, size), np.minimum(first * grown, size))


def fewest_rows(lengths: Floats, sizes: Floats, first: float | None, growth: float) -> int:
    """Return a low estimate of the parameter `rows` of `ring_steps` for ratios of steps up to `growth`."""
    if first is None:
        return max(1, round(float((lengths / sizes).mean())) - TRIED // 2)
    even = math.ceil(float((lengths / np.maximum(sizes, first)).max()) - _CLOSE)
    growing = math.ceil(math.log(max(float(sizes.max()) / first, 1.0)) / math.log(growth))
    steps = _steps(sizes, even + growing, first, np.full(len(sizes), math.log(growth)))
    fitting = np.where(sizes < first, even, (np.cumsum(steps, axis=1) < lengths[:, None]).sum(axis=1) + 1)
    return max(2, int(fitting.max()))


def largest_ratio(lengths: Floats, sizes: Floats, steps: Floats) -> float:
    """Return the largest ratio of neighbouring cell lengths on k lines; infinite if cells do not fill a line.

    `lengths` (k,) are the lengths of the lines, `steps` (k, rows) the lengths of the cells along them, and
    `sizes` (k,) the length of the next cell beyond the end of each line.
    """
    if np.abs(steps.sum(axis=1) - lengths).max() > _CLOSE * lengths.max():
        return math.inf
    return float(growth_ratios(np.concatenate([steps, sizes[:, None]], axis=1)).max())
