"""Spacing of the levels of a march: constant growth, but slower where lines from a sharp edge diverge."""

import math
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import exp, log, power
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.spacing.growth import growing_steps, growth_rate

_LESS = 0.24  # largest reduction of growth, as a fraction, where lines from an edge of zero angle diverge
_BEGIN, _FULL = 1.2, 3.0  # distances from the wall, in edge cells, of half the reduction and of its fading
_FADE = 0.45  # power of the height with which it fades
_BEFORE = 0.04  # part of the growth left out nearer to the wall, where lines off a leading edge grow the most
_LEAST_TURN = math.radians(60.0)  # of an edge that counts as sharp


class Edge(NamedTuple):
    """A sharp corner of a wall: length of the cells next to it, and 1 - cos(half its turning angle)."""

    size: float
    sharpness: float


def sharpest_edge(ring: Floats) -> Edge | None:
    """Return the convex corner at which a wall turns most; None if no corner turns by at least 60 degrees.

    `ring` (n, 2) is a closed, clockwise wall without its repeated first node.
    """
    turn = -turning(ring, closed=True)
    k = int(np.argmax(turn))
    if turn[k] < _LEAST_TURN:
        return None
    size = 0.5 * float(np.hypot(*(ring[(k + 1) % len(ring)] - ring[k])) + np.hypot(*(ring[k] - ring[k - 1])))
    return Edge(size, 1.0 - math.cos(0.5 * turn[k]))


def fastest(nodes: Floats) -> Floats:
    """Return the logarithm (nj - 2,) of the greatest growth ratio at each inner j of `nodes` (ni, nj, 2)."""
    heights = norms(np.diff(nodes, axis=1))
    return np.asarray(log(heights[:, 1:] / heights[:, :-1]).max(axis=0))


def even_shares(nodes: Floats, steps: Floats, rate: float, constant: int) -> Floats:
    """Return the growth of march steps for which the largest growth ratio among cells is equal on all levels.

    The result is `shares` (n,) of `level_steps`: log(step k / step (k - 1)) is proportional to ``shares[k]``.

    Parameters
    ----------
    nodes, steps : nodes (ni, nj, 2) of a marched grid, and the n steps between its levels.
    rate : logarithm of the largest permitted growth ratio.
    constant : number of equal steps at the wall.
    """
    grown = np.diff(log(steps))
    shares = np.maximum(grown + rate - fastest(nodes), 0.0)
    shares[: constant - 1] = 0.0
    return np.concatenate([[0.0], shares])


def level_steps(
    first: float, distance: float, cells: int, constant: int, edge: Edge | None, shares: Floats | None = None
) -> Floats:
    """Return step lengths (cells,) that begin with `first` and add up to `distance`.

    Parameters
    ----------
    constant : number of equal steps at the wall; all further steps grow by one ratio.
    edge : sharp edge of the wall, or None. Grid lines fan out at an edge; growth then varies.
    shares : (cells,) relative growth of the steps, used in place of `constant` and `edge`:
        log(step k / step (k - 1)) is proportional to ``shares[k]``; ``shares[0]`` is 0.

    >>> level_steps(1.0, 9.0, 5, 3, None).tolist()
    [1.0, 1.0, 1.0, 2.0, 4.0]
    """
    if shares is not None:
        place = np.cumsum(shares)
        most = math.log(distance / first) / max(float(place[-1]), 1e-9)
        rate = growth_rate(place, first, distance, max(most, 1.0))
        return np.asarray(first * exp(rate * place))
    plain = growing_steps(first, distance, cells, constant)
    if edge is None or cells < 3 or plain[-1] == plain[-2]:
        return plain
    height = np.cumsum(plain[:-1]) / edge.size
    begun = 1.0 / (1.0 + power(_BEGIN / height, 5.0))
    less = _LESS * begun * power(np.maximum(height / _FULL, 1.0), -_FADE) + _BEFORE * (1.0 - begun)
    share = 1.0 - edge.sharpness * less
    share[: constant - 1] = 0.0
    place = np.concatenate([[0.0], np.cumsum(share)])
    rate = growth_rate(place, first, distance, math.log(plain[-1] / plain[-2]))
    return np.asarray(first * exp(rate * place))
