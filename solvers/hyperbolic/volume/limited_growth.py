"""Nodes moved along the lines of a volume to limit the growth of cells."""

import math

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, norms
from meshonet.geometry.elementary import exp, log

_MARGIN = 1e-3  # fraction of the logarithm of the limit that is used: chords are shorter than the lines
_HALVINGS = 40  # of the range that the tilt of a line lies in
_LEAST = 0.2  # of the growth, in logarithms: what that of steps is taken for where it is less
_MOST = 0.5  # part by which growth is cut down at the most: what is beyond it is at few lines
_NEAR = 2  # levels to each side of one whose growth is taken along
_TOGETHER = 1 << 11  # lines at a time: little memory beside their own
_PASSES = 12  # chords change a little when nodes move


def growth_of_levels(lines: Floats) -> Floats:
    """Return the largest growth (m - 1,) at inner levels of `lines` (3, n, m + 1)."""
    largest = np.ones(lines.shape[2] - 2)
    for k in range(0, lines.shape[1], _TOGETHER):
        steps = norms(np.moveaxis(np.diff(lines[:, k : k + _TOGETHER], axis=2), 0, -1))
        ratio = steps[:, 1:] / steps[:, :-1]
        np.maximum(largest, np.maximum(ratio, 1.0 / ratio).max(axis=0), out=largest)
    return largest


def slower_steps(steps: Floats, last_growth: Floats, growth: float) -> Floats:
    """Return `steps` (m,) of the last march, changed to grow less where cells grew too much.

    `last_growth` (m - 1,) are the largest ratios of cells there. They exceed those of the steps by a factor,
    on logarithms, that is assumed to depend on the distance from the wall. `growth` is the limit.
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
    """Move nodes of `lines` (3, n, levels) along the lines, in place; first cells and last nodes stay.

    Lines within the limit do not change. On lines that are too long for it, cells grow by one ratio.
    """
    if math.isinf(growth):
        return
    most = math.log(growth)
    for k in range(0, lines.shape[1], _TOGETHER):
        part = lines[:, k : k + _TOGETHER]
        for _ in range(_PASSES):
            steps = norms(np.moveaxis(np.diff(part, axis=2), 0, -1))
            change = np.diff(log(steps), axis=1)
            uneven = np.flatnonzero(np.abs(change).max(axis=1) > most)
            if not len(uneven):
                break
            limited = _limited(steps[uneven], change[uneven], (1.0 - _MARGIN) * most)
            _move(part, uneven, steps[uneven], limited)


def _limited(steps: Floats, change: Floats, most: float) -> Floats:
    """Return steps (k, m) with the same firsts and sums whose logarithms change by at most `most`."""
    length = steps.sum(axis=1)
    longest = steps[:, 0] * math.expm1(most * steps.shape[1]) / math.expm1(most)
    bound = np.where(longest < length, math.inf, most)[:, None]  # too long: all changes are the tilt
    change = np.where(longest < length, 0.0, 1.0)[:, None] * change

    def made(tilt: Floats) -> Floats:
        log_ratio = np.cumsum(np.clip(change + tilt[:, None], -bound, bound), axis=1)
        return np.concatenate([steps[:, :1], steps[:, :1] * exp(log_ratio)], axis=1)

    low, high = np.full(len(steps), -2.0 * most), np.full(len(steps), 2.0 * most)
    for _ in range(_HALVINGS):
        tilt = 0.5 * (low + high)
        short = made(tilt).sum(axis=1) < length
        low, high = np.where(short, tilt, low), np.where(short, high, tilt)
    return made(0.5 * (low + high))


def _move(lines: Floats, which: Indices, old: Floats, new: Floats) -> None:
    """Move inner nodes of some lines (3, n, levels), in place, from `old` to `new` steps (k, m)."""
    before, after = (np.cumsum(steps, axis=1) for steps in (old, new))
    for row, n in enumerate(which):
        for axis in range(3):
            line = lines[axis, n]
            line[2:-1] = np.interp(after[row, 1:-1], before[row], line[1:])
