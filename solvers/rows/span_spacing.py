"""Heights of nodes along the span: prescribed cells at both ends, which grow to a largest size."""

from bisect import bisect_left
from dataclasses import dataclass
from typing import Self, TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import exp, log, power
from meshonet.kernels._native import way_ahead
from meshonet.solvers.rows.span_lines import SpanLines, integrals_at_keys, key_heights, slopes_at_keys

_NEWTON = 12
_FLATTEST, _FARTHEST = 1e-9, (-30.0, 30.0)  # of Newton's method: least slope, steps of the logarithm
_LENGTHS = 33  # of lines for which nodes are spaced; others lie between
SAMPLES = 17  # number of heights at which positions along a line must be known
_MOST_BENT = 60.0  # of the logarithm of sizes, at which cells in the middle are a million times larger
MOST_CELLS = 1000

Ends: TypeAlias = tuple[Floats | float, Floats | float]
"""First and last cells of n lines, each a number or (n,)."""


def spaced_cells(length: float, ends: Ends, growth: float, largest: float, least: int) -> int:
    """Return the number of cells that fill a `length`; it is at least `least`.

    From the sizes `ends` at both ends, cells grow by the ratio `growth`, up to the size `largest`.
    """

    def reach(cells: int) -> float:
        return float(_sizes(np.array([largest]), _from_ends(ends, growth, cells))[0].sum())

    return bisect_left(range(MOST_CELLS), length, max(least, 4), key=reach)


def two_sided(lengths: Floats, ends: Ends, growth: float, cells: int) -> Floats:
    """Return arc lengths (n, cells + 1) of nodes on n lines; cells grow inwards from both `ends`."""
    from_ends = _from_ends(ends, growth, cells)
    least, most = lengths / cells, lengths
    largest = least
    for _ in range(_NEWTON):  # on the logarithms, between bounds
        sizes, share = _sizes(largest, from_ends)
        total = sizes.sum(axis=1)
        least, most = np.where(total < lengths, largest, least), np.where(total < lengths, most, largest)
        slope = (sizes * share).sum(axis=1) / total
        next_ = largest * exp(np.clip(log(lengths / total) / np.maximum(slope, _FLATTEST), *_FARTHEST))
        largest = np.where((next_ >= least) & (next_ <= most), next_, np.sqrt(least * most))
    sizes, _ = _sizes(largest, from_ends)
    sizes *= (lengths / sizes.sum(axis=1))[:, None]
    return np.concatenate([np.zeros((len(lengths), 1)), np.cumsum(sizes, axis=1)], axis=1)


def smooth_arcs(lengths: Floats, ends: tuple[Floats | float, Floats | float | None], cells: int) -> Floats:
    """Return arc lengths (n, cells + 1) of nodes on lines of `lengths` (n,), with evenly changing cells.

    `ends` are the first and the last cell length. The logarithm of the cell length is a quadratic function of
    the index of the cell, or a linear one if the last cell length is None.
    """
    t = np.linspace(0.0, 1.0, cells)
    first, last = (None if end is None else np.broadcast_to(end, lengths.shape)[:, None] for end in ends)
    straight, bump = log(first) + 0.0 * t, t
    if last is not None:
        straight, bump = straight + (log(last) - log(first)) * t, t * (1.0 - t)
    bend = np.zeros((len(lengths), 1))
    for _ in range(_NEWTON):  # on the logarithm of the sum, which is convex
        sizes = exp(straight + bend * bump)
        total = sizes.sum(axis=1)
        slope = (sizes * bump).sum(axis=1) / total
        before, bend = bend, np.clip(bend + (log(lengths / total) / slope)[:, None], -_MOST_BENT, _MOST_BENT)
        if (bend == before).all():  # as would be all that follow
            break
    sizes = exp(straight + bend * bump)
    sizes *= (lengths / sizes.sum(axis=1))[:, None]
    arcs = np.concatenate([np.zeros((len(lengths), 1)), np.cumsum(sizes, axis=1)], axis=1)
    arcs[:, -1] = lengths
    return arcs


def smooth_cells(
    length: Floats | float, ends: tuple[Floats | float, Floats | float | None], growth: float, least: int
) -> int:
    """Return how many cells, at least `least`, `smooth_arcs` needs for them to grow by at most `growth`.

    `length` and both cell lengths `ends` are numbers, or (n,) for n lines. The last one may be None (free).
    """
    lengths = np.atleast_1d(length)
    for cells in range(max(least, 4), MOST_CELLS):
        steps = np.diff(smooth_arcs(lengths, ends, cells)).T
        if (steps[1] <= growth * steps[0]).all() and (
            ends[1] is None or (steps[-2] <= growth * steps[-1]).all()
        ):
            return cells
    return MOST_CELLS


