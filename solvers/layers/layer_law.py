"""Heights of layers from a wall, with a given first and an approximate last height."""

import math

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import log
from meshonet.kernels._native import layer_law

STEEPER = 0.2
"""Fraction by which the logarithm of a ratio of neighbouring cells may exceed that of the constant ratio."""


def layer_arcs(
    length: Floats, first: float | Floats, last: Floats, cells: int, constant: int = 1, growth: float = 1.0,
    steeper: float = STEEPER,
) -> Floats:  # fmt: skip
    """Return the distances (k, cells + 1) of nodes from the wall, on lines of `length` (k,).

    The first `constant` cells have the height `first`, a number or (k,). Further heights never decrease.
    Their logarithms are a quadratic function of the index, and the last height is about `last` (k,). Let r be
    the constant ratio that fills the line. If `last` is infinite, all ratios are r. Otherwise no ratio
    exceeds the larger of r^(1 + `steeper`) and `growth`; this limit takes precedence over `last`.
    """
    rows = cells - constant + 1  # the last constant cell and those that grow
    first = np.broadcast_to(np.asarray(first, dtype=np.float64), length.shape)
    rest = length - (constant - 1) * first
    growths = np.empty((len(length), rows))
    slope = np.where(np.isfinite(last), log(np.maximum(last, first) / first), np.inf)
    layer_law(rest / first, slope, (rows - 1) * math.log(growth), steeper, growths)
    steps = first[:, None] * growths
    steps[:, 1:] *= ((rest - first) / steps[:, 1:].sum(axis=1))[:, None]  # the last digits
    steps = np.concatenate([np.repeat(first[:, None], constant - 1, axis=1), steps], axis=1)
    arcs = np.concatenate([np.zeros((len(length), 1)), np.cumsum(steps, axis=1)], axis=1)
    arcs[:, -1] = length
    return np.asarray(arcs)
