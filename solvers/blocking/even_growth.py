"""Cells along grid lines whose neighbours differ by no more than a given ratio.

Logarithms of cells along a line that change by at most g from one to the next lie between two envelopes:

::

    lower_i = min_j (y_j + g |i - j|)  <=  y_i  <=  upper_i = max_j (y_j - g |i - j|)

Both change by at most g, and so does every mean of them. Where the cells do not differ by more, both are what
is there: nothing moves. In every stretch between such places that mean is taken which keeps its length, so
nodes move only near where cells differ by too much, and those of lines beside each other are moved alike.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats

_STEPS = 40
_TRIES = 6
_BEYOND = 8.0  # how far, in logarithms, cells may leave the envelopes where an end is held
_SAME = 1e-9

Bools = NDArray[np.bool_]


def evened(cells: Floats, limit: float, closed: bool = False, start: int = 0, stop: int = 0) -> Floats:
    """Return cells (k, n) of lines with the same sums, neighbours of which differ by at most a ratio.

    `limit` is the logarithm of the ratio. The first `start` and last `stop` cells are kept. Lines in which
    that cannot be differ by more, as little as may be.
    """
    new = cells.copy()
    left = np.arange(len(cells))
    for whole in (False, *(True,) * _TRIES):
        new[left], possible = _evened(cells[left], limit, closed, (start, stop), whole)
        left = left[~possible]
        if not len(left):
            break
        if whole:
            limit *= 1.25
    return new


def _evened(
    cells: Floats, limit: float, closed: bool, held: tuple[int, int], whole: bool
) -> tuple[Floats, Bools]:
    """Return cells (k, n), and which lines (k,) could be evened, in one stretch if `whole`."""
    y = np.log(cells)
    least, most = _kept(y, limit, held)
    low, high = (np.clip(each, least, most) for each in _envelopes(y, limit, closed))
    active = np.ones(y.shape, dtype=bool) if whole else np.maximum(np.abs(high - y), np.abs(y - low)) > _SAME
    begins = active & ~np.pad(active, ((0, 0), (1, 0)))[:, :-1]
    stretch = (np.cumsum(begins.ravel()) - 1)[active.ravel()]
    count = int(begins.sum())
    if not count:
        return cells.copy(), np.ones(len(cells), dtype=bool)
    total = np.bincount(stretch, cells[active], count)
    ends = low[active], high[active], least[active], most[active]
    reach = _BEYOND if whole else 0.0
    lower, upper = np.full(count, -reach), np.full(count, 1.0 + reach)
    for _ in range(_STEPS):
        part = 0.5 * (lower + upper)
        sums = np.bincount(stretch, _between(part[stretch], *ends), count)
        lower, upper = np.where(sums < total, part, lower), np.where(sums < total, upper, part)
    new = cells.copy()
    new[active] = _between((0.5 * (lower + upper))[stretch], *ends)
    off = np.abs(np.bincount(stretch, new[active], count) / total - 1.0) > 1e-6
    row = np.nonzero(begins)[0]
    possible = np.ones(len(cells), dtype=bool)
    possible[row[off]] = False
    new[~possible] = cells[~possible]
    return new, possible


def _between(part: Floats, low: Floats, high: Floats, least: Floats, most: Floats) -> Floats:
    """Return cells (n,) at means of envelopes (n,) that `part` (n,) stands for, beyond them too."""
    inside = np.clip(part, 0.0, 1.0)
    return np.exp(np.clip(low + inside * (high - low) + (part - inside), least, most))


def _kept(y: Floats, limit: float, held: tuple[int, int]) -> tuple[Floats, Floats]:
    """Return bounds (k, n) of logarithms (k, n) that leave the first and last `held` as they are."""
    least, most = np.full_like(y, -np.inf), np.full_like(y, np.inf)
    n = y.shape[1]
    for count, from_end in zip(held, (False, True), strict=True):
        if count:
            last = y[:, n - count if from_end else count - 1][:, None]
            away = np.maximum(np.arange(n) - (count - 1), 0)
            reach = limit * (away[::-1] if from_end else away)
            least, most = np.maximum(least, last - reach), np.minimum(most, last + reach)
            kept = slice(n - count, n) if from_end else slice(0, count)
            least[:, kept] = most[:, kept] = y[:, kept]
    return least, np.maximum(least, most)


def _envelopes(y: Floats, limit: float, closed: bool) -> tuple[Floats, Floats]:
    n = y.shape[1]
    if closed:
        y = np.tile(y, 3)
    slope = limit * np.arange(y.shape[1])

    def smallest(z: Floats) -> Floats:
        ahead = np.minimum.accumulate(z - slope, axis=1) + slope
        behind = np.minimum.accumulate((z + slope)[:, ::-1], axis=1)[:, ::-1] - slope
        return np.asarray(np.minimum(ahead, behind))

    low, high = smallest(y), -smallest(-y)
    return (low[:, n : 2 * n], high[:, n : 2 * n]) if closed else (low, high)