def _from_ends(ends: Ends, growth: float, cells: int) -> Floats:
    """Return sizes (n or 1, cells) that `ends` ask for, to the power -4."""
    grown = power(growth, np.arange(cells, dtype=np.float64))
    low, high = (np.reshape(end, (-1, 1)) for end in ends)
    return np.asarray(_fourth(1.0 / (low * grown)) + _fourth(1.0 / (high * grown[::-1])))


def _sizes(largest: Floats, from_ends: Floats) -> tuple[Floats, Floats]:
    """Return sizes (n, cells) and how much each grows, relatively, with `largest` (n,), its limit."""
    middle = _fourth(1.0 / largest)[:, None]
    both = 1.0 / (from_ends + middle)
    return np.sqrt(np.sqrt(both)), both * middle


def _fourth(values: Floats) -> Floats:
    return np.square(np.square(values))


@dataclass(frozen=True, eq=False)
class Spacing:
    """Relative arc lengths of nodes on lines with given end cells, tabulated by the length of the line."""

    lengths: tuple[float, float]  # shortest and longest line
    table: Floats  # (cells + 1, m) relative arc lengths at m equally spaced lengths

    @classmethod
    def of(cls, lengths: tuple[float, float], ends: Ends, growth: float, cells: int) -> Self:
        """Return node spacings, computed by `two_sided`, for all line lengths between the two `lengths`."""
        known = np.linspace(*lengths, _LENGTHS if lengths[1] > lengths[0] * (1.0 + 1e-9) else 1)
        return cls(lengths, (two_sided(known, ends, growth, cells) / known[:, None]).T)

    def at(self, lengths: Floats) -> Floats:
        """Return the relative arc lengths (cells + 1, n) of the nodes on n lines of these `lengths` (n,)."""
        last = self.table.shape[1] - 1
        if not last:
            return np.repeat(self.table, len(lengths), axis=1)
        low, high = self.lengths
        place = (lengths - low) / (high - low) * last
        k = np.minimum(place.astype(np.intp), last - 1)
        share = place - k
        return np.asarray(self.table[:, k] + share * (self.table[:, k + 1] - self.table[:, k]))


@dataclass(frozen=True, eq=False)
class LineArcs:
    """Relation between the arc length and a parameter from 0 to 1, on each of n lines."""

    lengths: Floats  # (n,) lengths of the lines
    ahead: SpanLines  # parameter minus relative arc length, by relative arc length

    @classmethod
    def through(cls, samples: Floats) -> Self:
        """Return arc lengths on n lines with points `samples` (k, n, 3) at parameters ``key_heights(k)``."""
        speed = norms(slopes_at_keys(samples))
        arcs = integrals_at_keys(speed)
        lengths, wanted = arcs[-1], key_heights(len(samples))[:, None]
        behind, slope = SpanLines.through(arcs / lengths - wanted), SpanLines.through(speed / lengths)
        ahead = np.empty_like(arcs)
        way_ahead(behind.coefficients, slope.coefficients, wanted[:, 0], ahead)
        return cls(lengths, SpanLines.through(ahead))

    def parts(self, spacing: Spacing) -> Floats:
        """Return parameters (cells + 1, n), from 0 to 1 along n lines, of nodes with this `spacing`."""
        return self.parts_at(spacing.at(self.lengths))

    def parts_at(self, arcs: Floats) -> Floats:
        """Return the parameters (cells + 1, n) of nodes on the n lines at relative arc lengths `arcs`."""
        parts = np.clip(arcs + self.ahead.at(arcs), 0.0, 1.0)
        parts[0], parts[-1] = 0.0, 1.0
        return parts


def line_parts(samples: Floats, ends: Ends, growth: float, cells: int) -> Floats:
    """Return parameters (cells + 1, n), 0 to 1, of nodes on n lines; cells grow by `growth` from both `ends`.

    `samples` (SAMPLES, n, 3) are points of the lines at the parameters ``key_heights(SAMPLES)``.
    """
    arcs = LineArcs.through(samples)
    range_ = float(arcs.lengths.min()), float(arcs.lengths.max())
    return arcs.parts(Spacing.of(range_, ends, growth, cells))
