"""Cells along grid lines whose neighbours differ by no more than a given ratio.

Logarithms of cells along a line that change by at most g from one to the next lie between two envelopes:

::

    lower_i = min_j (y_j + g |i - j|)  <=  y_i  <=  upper_i = max_j (y_j - g |i - j|)

Both change by at most g, and so does every mean of them; that which keeps the length of the line is taken.
Where the cells do not differ by more, both envelopes are what is there, and nothing moves; lines beside each
other are moved alike.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats

_STEPS = 40
_TRIES = 6
_BEYOND = 8.0  # how far, in logarithms, cells may leave the envelopes where an end is held


def evened(cells: Floats, limit: float, closed: bool = False, start: int = 0, stop: int = 0) -> Floats:
    """Return cells (k, n) of lines with the same sums, neighbours of which differ by at most a ratio.

    `limit` is the logarithm of the ratio. The first `start` and last `stop` cells are kept. Lines in which
    that cannot be differ by more, as little as may be.
    """
    new, possible = _evened(cells, limit, closed, start, stop)
    for _ in range(_TRIES):
        if possible.all():
            break
        limit *= 1.25
        again = np.flatnonzero(~possible)
        new[again], possible[again] = _evened(cells[again], limit, closed, start, stop)
    return new


def _evened(
    cells: Floats, limit: float, closed: bool, start: int, stop: int
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return cells (k, n) of lines, and which lines (k,) could be evened."""
    y = np.log(cells)
    low, high = _envelopes(y, limit, closed)
    least, most = np.full_like(y, -np.inf), np.full_like(y, np.inf)
    n = y.shape[1]
    away = limit * np.arange(n)
    for held, from_end in ((start, False), (stop, True)):
        if held:
            last = y[:, -held if from_end else held - 1][:, None]
            reach = np.maximum(away[::-1] - away[held - 1] if from_end else away - away[held - 1], 0.0)
            least, most = np.maximum(least, last - reach), np.minimum(most, last + reach)
            kept = slice(n - held, n) if from_end else slice(0, held)
            least[:, kept] = most[:, kept] = y[:, kept]
    total = cells.sum(axis=1)
    lower, upper = np.full(len(y), -_BEYOND), np.full(len(y), 1.0 + _BEYOND)
    for _ in range(_STEPS):
        part = 0.5 * (lower + upper)
        sums = np.exp(_between(part, low, high, least, most)).sum(axis=1)
        lower, upper = np.where(sums < total, part, lower), np.where(sums < total, upper, part)
    new = np.exp(_between(0.5 * (lower + upper), low, high, least, most))
    possible = np.abs(new.sum(axis=1) / total - 1.0) < 1e-6
    return np.where(possible[:, None], new, cells), possible


def _between(part: Floats, low: Floats, high: Floats, least: Floats, most: Floats) -> Floats:
    """Return the mean of envelopes (k, n) that `part` (k,) stands for; both are left below 0 and above 1."""
    inside = np.clip(part, 0.0, 1.0)[:, None]
    return np.clip(low + inside * (high - low) + (part[:, None] - inside), least, most)


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
