"""Whether the loops of a domain bound a region: none crosses or touches another, and holes are inside."""

import numpy as np

from meshonet.geometry.arrays import Floats, extent_of
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import check_extent, contains, polygon_area
from meshonet.geometry.polygon.self_intersection import Crossing, crossing_of, sweep_spans
from meshonet.kernels._native import crossing_segments

_BUDGET = 2_000_000_000  # comparisons, some seconds; one body needs about as many as it has points
_ROOM = 64  # pairs in addition to those that meet because they are consecutive
_NO_AREA = 1e-14  # a loop narrower than this fraction of its extent counts as without area
_SAME = 1e-13  # points nearer than this fraction of the extent of the domain count as one


def check_domain(domain: Domain) -> None:
    """Raise InputError, with the position, if the polygons of the loops do not bound a region.

    Checks in this order: points are repeated; a loop has no area; a loop crosses or touches itself or another
    loop, or has the wrong orientation; a hole is outside the outer loop or inside another hole. Splines are
    checked as polygons through their points.
    """
    check_extent(domain.extent)
    for number, loop in enumerate(domain.loops):
        _check_points(domain, number, loop)
    crossing = _first_crossing(domain)
    if crossing is not None:
        _raise_crossing(domain, crossing)
    for number, loop in enumerate(domain.loops):
        if (polygon_area(loop.curve.points) > 0) != (number == 0):
            way = "clockwise" if number == 0 else "counter-clockwise"
            raise InputError(f"{describe(domain, number)} runs {way}", "reverse its points")
    _check_nesting(domain)


def describe(domain: Domain, number: int) -> str:
    """Return the index and the names of the loop `number` as text, for messages.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> describe(Domain.of_polygons([square]), 0)
    'loop 0 (outer)'
    """
    return f"loop {number} ({', '.join(dict.fromkeys(domain.loops[number].names))})"


def _place(loop: Loop, point: int) -> str:
    return loop.places[point % len(loop.places)] if loop.places else f"point {point}"


def _at(point: Floats) -> str:
    return f"({point[0]:.6g}, {point[1]:.6g})"


def _check_points(domain: Domain, number: int, loop: Loop) -> None:
    points = loop.curve.points
    step = np.abs(np.roll(points, -1, axis=0) - points).max(axis=1)
    same = np.flatnonzero(step <= _SAME * domain.extent)
    if same.size:
        k = int(same[0])
        what = f"{describe(domain, number)}: {_place(loop, k)} and the next are the same, {_at(points[k])}"
        raise InputError(what, "remove one")
    from_first = points - points[0]
    farthest = from_first[np.abs(from_first).max(axis=1).argmax()]
    width = np.abs(from_first[:, 0] * farthest[1] - from_first[:, 1] * farthest[0]).max()
    if width <= _NO_AREA * extent_of(points) ** 2:
        what = f"{describe(domain, number)} from {_at(points[0])} on is a line, which encloses no area"
        raise InputError(what, "correct its points")


def _first_crossing(domain: Domain) -> Crossing | None:
    """Return the first two segments that meet, numbered through all loops."""
    rings = [np.concatenate([loop.curve.points, loop.curve.points[:1]]) for loop in domain.loops]
    p, last = np.concatenate(rings), np.cumsum([len(ring) for ring in rings]) - 1
    low, top = sweep_spans(p, np.roll(p, -1, axis=0))
    low[last], top[last] = np.inf, -np.inf  # the links between loops meet nothing
    pairs, _ = crossing_segments(p, np.argsort(low, kind="stable"), low, top, _ROOM + len(rings), _BUDGET)
    first = {int(end) - 1: int(end) - len(ring) + 1 for end, ring in zip(last, rings, strict=True)}
    real = [(i, j) for i, j in pairs if first.get(j) != i or _turns_back(p[j], p[i], p[i + 1])]
    if not real:
        return None
    i, j = min(real)
    return crossing_of(p, np.roll(p, -1, axis=0), i, j)


def _turns_back(a: Floats, b: Floats, c: Floats) -> bool:
    u, v = b - a, c - b
    return bool(u[0] * v[1] == u[1] * v[0] and product(u, v) < 0)


def _raise_crossing(domain: Domain, crossing: Crossing) -> None:
    starts = np.cumsum([0] + [len(loop.curve.points) + 1 for loop in domain.loops])
    segments = np.array([crossing.first, crossing.second])
    one, two = (int(n) for n in np.searchsorted(starts, segments, side="right") - 1)
    first, second = (int(k) for k in segments - starts[[one, two]])
    where = np.array([crossing.x, crossing.y])
    ends = [
        domain.loops[n].curve.points[(k + i) % len(domain.loops[n].curve.points)]
        for n, k in ((one, first), (two, second))
        for i in (0, 1)
    ]
    touches = min(np.abs(end - where).max() for end in ends) <= _SAME * domain.extent
    behind = f"behind {_place(domain.loops[one], first)}"
    after = f"behind {_place(domain.loops[two], second)}"
    if one == two:
        verb = "touches" if touches else "crosses"
        problem = f"{describe(domain, one)} {verb} itself at {_at(where)}, {behind} and {after}"
        raise InputError(problem, "correct these points or their order")
    verb = "touch" if touches else "cross"
    problem = f"{describe(domain, one)} and {describe(domain, two)} {verb} at {_at(where)}"
    details = f"{behind} of the one and {after} of the other"
    raise InputError(f"{problem}, {details}", "move them apart, or join them to one loop")


def _check_nesting(domain: Domain) -> None:
    """Raise InputError for a loop whose first point is on the wrong side of another loop."""
    starts = np.array([loop.curve.points[0] for loop in domain.loops])
    for number, loop in enumerate(domain.loops):
        inside = contains(loop.curve.points, starts)
        inside[number] = number == 0
        wrong = np.flatnonzero(~inside if number == 0 else inside)
        if wrong.size:
            hole = f"{describe(domain, int(wrong[0]))} at {_at(starts[wrong[0]])}"
            if number == 0:
                remedy = "give the outer loop first, and no body outside of it"
                raise InputError(f"{hole} lies outside of {describe(domain, 0)}", remedy)
            remedy = "leave one of them out, or make two domains"
            raise InputError(f"{hole} lies inside of {describe(domain, number)}", remedy)
