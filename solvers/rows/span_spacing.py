"""Heights of nodes along the span: first cells at both ends, sizes that grow from both up to a largest."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import exp, log, power
from meshonet.solvers.rows.span_lines import SpanLines, key_heights

_POWER = -4.0  # of the mean of what both ends and the middle ask for
_BISECTIONS = 60
_LENGTHS = 33  # of lines for which nodes are spaced; others lie between
SAMPLES = 17
"""Heights at which positions along a line have to be known."""
_NEWTON = 4
MOST_CELLS = 1000


Ends: TypeAlias = tuple[float, float]
"""Heights of the first and of the last cell of lines."""


def spaced_cells(length: float, ends: Ends, growth: float, largest: float, least: int) -> int:
    """Return how many cells fill a length, as at its `ends` and growing to `largest`; `least` or more."""
    for cells in range(max(least, 4), MOST_CELLS):
        if _sizes(np.array([largest]), ends, growth, cells).sum() >= length:
            return cells
    return MOST_CELLS


def two_sided(lengths: Floats, ends: Ends, growth: float, cells: int) -> Floats:
    """Return arcs (n, cells + 1) on lines of `lengths` (n,) of cells that grow from both `ends`."""
    low, high = log(1e-6 * lengths / cells), log(lengths)
    for _ in range(_BISECTIONS):
        mid = 0.5 * (low + high)
        more = _sizes(exp(mid), ends, growth, cells).sum(axis=1) > lengths
        low, high = np.where(more, low, mid), np.where(more, mid, high)
    sizes = _sizes(exp(0.5 * (low + high)), ends, growth, cells)
    sizes *= (lengths / sizes.sum(axis=1))[:, None]
    return np.concatenate([np.zeros((len(lengths), 1)), np.cumsum(sizes, axis=1)], axis=1)


def _sizes(largest: Floats, ends: Ends, growth: float, cells: int) -> Floats:
    """Return sizes (n, cells) that grow from both ends up to `largest` (n,)."""
    grown = power(growth, np.arange(cells, dtype=np.float64))
    both = power(ends[0] * grown, _POWER) + power(ends[1] * grown[::-1], _POWER)
    return np.asarray(power(both + power(largest, _POWER)[:, None], 1.0 / _POWER))


def line_parts(samples: Floats, ends: Ends, growth: float, cells: int) -> Floats:
    """Return parts (cells + 1, n), 0 to 1, of the way along lines, at which cells are as `two_sided`.

    `samples` (SAMPLES, n, 3) are positions on the lines at `key_heights` (SAMPLES) of the way.
    """
    places = key_heights(SAMPLES)
    speed = _speeds(samples)
    arcs = _integrals(speed)
    lengths = arcs[-1]
    ahead = SpanLines.through(arcs / lengths - places[:, None])  # how far the arc is ahead of the way
    wanted = _wanted(lengths, ends, growth, cells)
    part = wanted.copy()
    slope = SpanLines.through(speed / lengths)
    for _ in range(_NEWTON):
        part -= (part + ahead.at(part) - wanted) / slope.at(part)
        np.clip(part, 0.0, 1.0, out=part)
    part[0], part[-1] = 0.0, 1.0
    return part


def _wanted(lengths: Floats, ends: Ends, growth: float, cells: int) -> Floats:
    """Return arcs over lengths (cells + 1, n), between those of a few lengths."""
    low, high = float(lengths.min()), float(lengths.max())
    if high <= low * (1.0 + 1e-9):
        return np.repeat((two_sided(np.array([low]), ends, growth, cells) / low).T, len(lengths), axis=1)
    known = np.linspace(low, high, _LENGTHS)
    table = (two_sided(known, ends, growth, cells) / known[:, None]).T
    place = (lengths - low) / (high - low) * (_LENGTHS - 1)
    k = np.minimum(place.astype(np.intp), _LENGTHS - 2)
    share = place - k
    return np.asarray(table[:, k] + share * (table[:, k + 1] - table[:, k]))


def _speeds(samples: Floats) -> Floats:
    """Return the derivatives (SAMPLES, n) of the arc lengths by the part of the way."""
    lines = SpanLines.through(samples.reshape(SAMPLES, -1))
    return norms(lines.slopes_at_keys().reshape(samples.shape))


def _integrals(speed: Floats) -> Floats:
    """Return the integrals (SAMPLES, n) of a function known at `key_heights`, from the first on."""
    return SpanLines.through(speed).integrals_at_keys()
