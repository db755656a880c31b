"""Heights of layers from a wall, of which the first and about the last are given."""

import numpy as np

from meshonet.geometry.arrays import Floats

_STEPS = 60
STEEPER = 0.2
"""By how much more than with a constant ratio, as a part of its logarithm, neighbouring cells may differ."""


def layer_arcs(
    length: Floats, first: float, last: Floats, cells: int, constant: int = 1, growth: float = 1.0
) -> Floats:
    """Return arcs (k, cells + 1) from 0 to `length` (k,) of cells that start with `first` at the wall.

    The first `constant` cells are equal. The logarithm of the others is a parabola of their number that ends
    at about `last` (k,), or where a constant ratio has it if that is infinite: as far as neighbouring cells
    then grow by at most `growth`, or a fifth more, in logarithms, than with a constant ratio. They do not
    shrink.
    """
    rows = cells - constant + 1  # the last constant cell and those that grow
    rest = length - (constant - 1) * first
    k = np.arange(rows) / max(rows - 1, 1)
    plain = _plain(rest, first, rows)
    slope = np.minimum(np.log(np.maximum(last, first) / first), 60.0)
    slope = np.where(np.isfinite(last), slope, plain)
    bend = np.zeros_like(length)
    low, high = np.full_like(length, -4.0 * 60.0), np.full_like(length, 4.0 * 60.0)
    for _ in range(_STEPS):  # ln d = ln first + slope k + bend k (1 - k): bisection for the sum
        bend = 0.5 * (low + high)
        total = first * np.exp(slope[:, None] * k + bend[:, None] * k * (1 - k)).sum(axis=1)
        low, high = np.where(total < rest, bend, low), np.where(total < rest, high, bend)
    most = np.maximum((1.0 + STEEPER) * plain, (rows - 1) * np.log(growth))
    room = np.minimum(most - plain, plain)
    steep = (slope + np.abs(bend) > most) | (slope < np.abs(bend))  # the last cell gives way
    bound = np.where(steep, np.clip(bend, -room, room), bend)
    if (bound != bend).any():
        slope, bend = _with_bend(rest, first, bound, slope, bend, k)
    steps = first * np.exp(slope[:, None] * k + bend[:, None] * k * (1 - k))
    steps[:, 1:] *= ((rest - first) / steps[:, 1:].sum(axis=1))[:, None]  # the last digits
    steps = np.concatenate([np.full((len(length), constant - 1), first), steps], axis=1)
    arcs = np.concatenate([np.zeros((len(length), 1)), np.cumsum(steps, axis=1)], axis=1)
    arcs[:, -1] = length
    return np.asarray(arcs)


def _plain(rest: Floats, first: float, rows: int) -> Floats:
    """Return the logarithm (k,) of the last cell over the first of a constant ratio."""
    k = np.arange(rows) / max(rows - 1, 1)
    low, high = np.zeros_like(rest), np.full_like(rest, 60.0)
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        total = first * np.exp(middle[:, None] * k).sum(axis=1)
        low, high = np.where(total < rest, middle, low), np.where(total < rest, high, middle)
    return np.asarray(0.5 * (low + high))


def _with_bend(
    rest: Floats, first: float, bound: Floats, slope: Floats, bend: Floats, k: Floats
) -> tuple[Floats, Floats]:
    """Return slope and bend (k,) where bends are bounded and slopes make up for it."""
    low, high = np.full_like(rest, -60.0), np.full_like(rest, 60.0)
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        total = first * np.exp(middle[:, None] * k + bound[:, None] * k * (1 - k)).sum(axis=1)
        low, high = np.where(total < rest, middle, low), np.where(total < rest, high, middle)
    changed = bound != bend
    return np.where(changed, 0.5 * (low + high), slope), bound
