"""Nodes moved along the lines of a volume to limit the growth of cells."""

import math

import numpy as np

from meshonet.geometry.arrays import Floats, growth_ratios, norms
from meshonet.geometry.elementary import log
from meshonet.geometry.threads import MANY_VISITS, threads_for
from meshonet.kernels._native import limit_line_growth

_MARGIN = 1e-3  # fraction of the logarithm of the limit that is used: chords are shorter than the lines
_HALVINGS = 40  # of the range that the growth of steps lies in
_LEAST = 0.2  # of the growth, in logarithms: what that of steps is taken for where it is less
_MOST = 0.5  # part by which growth is cut down at the most: what is beyond it is at few lines
_NEAR = 2  # levels to each side of one whose growth is taken along
_TOGETHER = 1 << 11  # lines at a time: little memory beside their own


def growth_of_levels(lines: Floats) -> Floats:
    """Return the greatest growth ratio (m - 1,) at each inner level of `lines` (3, n, m + 1)."""
    largest = np.ones(lines.shape[2] - 2)
    for k in range(0, lines.shape[1], _TOGETHER):
        steps = norms(np.moveaxis(np.diff(lines[:, k : k + _TOGETHER], axis=2), 0, -1))
        np.maximum(largest, growth_ratios(steps).max(axis=0), out=largest)
    return largest


def slower_steps(steps: Floats, last_growth: Floats, growth: float) -> Floats:
    """Return the `steps` (m,) of a march, changed so that cells that grew too much grow less.

    `last_growth` (m - 1,) is the greatest growth ratio of cells at each inner level of the grid that was
    marched with `steps`. `growth` is the limit of this ratio.
    """
    length, most = float(steps.sum()), math.log(growth)
    ratio = np.maximum(log(steps[1:] / steps[:-1]), _LEAST * most)
    more = np.clip(log(last_growth) / ratio - 1.0, 0.0, _MOST)
    spread = np.max(
        [np.pad(more, _NEAR, mode="edge")[k : k + len(more)] for k in range(2 * _NEAR + 1)], axis=0
    )
    places = np.cumsum(steps)[:-1]

    def made(part: float, cells: int) -> Floats:
        sizes, away = [float(steps[0])], float(steps[0])
        while len(sizes) < cells:
            slower = 1.0 + float(np.interp(away, places, spread))
            sizes.append(sizes[-1] * math.exp(part * most / slower))
            away += sizes[-1]
        return np.array(sizes)

    fastest = np.cumsum(made(1.0, 2 * len(steps)))
    cells = max(int(np.searchsorted(fastest, length)) + 1, len(steps))
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        part = 0.5 * (low + high)
        low, high = (part, high) if made(part, cells).sum() < length else (low, part)
    return made(high, cells)


def limit_growth(lines: Floats, growth: float) -> None:
    """Move nodes along `lines` (3, n, levels), in place, so that cells grow by at most `growth`.

    First cells, last nodes and lines within the limit do not change. If a line is so long that its cells have
    to grow by more, they all grow by the same ratio.
    """
    if math.isinf(growth):
        return
    most = math.log(growth)
    used = (1.0 - _MARGIN) * most
    longest, first = (math.expm1(used * cells) for cells in (lines.shape[2] - 1, 1))
    limit_line_growth(lines, most, used, longest, first, threads_for(lines[0].size, MANY_VISITS))
