"""Cell sizes that follow the shape: small at edges and where the curve turns, with slow growth in between."""

import math
from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.elementary import arctan2, exp, expm1, geomspace, log, product
from meshonet.geometry.spacing.gradual_sizes import limited_sizes

GROWTH = math.log(1.10)  # largest growth of cells along the wall: 10 % from one cell to the next
HURRY = 1.3  # factor on the growth if nodes are few, before curvature and nose are resolved more coarsely
RUSH = math.log(1.18) / GROWTH  # factor on growth from the corners of a base (small cells), if nodes are few
_LONGEST = 2.5  # largest cell between the corners of a base, in mean cells
_SCARCE = 5.0  # coarsening of curvature and nose beyond which growth is increased again
_RAMP = 3.0  # cells over which growth sets in behind a trailing edge with a prescribed size
_EDGE = 0.025  # fraction of the wall at either end where curvature asks for no cell below the edge's size
TURN = math.radians(3.0)  # largest turning angle of the curve along one cell
_WINDOW = 2e-3  # chords over which curvature is averaged, against noise in the last digit of the points
_SAMPLES = 1600  # approximate number of points on the curve at which sizes are computed
_SCARCEST = math.log(64.0)  # logarithm of the largest coarsening of curvature and leading edge
_REACH = 8.0  # cells over which the sizes are adjusted to meet a prescribed size


def arcs_by_curvature(
    curve: Curve,
    stations: tuple[float, float, float],
    cells: int,
    *,
    chord: float,
    steps: tuple[float, float],
    exact: tuple[bool, bool],
    hurried: bool = True,
    at_edge: float = 0.0,
    based: bool = False,
) -> Floats:
    """Return arc lengths (cells + 1,) from one end of the trailing edge around the nose to the other.

    The cell size h combines four sizes, 1/h⁴ = Σ 1/hₖ⁴. Two grow linearly away from the trailing and from
    the leading edge: the size at the edge plus `GROWTH` (ln 1.1) times the distance from it. One is the
    length on which the curve turns by 3 degrees. One is the same everywhere, such that there are `cells`
    cells. If the first three alone need more cells, the growth, the size at the leading edge and the angle of
    3 degrees are increased.

    Parameters
    ----------
    stations : arc lengths of the lower end, the nose and the upper end.
    cells : number of cells between the two ends.
    chord : chord length; the curvature is averaged over 0.2 % of it.
    steps : cell sizes at the trailing and at the leading edge.
    exact : for each of the `steps`, whether it is prescribed, to be met within 0.5 %.
    hurried : whether growth may be 1.3 times as fast if cells are too few.
    at_edge : logarithm of the growth ratio next to the trailing edge; values below `GROWTH` have no effect.
    based : whether the ends are the corners of a blunt trailing edge, where cells may grow faster.
    """
    lower, nose, upper = stations
    s = _samples(stations, steps)
    size = TURN / _bend(curve, s, chord)
    hurry = HURRY if hurried else 1.0
    most = RUSH if based and not at_edge else 1.0
    least = _quartic(np.full_like(s, _LONGEST * (upper - lower) / cells)) if based else 0.0

    def wanted(factor: float) -> Floats:
        rush = min(factor, most)
        return least + _known(
            s, size, stations, steps, exact[0], factor / rush, hurry, at_edge or rush * GROWTH
        )

    known = _affordable(cells, s, wanted)
    mend = np.zeros(2)
    away = np.minimum(s - lower, upper - s), np.abs(s - nose)
    for _ in range(12):
        relief = exp(sum(m * exp(-d / (_REACH * step)) for m, d, step in zip(mend, away, steps, strict=True)))
        density = _density(s, known, relief, cells)
        arcs = _placed(s, density, cells)
        width = np.diff(arcs)
        got = 0.5 * (width[0] + width[-1]), width[np.searchsorted(arcs, nose) - 1]
        error = np.where(exact, log(np.array(steps) / np.array(got)), 0.0)
        if np.abs(error).max() < 5e-3:
            break
        mend += error
    return arcs


def distances_by_curvature(curve: Curve, begin: float, way: float, cells: int) -> Floats:
    """Return distances (cells + 1,) along a closed curve from `begin` to nodes spaced by its curvature.

    `way` is the length of the part with nodes; it is negative against the direction of the curve.
    """
    s = np.linspace(0.0, abs(way), 2 * _SAMPLES + 1)
    bend = _bend(curve, begin + np.sign(way) * s, curve.length)
    known = _quartic(limited_sizes(TURN / bend, s, GROWTH))
    return _placed(s, _density(s, known, np.ones_like(s), cells), cells)


def _placed(s: Floats, density: Floats, cells: int) -> Floats:
    """Return cells + 1 arc lengths from the first to the last of s by density."""
    count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))])
    places = monotone_cubic(count * (cells / count[-1]), s, np.arange(cells + 1.0))
    places[0], places[-1] = s[0], s[-1]
    return places


