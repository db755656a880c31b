"""Moves nodes along the lines that leave walls until neighbouring cells differ by at most a given ratio.

Each line keeps its curve, its length and its first cells.
"""

import math

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.quality.growth import ratios
from meshonet.geometry.spacing.gradual_sizes import limited_sizes

PASSES = 8  # largest number of passes; chords of a bent line differ from its arcs, less so in each pass
SPARE = 1.08  # smallest ratio of the length that the cells can reach to the length of the line
LEFT = 1e-6  # margin below the growth limit, relative to growth - 1, so that rounded files satisfy it too
HALVINGS = 60  # of the interval of a line's factor
_MOST = math.log(100.0)  # of the factor on the last cell of a line


def limit_growth(nodes: Floats, growth: float, constant: int, last: int = 0) -> bool:
    """Move nodes (ni, nj, 2) along lines of constant i until cells grow by at most `growth`; return success.

    The first `constant` and the last `last` cells of a line do not change. Nodes stay on the curve of their
    line, except where bends of the line are rounded.
    """
    allowed = 1.0 + (growth - 1.0) * (1.0 - LEFT)
    limit = 1.0 + (growth - 1.0) * (1.0 - 2.0 * LEFT)
    for _ in range(PASSES):
        most = ratios(nodes.swapaxes(0, 1)).max(axis=0)
        wrong = np.flatnonzero(most > allowed)
        if not wrong.size:
            return True
        steps = norms(np.diff(nodes[wrong], axis=1))
        arcs = _limited(steps, math.log(limit), constant, last)
        if arcs is None:
            return False
        for line, new, own in zip(wrong, arcs, steps, strict=True):
            at = np.concatenate([[0.0], np.cumsum(own)])
            nodes[line, 1:-1] = np.stack([np.interp(new, at, x) for x in nodes[line].T], axis=-1)
        worst = float(ratios(nodes[wrong].swapaxes(0, 1)).max())
        limit = max(limit - 2.0 * max(worst - allowed, 0.0), 1.0 + 0.9 * (growth - 1.0))
    return False


def _limited(steps: Floats, rate: float, constant: int, last: int) -> Floats | None:
    """Return arc lengths (m, n-1) of inner nodes on lines of `steps` (m, n), limited to the growth `rate`.

    The new steps are the largest ones below exp(c k/n) times the old steps, where k counts from the first
    free cell and the constant c keeps the length of the line. None if growth by `rate` does not suffice.
    """
    count = steps.shape[1]
    k = np.arange(count, dtype=np.float64)
    weight = np.maximum(k - (constant - 1), 0.0) / count
    if last:
        weight = np.minimum(weight, np.maximum(count - last - k, 0.0) / count)
    plain, length = log(steps), steps.sum(axis=1)
    low, high = np.full(len(steps), -_MOST), np.full(len(steps), _MOST)
    if (exp(limited_sizes(plain + _MOST * weight, k, rate)).sum(axis=1) < SPARE * length).any():
        return None
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        short = exp(limited_sizes(plain + middle[:, None] * weight, k, rate)).sum(axis=1) < length
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    sizes = exp(limited_sizes(plain + high[:, None] * weight, k, rate))
    arcs = np.cumsum(sizes, axis=1)
    arcs *= np.where(np.abs(arcs[:, -1:] / length[:, None] - 1.0) < 1e-9, 1.0, length[:, None] / arcs[:, -1:])
    return np.asarray(arcs[:, :-1])
