"""Harmonic extension of a boundary: x and y solve Laplace's equation in a rectangle or a ring."""

import math

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import cos, exp, expm1, product, sin
from meshonet.solvers.iteration import put_edges

FAR = 37.0  # exp(-37) is the precision of a double: modes that have decayed so far are left out


def extend(boundary: Boundary) -> Floats:
    """Return the nodes (ni, nj, 2) of the solution of Laplace's equation; boundary nodes are exact.

    A quad grid is the bilinear interpolation of its corners plus a series for each side. An O grid is the
    linear interpolation of the centroids of wall and far-field nodes plus two series. For the side eta = 0::

        quad  sum_k b_k sin(k pi xi) sinh(k pi a (1-eta)) / sinh(k pi a)
        o     sum_k c_k exp(2 pi i k xi) sinh(k T (1-eta)) / sinh(k T)

    b_k are sine coefficients of the differences between the side's nodes and the line through its ends, a is
    the length of west and east divided by that of south and north. c_k (k not 0) are Fourier coefficients of
    the side's nodes, T is log(length of the far field / length of the wall).

    >>> s, zero, one = np.linspace(0.0, 1.0, 5), np.zeros(5), np.ones(5)
    >>> square = Boundary(*(np.stack(edge, axis=1) for edge in [(s, zero), (s, one), (zero, s), (one, s)]))
    >>> extend(square)[1, 2].tolist()
    [0.25, 0.5]
    """
    nodes = _ring(boundary) if boundary.periodic else _rectangle(boundary)
    put_edges(nodes, boundary)
    return nodes


def _rectangle(b: Boundary) -> Floats:
    height = (_length(b.west) + _length(b.east)) / (_length(b.south) + _length(b.north))
    xi, eta = np.linspace(0.0, 1.0, b.ni)[:, None], np.linspace(0.0, 1.0, b.nj)[:, None]
    low, high = (1.0 - xi) * b.south[0] + xi * b.south[-1], (1.0 - xi) * b.north[0] + xi * b.north[-1]
    left, right = (1.0 - eta) * low[0] + eta * high[0], (1.0 - eta) * low[-1] + eta * high[-1]
    nodes = (1.0 - eta)[None] * low[:, None] + eta[None] * high[:, None]
    across = nodes.swapaxes(0, 1)
    for into, side, start, ratio in (
        (nodes, b.south, low, height),
        (nodes[:, ::-1], b.north, high, height),
        (across, b.west, left, 1.0 / height),
        (across[:, ::-1], b.east, right, 1.0 / height),
    ):
        n, rows = len(side), into.shape[1]
        k = np.arange(1, n - 1)
        sines = sin(np.pi * np.outer(np.arange(n), k) / (n - 1))
        b_k = 2.0 / (n - 1) * product(sines.T, side - start)
        _add(into, sines, b_k, np.asarray(np.pi * ratio * k, float), rows)
    return nodes


def _ring(b: Boundary) -> Floats:
    height = math.log(_length(b.north) / _length(b.south))
    n = b.ni - 1
    k = np.arange(1, n // 2 + 1)
    eta = np.linspace(0.0, 1.0, b.nj)[:, None]
    mean, far = b.south[:-1].mean(axis=0), b.north[:-1].mean(axis=0)
    nodes = np.broadcast_to((1.0 - eta) * mean + eta * far, (b.ni, b.nj, 2)).copy()
    angle = 2.0 * np.pi * np.outer(np.arange(b.ni) % n, k) / n
    waves = np.concatenate([cos(angle), -sin(angle)], axis=1)
    for into, side in ((nodes, b.south), (nodes[:, ::-1], b.north)):
        c: Complexes = np.fft.rfft(side[:-1], axis=0)[1:] * (2.0 / n)
        if n % 2 == 0:
            c[-1] *= 0.5
        _add(into, waves, np.concatenate([c.real, c.imag]), np.concatenate([height * k] * 2), b.nj)
    return nodes


def _add(into: Floats, waves: Floats, b: Floats, rate: Floats, rows: int) -> None:
    """Add the modes `waves` (n, k) with coefficients b (k, 2) on the first row to rows 1 .. of `into`."""
    first = 1
    while first < rows:
        last = min(2 * first, rows)
        eta = np.arange(first, last) / (rows - 1)
        reach = np.flatnonzero(rate * eta[0] < FAR)
        r = rate[reach, None]
        fade = (exp(-r * eta) - exp(-r * (2.0 - eta))) / -expm1(-2.0 * r)
        some = waves[:, reach] if len(reach) < waves.shape[1] else waves
        for d in (0, 1):
            into[:, first:last, d] += product(some, b[reach, d : d + 1] * fade)
        first = last


def _length(side: Floats) -> float:
    return float(np.hypot(*np.diff(side, axis=0).T).sum())