def _samples(stations: tuple[float, float, float], steps: tuple[float, float]) -> Floats:
    """Return arc lengths from the lower to the upper end, dense where the cell sizes are small."""
    lower, nose, upper = stations
    half = 0.5 * (upper - lower)
    te, le = (geomspace(0.1 * step, half, _SAMPLES // 8) for step in steps)
    even = np.linspace(lower, upper, _SAMPLES // 2)
    every = np.concatenate([even, lower + te, upper - te, nose + le, nose - le, [nose]])
    s = np.unique(every[(every >= lower) & (every <= upper)])
    kept = s[np.concatenate([[True], np.diff(s) > 1e-9 * half])]
    kept[-1] = upper
    return kept


def _bend(curve: Curve, s: Floats, chord: float) -> Floats:
    """Return the absolute curvature at arc lengths s, averaged over `_WINDOW`, at least 0.01 per chord."""
    low, high = min(s[0], s[-1]), max(s[0], s[-1])
    t = np.linspace(low, high, 2 * _SAMPLES)
    d = curve.tangent(np.clip(t, low + 1e-9 * (high - low), high - 1e-9 * (high - low)))
    angle = np.unwrap(arctan2(d[:, 1], d[:, 0]))
    before, after = np.maximum(s - _WINDOW * chord, low), np.minimum(s + _WINDOW * chord, high)
    turned = np.abs(np.interp(after, t, angle) - np.interp(before, t, angle))
    return np.asarray(np.maximum(turned / (after - before), 1e-2 / chord))


def _affordable(cells: int, s: Floats, known: Callable[[float], Floats]) -> Floats:
    """Return `known`, the sum of 1/h⁴, with the least factor from 1 on for `cells`."""
    goal, width = math.log(cells), 0.5 * np.diff(s)

    def excess(log_factor: float) -> tuple[float, Floats]:
        terms = known(math.exp(log_factor))
        density = np.sqrt(np.sqrt(terms))
        return math.log(product(width, density[1:] + density[:-1])) - goal, terms

    low, (above, terms) = 0.0, excess(0.0)
    high, (below, at_most) = _SCARCEST, (0.0, terms) if above <= 0 else excess(_SCARCEST)
    if above <= 0 or below >= 0:
        return terms if above <= 0 else at_most
    for _ in range(30):  # Illinois method
        middle = (low * below - high * above) / (below - above)
        value, terms = excess(middle)
        if abs(value) < 1e-3:
            break
        if value > 0:
            low, above, below = middle, value, 0.5 * below
        else:
            high, below, above = middle, value, 0.5 * above
    return terms


def _known(
    s: Floats,
    size: Floats,
    stations: tuple[float, float, float],
    steps: tuple[float, float],
    ramp: bool,
    fewer: float,
    hurry: float,
    at_edge: float,
) -> Floats:
    """Return the sum of 1/h⁴ over both edges and curvature, for which alone the size is `size`.

    `fewer` is the factor on size and leading edge, `hurry` the largest on growth before these are much
    larger. With `ramp`, growth sets in slowly behind the trailing edge, whose grid lines converge.
    """
    lower, nose, upper = stations
    growth = GROWTH * max(min(fewer, hurry), fewer / _SCARCE)
    away = np.minimum(s - lower, upper - s)
    size = fewer * size
    near = away < _EDGE * (upper - lower)
    size[near] = np.maximum(size[near], steps[0])
    size[[0, -1]] = size[[0, -1]].min()  # the two surfaces meet here
    size = limited_sizes(size, s, growth)
    reach = _RAMP * steps[0]
    late = reach * -expm1(-away / reach) if ramp else 0.0
    trailing = steps[0] + max(growth, at_edge) * (away - late)
    leading = fewer * steps[1] + growth * np.abs(s - nose)
    return np.asarray(_quartic(trailing) + _quartic(leading) + _quartic(size))


def _quartic(h: Floats) -> Floats:
    square = h * h
    return np.asarray(1.0 / (square * square))


def _density(s: Floats, known: Floats, relief: Floats, cells: int) -> Floats:
    """Return 1/h with the largest size for which its integral is the number of cells."""
    width, weight = 0.5 * np.diff(s), _quartic(relief)
    share = np.concatenate([width, [0.0]]) + np.concatenate([[0.0], width])
    more = 0.0  # 1/h⁴ of the largest size
    for _ in range(60):
        total = (known + more) * weight
        density = np.sqrt(np.sqrt(total))
        lack = cells - product(share, density)
        if lack < 1e-9 * cells:
            break
        more += lack / product(share, 0.25 * weight * density / total)  # Newton's, which never overshoots
    return np.asarray(density)
