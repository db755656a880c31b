"""Cell sizes that follow the shape: small at edges and where the curve turns, growing slowly in between."""

from __future__ import annotations

import math

import numpy as np

from geometry.arrays import Floats
from geometry.curves import Curve
from geometry.sampling import monotone_cubic

GROWTH = math.log(1.10)
"""How fast a cell may grow along the wall: by 10 % from one to the next."""
TURN = math.radians(3.0)
"""How much of the curve's turning one cell may take."""
_WINDOW = 2e-3
"""Chords over which curvature is averaged, so that the last digit of the points does not count."""
_SAMPLES = 2400
_REACH = 8.0
"""Cells over which the field is bent to meet a step asked for."""


def arcs_by_curvature(
    curve: Curve,
    stations: tuple[float, float, float],
    cells: int,
    *,
    chord: float,
    steps: tuple[float, float],
    exact: tuple[bool, bool],
) -> Floats:
    """Return arc lengths (cells + 1,) from one end of the trailing edge round the nose to the other.

    The size field h is the smooth least of four terms, 1/h⁴ = Σ 1/hₖ⁴: a step at the trailing and one at the
    leading edge that grow with the distance from it, `TURN` over the curvature limited to the same growth,
    and a largest cell chosen so that the integral of ds/h is the number of cells. With too few cells for
    the first three, all are scaled up together.

    Parameters
    ----------
    curve : the wall.
    stations : arc lengths of the lower end, of the nose and of the upper end.
    cells : wanted.
    chord : unit of the averaging window.
    steps : cells at the trailing and at the leading edge.
    exact : whether these are to be met, to 0.5 % where the field can be bent so far.
    """
    lower, nose, upper = stations
    s = _samples(stations, steps)
    bend = _bend(curve, s, chord)
    known = _known(s, bend, stations, steps)
    mend, places = np.zeros(2), np.arange(cells + 1.0)
    away = np.minimum(s - lower, upper - s), np.abs(s - nose)
    for _ in range(12):
        relief = np.exp(
            sum(m * np.exp(-d / (_REACH * step)) for m, d, step in zip(mend, away, steps, strict=True))
        )
        density = _density(s, known, relief, cells)
        count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))])
        arcs = monotone_cubic(count * (cells / count[-1]), s, places)
        arcs[0], arcs[-1] = lower, upper
        width = np.diff(arcs)
        got = 0.5 * (width[0] + width[-1]), width[np.searchsorted(arcs, nose) - 1]
        error = np.where(exact, np.log(np.array(steps) / np.array(got)), 0.0)
        if np.abs(error).max() < 5e-3:
            break
        mend += error
    return arcs


def distances_by_curvature(curve: Curve, begin: float, way: float, cells: int) -> Floats:
    """Return distances (cells + 1,) along a closed curve from `begin` on, following curvature alone.

    Parameters
    ----------
    curve : closed.
    begin : arc length to start from.
    way : length to go, negative against the curve's direction.
    cells : wanted.
    """
    s = np.linspace(0.0, abs(way), 2 * _SAMPLES + 1)
    bend = _bend(curve, begin + np.sign(way) * s, curve.length)
    known = _limited_size(s, TURN / bend) ** -4
    density = _density(s, known, np.ones_like(s), cells)
    count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))])
    distance = monotone_cubic(count * (cells / count[-1]), s, np.arange(cells + 1.0))
    distance[0], distance[-1] = 0.0, abs(way)
    return distance


def _samples(stations: tuple[float, float, float], steps: tuple[float, float]) -> Floats:
    """Return arc lengths from the lower to the upper end, close together where the steps are small."""
    lower, nose, upper = stations
    half = 0.5 * (upper - lower)
    te, le = (np.geomspace(0.1 * step, half, _SAMPLES // 8) for step in steps)
    even = np.linspace(lower, upper, _SAMPLES // 2)
    every = np.concatenate([even, lower + te, upper - te, nose + le, nose - le, [nose]])
    s = np.unique(every[(every >= lower) & (every <= upper)])
    kept = s[np.concatenate([[True], np.diff(s) > 1e-9 * half])]
    kept[-1] = upper
    return kept


def _bend(curve: Curve, s: Floats, chord: float) -> Floats:
    """Return the absolute curvature at arc lengths s, averaged over `_WINDOW`, at least 0.01 a chord."""
    low, high = min(s[0], s[-1]), max(s[0], s[-1])
    t = np.linspace(low, high, 4 * _SAMPLES)
    d = curve.tangent(np.clip(t, low + 1e-9 * (high - low), high - 1e-9 * (high - low)))
    angle = np.unwrap(np.arctan2(d[:, 1], d[:, 0]))
    before, after = np.maximum(s - _WINDOW * chord, low), np.minimum(s + _WINDOW * chord, high)
    turned = np.abs(np.interp(after, t, angle) - np.interp(before, t, angle))
    return np.asarray(np.maximum(turned / (after - before), 1e-2 / chord))


def _known(
    s: Floats, bend: Floats, stations: tuple[float, float, float], steps: tuple[float, float]
) -> Floats:
    """Return the sum of 1/h⁴ over the terms of both edges and of curvature."""
    lower, nose, upper = stations
    size = TURN / bend
    size[[0, -1]] = size[[0, -1]].min()  # the two surfaces meet here
    size = _limited_size(s, size)
    edge = steps[0] + GROWTH * np.minimum(s - lower, upper - s)
    return np.asarray(edge**-4 + (steps[1] + GROWTH * np.abs(s - nose)) ** -4 + size**-4)


def _limited_size(s: Floats, size: Floats) -> Floats:
    """Return h(s) = min over s' of size(s') + growth |s - s'|, by one pass each way."""
    size = np.minimum.accumulate(size - GROWTH * s) + GROWTH * s
    return np.asarray(np.minimum.accumulate((size + GROWTH * s)[::-1])[::-1] - GROWTH * s)


def _density(s: Floats, known: Floats, relief: Floats, cells: int) -> Floats:
    """Return 1/h with the largest cell that makes its integral the number of cells."""
    width, weight = np.diff(s), relief**-4
    low, high = 1e-2 * (s[-1] - s[0]) / cells, 1e2 * (s[-1] - s[0])
    for _ in range(30):
        middle = math.sqrt(low * high)
        density = np.sqrt(np.sqrt((known + middle**-4) * weight))
        low, high = (middle, high) if 0.5 * width @ (density[1:] + density[:-1]) > cells else (low, middle)
    return np.asarray(np.sqrt(np.sqrt((known + high**-4) * weight)))
