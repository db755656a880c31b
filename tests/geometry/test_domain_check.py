"""Loops that do not bound a region are refused with the place; all others pass."""

import time

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.check import check_domain
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError


def circle(x, y, r, n=120):
    t = np.arange(n) * 2 * np.pi / n
    return np.c_[x + r * np.cos(t), y + r * np.sin(t)]


def box(left, right, bottom, top):
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]], dtype=float)


def polygon(*points):
    return np.array(points, dtype=float)


OUTER = box(0, 9, 0, 9)
REFUSED = {
    "crossing loops": (
        [box(0, 4, 0, 4), box(3, 5, 1, 2)],
        r"loop 0 \(outer\) and loop 1 \(body\) cross at \(4, [12]\), behind point 1 of the one",
    ),
    "bow tie": (
        [polygon((0, 0), (1, 1), (1, 0), (0, 1))],
        r"crosses itself at \(0\.5, 0\.5\), behind point 0",
    ),
    "figure of eight": (
        [polygon((0, 0), (2, 2), (2, 0), (0, 2.1))],
        r"loop 0 \(outer\) crosses itself at \(1\.02439, 1\.02439\), behind point 0 and behind point 2",
    ),
    "hole on the edge": ([box(0, 4, 0, 4), box(2, 4, 1, 2)], r"touch at \(4, [12]\)"),
    "hole that touches with a corner": (
        [box(0, 4, 0, 4), polygon((4, 2), (3, 2.5), (3, 1.5))],
        r"touch at \(4, 2\)",
    ),
    "holes that share a point": (
        [OUTER, box(1, 2, 1, 2), box(2, 3, 2, 3)],
        r"loop 1 \(body\) and loop 2 \(body2\) touch at \(2, 2\)",
    ),
    "the same hole twice": ([OUTER, box(1, 5, 1, 5), box(1, 5, 1, 5)], "loop 1 .* and loop 2 .* touch"),
    "hole outside": ([box(0, 4, 0, 4), box(5, 6, 1, 2)], r"loop 1 \(body\) at \(5, .* outside of loop 0"),
    "outer loop given second": ([box(2, 3, 2, 3), OUTER], "outside of loop 0 .*give the outer loop first"),
    "hole in a hole": ([OUTER, box(1, 5, 1, 5), box(2, 3, 2, 3)], r"loop 2 \(body2\) .* inside of loop 1"),
    "hole around a hole": ([OUTER, box(2, 3, 2, 3), box(1, 5, 1, 5)], r"loop 1 \(body\) .* inside of loop 2"),
    "a loop that touches itself": (
        [polygon((0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 1))],
        r"touches itself at \(1, 1\)",
    ),
    "a spike": ([polygon((0, 0), (2, 0), (3, 0), (2, 0), (2, 2), (0, 2))], r"touches itself at \(2, 0\)"),
    "a spike at the first point": ([polygon((3, 0), (2, 0), (2, 2), (0, 2), (0, 0))], "touches itself"),
    "a line": ([polygon((0, 0), (1, 0), (2, 0))], "is a line, which encloses no area"),
    "a repeated point": (
        [polygon((0, 0), (1, 0), (1, 1e-15), (1, 1), (0, 1))],
        r"loop 0 \(outer\): point 1 and the next are the same, \(1, 0\); remove one",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.parametrize("scale", [1.0, 1e-9, 1e9])
def test_refused_with_the_place(name, scale):
    polygons, message = REFUSED[name]
    if name == "a spike at the first point":
        polygons = [np.insert(polygons[0], 5, [2.0, 0.0], axis=0)]
    with pytest.raises(InputError) as error:
        check_domain(Domain.of_polygons([p * scale for p in polygons]))
    assert "\n" not in str(error.value)
    if scale == 1.0:
        assert error.match(message)


@pytest.mark.parametrize(
    "polygons",
    [
        [OUTER],
        [OUTER, box(1, 5, 1, 5), box(6, 7, 2, 3)],
        [OUTER, box(1, 2, 1, 2), box(2 + 1e-6, 3, 1, 2)],
        [polygon((0, 0), (2, 0), (2, 0.03))],
        [polygon((0, 0), (4, 0), (4, 4), (3, 4), (3, 1), (1, 1), (1, 4), (0, 4)), box(0.2, 0.5, 3, 3.5)],
    ],
    ids=["box", "holes", "hairline gap", "needle", "hole in the arm of a U"],
)
def test_what_bounds_a_region_passes(polygons):
    check_domain(Domain.of_polygons(polygons))


def test_a_loop_the_wrong_way_round_is_refused():
    loop = Loop(Curve(OUTER[::-1], closed=True, corners=(), straight=np.ones(4, dtype=bool)))
    with pytest.raises(InputError, match=r"loop 0 \(outer\) runs clockwise; reverse"):
        check_domain(Domain((loop,)))


def test_lines_of_the_source_are_named():
    points = polygon((0, 0), (2, 2), (2, 0), (0, 2.1))
    curve = Curve(points, closed=True, corners=(), straight=np.ones(4, dtype=bool))
    loop = Loop(curve, places=("line 3", "line 4", "line 5", "line 6"))
    with pytest.raises(InputError, match="behind line 3 and behind line 5"):
        check_domain(Domain((loop,)))


def test_many_points_and_many_holes_take_no_time():
    teeth = (1 + 0.02 * (-1.0) ** np.arange(10_000))[:, None] * circle(0, 0, 1, 10_000)
    holes = [circle(0.5 + i, 0.5 + j, 0.3, 250) for i in range(8) for j in range(5)]
    for polygons in ([circle(0, 0, 1, 10_000)], [teeth], [box(0, 8, 0, 5), *holes]):
        domain = Domain.of_polygons(polygons)
        start = time.perf_counter()
        check_domain(domain)
        assert time.perf_counter() - start < 1.0


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(
    outer=st.lists(st.tuples(st.integers(0, 12), st.integers(0, 12)), min_size=3, max_size=7, unique=True),
    hole=st.lists(st.tuples(st.integers(0, 12), st.integers(0, 12)), min_size=3, max_size=4, unique=True),
)
def test_the_same_verdict_as_of_shapely(outer, hole):
    """A region's closed boundary is a valid polygon of which the hole touches nothing."""
    shell, inner = shapely.Polygon(outer), shapely.Polygon(hole)
    fine = (
        shell.is_valid
        and inner.is_valid
        and shell.contains(inner)
        and shell.exterior.disjoint(inner.exterior)
        and shell.area > 0
        and inner.area > 0
    )
    try:
        check_domain(Domain.of_polygons([np.array(outer, dtype=float), np.array(hole, dtype=float)]))
        assert fine
    except InputError:
        assert not fine
