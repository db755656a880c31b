"""Heights of layers from a wall, with a given first and an approximate last height."""

import math
from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import exp, log

_STEPS = 60  # of bisection, to round-off
_MOST = 60.0  # of the logarithm of the last cell over the first
STEEPER = 0.2
"""Fraction by which the logarithm of a ratio of neighbouring cells may exceed that of the constant ratio."""


def layer_arcs(
    length: Floats, first: float | Floats, last: Floats, cells: int, constant: int = 1, growth: float = 1.0
) -> Floats:
    """Return distances (k, cells + 1) from 0 to `length` (k,) of cells that start at the wall.

    The first `constant` cells have the height `first`, a number or (k,). The logarithm of the others is a
    quadratic function of their index. It ends at about `last` (k,), or at the value for a constant ratio if
    that is infinite. Neighbouring cells grow by at most `growth`, or by a fifth more, in logarithms, than
    with a constant ratio. They do not shrink.
    """
    rows = cells - constant + 1  # the last constant cell and those that grow
    rest = length - (constant - 1) * first
    k = np.arange(rows) / max(rows - 1, 1)
    plain = _plain(rest, first, rows)
    slope = np.minimum(log(np.maximum(last, first) / first), _MOST)
    slope = np.where(np.isfinite(last), slope, plain)
    bend = _solved(lambda b: _total(slope, b, k), rest / first, -4.0 * _MOST, 4.0 * _MOST)
    most = np.maximum((1.0 + STEEPER) * plain, (rows - 1) * math.log(growth))
    room = np.minimum(most - plain, plain)
    steep = (slope + np.abs(bend) > most) | (slope < np.abs(bend))  # the last cell gives way
    bound = np.where(steep, np.clip(bend, -room, room), bend)
    changed = bound != bend
    if changed.any():
        slope = np.where(changed, _solved(lambda s: _total(s, bound, k), rest / first, -_MOST, _MOST), slope)
    first = np.broadcast_to(np.asarray(first, dtype=np.float64), length.shape)
    steps = first[:, None] * _growths(slope, bound, k)
    steps[:, 1:] *= ((rest - first) / steps[:, 1:].sum(axis=1))[:, None]  # the last digits
    steps = np.concatenate([np.repeat(first[:, None], constant - 1, axis=1), steps], axis=1)
    arcs = np.concatenate([np.zeros((len(length), 1)), np.cumsum(steps, axis=1)], axis=1)
    arcs[:, -1] = length
    return np.asarray(arcs)


def _plain(rest: Floats, first: float | Floats, rows: int) -> Floats:
    """Return the logarithm (k,) of the last cell over the first of a constant ratio."""
    k = np.arange(rows) / max(rows - 1, 1)
    return _solved(lambda slope: _total(slope, np.zeros_like(slope), k), rest / first, 0.0, _MOST)


def _growths(slope: Floats, bend: Floats, k: Floats) -> Floats:
    """Return cells (n, m) over the first, of which the logarithm is slope k + bend k (1 - k)."""
    return exp(slope[:, None] * k + bend[:, None] * k * (1 - k))


def _total(slope: Floats, bend: Floats, k: Floats) -> Floats:
    return np.asarray(_growths(slope, bend, k).sum(axis=1))


def _solved(total: Callable[[Floats], Floats], wanted: Floats, low: float, high: float) -> Floats:
    """Return where in a range a rising function is as wanted (n,), by bisection; an end of it if nowhere."""
    least, most = np.full_like(wanted, low), np.full_like(wanted, high)
    for _ in range(_STEPS):
        middle = 0.5 * (least + most)
        less = total(middle) < wanted
        least, most = np.where(less, middle, least), np.where(less, most, middle)
    return np.asarray(0.5 * (least + most))
