"""Nodes moved along the lines that leave walls until neighbouring cells differ by at most a given ratio.

Levels that grow by one ratio do not give lines that do: where lines spread, behind a sharp edge say, a front
catches up and cells grow faster for some rows. Each line keeps its course, its length and its first cells.
"""

import math

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.quality.growth import ratios

PASSES = 8
"""Times at most that nodes are moved: chords of a bent line are not what its arcs are, less so each time."""
SPARE = 1.08
"""How much longer than a line its cells must be able to be: with less, one is changed all along where its
neighbour is not at all."""
LEFT = 1e-6
"""Part of the growth above 1 that is left out, so that files whose numbers are rounded keep to it as well."""
HALVINGS = 60  # of the interval of a line's factor
_MOST = math.log(100.0)  # of the factor on the last cell of a line


def limit_growth(nodes: Floats, growth: float, constant: int, last: int = 0) -> bool:
    """Move nodes (ni, nj, 2) along lines of eta, in place; say whether all cells grow by at most `growth`.

    The first `constant` and the `last` cells of a line, its ends and, but for rounding of bends, its course
    stay.
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
    """Return arcs (m, n-1) of inner nodes on lines of `steps` (m, n); logarithms change by `rate` at most.

    They are the largest below exp(c k/n) times the steps, k counted from the cells that stay, with the c of
    each line that keeps its length; None where cells growing by that rate all the way do not reach.
    """
    count = steps.shape[1]
    k = np.arange(count, dtype=np.float64)
    weight = np.maximum(k - (constant - 1), 0.0) / count
    if last:
        weight = np.minimum(weight, np.maximum(count - last - k, 0.0) / count)
    plain, length = log(steps), steps.sum(axis=1)
    low, high = np.full(len(steps), -_MOST), np.full(len(steps), _MOST)
    if (_capped(plain + _MOST * weight, k, rate).sum(axis=1) < SPARE * length).any():
        return None
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        short = _capped(plain + middle[:, None] * weight, k, rate).sum(axis=1) < length
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    sizes = _capped(plain + high[:, None] * weight, k, rate)
    arcs = np.cumsum(sizes, axis=1)
    arcs *= np.where(np.abs(arcs[:, -1:] / length[:, None] - 1.0) < 1e-9, 1.0, length[:, None] / arcs[:, -1:])
    return np.asarray(arcs[:, :-1])


def _capped(wanted: Floats, k: Floats, rate: float) -> Floats:
    """Return exp of the largest below `wanted` (m, n) whose neighbours differ by `rate` at most."""
    ahead = np.minimum.accumulate(wanted - rate * k, axis=1) + rate * k
    back = np.minimum.accumulate((ahead + rate * k)[:, ::-1], axis=1)[:, ::-1] - rate * k
    return np.asarray(exp(back))
