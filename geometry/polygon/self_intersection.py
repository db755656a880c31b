"""Self-intersections of polygons."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import starmap
from operator import itemgetter

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.kernels._native import crossing_segments

_BUDGET = 50_000_000  # comparisons, a quarter of a second, before an index tree replaces the sweep
_SWEEP = np.array([0.846, 0.533])
"""Direction along which segments are sorted; oblique, since straight sides normal to it would overlap."""
_ROUNDING = 1e-15  # relative, of products with it
_CHUNK = 256  # segments queried at a time, so that the crossings of a tangle do not fill the memory


@dataclass(frozen=True)
class Crossing:
    """Two segments that meet: their indices (segment k starts at point k), and a point on both."""

    first: int
    second: int
    x: float
    y: float


def find_crossing(points: Floats) -> Crossing | None:
    """Return the first crossing or contact of a polygon (n, 2) with itself, or None if it is simple.

    >>> find_crossing(np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]))
    Crossing(first=0, second=2, x=0.5, y=0.5)
    """
    return min(find_crossings(points), key=lambda c: (c.first, c.second), default=None)


def check_outline(points: Floats, places: Sequence[str] = ()) -> None:
    """Raise InputError if a closed polygon (n, 2) crosses itself; `places` locates its points in a file."""
    crossing = find_crossing(points)
    if crossing is not None:
        first, second = (
            places[k % len(points)] if places else f"point {k}" for k in (crossing.first, crossing.second)
        )
        raise InputError(
            f"the outline crosses itself at ({crossing.x:.6g}, {crossing.y:.6g}), "
            f"behind {first} and behind {second}",
            "correct these points or their order",
        )


def find_crossings(points: Floats, *, closed: bool = True, limit: int = 64) -> list[Crossing]:
    """Return up to `limit` crossings or contacts of segments of a polygon (n, 2), except between neighbours.

    A segment that runs back along its neighbour is also reported. A closed polygon does not repeat its first
    point. Only segments whose projections on an oblique line overlap are compared; with too many such
    pairs, shapely compares them.
    """
    p = np.ascontiguousarray(points, dtype=np.float64)
    end = np.roll(p, -1, axis=0) if closed else p[1:]
    low, top = sweep_spans(p, end)
    pairs, complete = crossing_segments(p, np.argsort(low, kind="stable"), low, top, limit, _BUDGET)
    if not complete:
        pairs = _pairs_by_tree(p, end, closed, limit)
    return list(starmap(partial(crossing_of, p, end), pairs))


def sweep_spans(p: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Return the lower and the upper ends (m,) of segments projected onto a line of direction `_SWEEP`.

    Segments go from `p` to `end`, (m, 2) each. Upper ends are rounded upwards.
    """
    along, along_end = product(p[: len(end)], _SWEEP), product(end, _SWEEP)
    low, top = np.minimum(along, along_end), np.maximum(along, along_end)
    top += _ROUNDING * max(np.abs(along).max(initial=0.0), np.abs(along_end).max(initial=0.0))
    return low, top


def _pairs_by_tree(p: Floats, end: Floats, closed: bool, limit: int) -> list[tuple[int, int]]:
    import shapely

    segments = shapely.linestrings(np.stack([p[: len(end)], end], axis=1))
    tree = shapely.STRtree(segments)
    pairs: list[tuple[int, int]] = []
    for start in range(0, len(segments), _CHUNK):
        first, second = tree.query(segments[start : start + _CHUNK], predicate="intersects")
        first = first + start
        apart = second - first
        real = (apart > 1) & ~(closed & (apart == len(segments) - 1))
        pairs += zip(first[real].tolist(), second[real].tolist(), strict=True)
        if len(pairs) >= limit:
            break
    return pairs[:limit]


def crossing_of(p: Floats, end: Floats, i: int, j: int) -> Crossing:
    """Return a common point of the segments `i` and `j`, which cross, touch or overlap.

    Segments run from `p` (m, 2) to `end` (m, 2).
    """
    a, b, c, d = p[i], end[i], p[j], end[j]
    r, s, w = b - a, d - c, c - a
    across = r[0] * s[1] - r[1] * s[0]
    if abs(across) > 1e-12 * np.hypot(*r) * np.hypot(*s):
        t = min(max((w[0] * s[1] - w[1] * s[0]) / across, 0.0), 1.0)
        x, y = a + t * r
    else:
        along = r / product(r, r)
        inside = sorted(
            [(0.0, a), (1.0, b), (float(product(w, along)), c), (float(product(d - a, along)), d)],
            key=itemgetter(0),
        )
        x, y = inside[1][1]
    return Crossing(i, j, float(x), float(y))
