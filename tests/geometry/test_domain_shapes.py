"""Domains out of polygons, airfoils and boundaries: what is one block, what is many, names and corners."""

import numpy as np
import pytest

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.ring import ring_loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.assembly import assembled, domain_of
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.polygon_shape import PolygonRing, polygon_shape
from meshonet.geometry.spacing.sampling import Sampling

SQUARE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]])
STEP = np.array([[0.0, 1.0], [2.0, 1.0], [2.0, 0.0], [6.0, 0.0], [6.0, 2.0], [0.0, 2.0]])


def circle(x: float, y: float, radius: float, n: int = 60) -> Floats:
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)


@pytest.mark.parametrize(
    ("rings", "many", "topology"),
    [
        ([SQUARE], False, "quad"),
        ([STEP], True, "quad"),
        ([circle(0, 0, 1)], True, "o"),
        ([SQUARE, circle(1, 1, 0.3)], True, "o"),
        ([circle(0, 0, 9), circle(0, 0, 1)], False, "o"),
        ([circle(0, 0, 3), circle(0, 1, 1)], True, "o"),
        ([SQUARE, circle(1, 1, 0.3), circle(3, 1, 0.3)], True, None),
    ],
)
def test_what_is_one_block_and_what_many(rings: list[Floats], many: bool, topology: str | None) -> None:
    shape = polygon_shape([PolygonRing(ring) for ring in rings], "here")
    assert shape.many == many
    if topology is None:
        with pytest.raises(InputError, match="a domain with 2 holes is not one block; let infer"):
            shape.boundary(Sampling())
    else:
        assert shape.boundary(Sampling(ni=41, nj=11)).topology == topology


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("hole", [True, False])
def test_corners_and_names_stay_with_their_points_and_stretches(way: int, hole: bool) -> None:
    """The side between two corners has its name whichever way round the ring is given."""
    points = np.concatenate([SQUARE, SQUARE[:1]])[::way]
    names = {(2.0, 0.0): "floor", (4.0, 1.0): "out", (2.0, 2.0): "roof", (0.0, 1.0): "in"}
    middles = [tuple(0.5 * (points[k] + points[k + 1])) for k in range(4)]
    loop = ring_loop(points, hole=hole, corners=[0, 1, 2, 3], names=[names[m] for m in middles])
    assert (polygon_area(loop.curve.points) < 0) == hole
    for middle, name in names.items():
        at = np.linspace(0, loop.length, 240, endpoint=False) + 0.01
        nearest = at[np.argmin(np.hypot(*(loop.at(at) - middle).T))]
        assert loop.name_at(float(nearest)) == name
    assert loop.corner_cells.tolist() == ([3] * 4 if hole else [1] * 4)


def test_points_given_twice_are_one() -> None:
    twice = np.repeat(SQUARE, 2, axis=0)
    loop = ring_loop(np.concatenate([twice, SQUARE[:1]]), hole=False, corners=[1, 2, 5])
    assert loop.corners == (0, 1, 2)


@pytest.mark.parametrize(
    ("points", "more", "message"),
    [
        (SQUARE[:2], {}, "a ring of 2 different points; give at least 3"),
        (SQUARE[[0, 2, 1, 3]], {}, r"crosses itself at \(2, 1\), behind point"),
        (SQUARE, {"corners": [4]}, "corner 4 of a ring of 4 points; use 0 to 3"),
        (SQUARE, {"corners": [1, 1]}, r"corners \[1, 1\] name a point twice"),
        (SQUARE, {"names": ["a", "b"]}, "2 names and 4 corners that were found; give one name, or one for"),
    ],
)
def test_a_ring_that_cannot_be_is_refused(points: Floats, more: dict[str, list[int]], message: str) -> None:
    with pytest.raises(InputError, match=message):
        ring_loop(points, hole=False, **more)  # type: ignore[arg-type]


def test_the_ring_of_an_error_is_named() -> None:
    with pytest.raises(InputError, match="ring 2: the outline crosses itself"):
        polygon_shape([PolygonRing(SQUARE), PolygonRing(0.2 * SQUARE[[0, 2, 1, 3]] + 1)])


def test_bodies_lie_in_a_circle_at_the_far_field_in_chords_of_all() -> None:
    wing, tail = naca("2412"), Outline(circle(2.0, 0.0, 0.1), "tail")
    shape = assembled([wing, tail], ["wing", "tail"], Sampling(far_field=20), "both")
    outer, first, second = shape.domain.loops
    extent = 2.1 - min(0.0, float(wing.curve.points[:, 0].min()))
    assert shape.unit == pytest.approx(extent)
    assert outer.length == pytest.approx(2 * np.pi * 20 * extent, rel=1e-6)
    assert [loop.names for loop in shape.domain.loops] == [("farfield",), ("wing",), ("tail",)]
    assert first.curve is wing.curve, "an airfoil keeps its smooth curve"
    assert first.corner_cells.tolist() == [3, 3], "both corners of the blunt edge"
    assert len(second.corners) == 0
    assert all(polygon_area(loop.curve.points) < 0 for loop in (first, second))


def test_bodies_lie_in_the_loop_that_encloses_them() -> None:
    tunnel = Outline(SQUARE * 3 - 3, "tunnel")
    shape = assembled([naca("0012"), tunnel], ["wing", "tunnel"], Sampling())
    assert [loop.names for loop in shape.domain.loops] == [("tunnel",), ("wing",)]
    assert shape.domain.area == pytest.approx(72 + polygon_area(naca("0012").curve.points))
    with pytest.raises(InputError, match="tunnel encloses the others; leave far_field out"):
        assembled([naca("0012"), tunnel], ["wing", "tunnel"], Sampling(far_field=9))


def test_bodies_within_bodies_are_refused() -> None:
    rings = [Outline(circle(0, 0, radius), "a") for radius in (3, 2, 1)]
    with pytest.raises(InputError, match="lie within"):
        assembled(rings, ["a", "b", "c"], Sampling())


def test_a_boundary_of_four_edges_is_a_domain_with_its_names() -> None:
    edges = Outline(SQUARE, "box").boundary(Sampling(ni=9, nj=5))
    (loop,) = domain_of(edges, Sampling()).domain.loops
    assert loop.names == ("south", "east", "north", "west")
    assert loop.curve.points[list(loop.corners)].tolist() == SQUARE.tolist()
    outside = domain_of(naca("0012").boundary(Sampling(ni=41, nj=9)), Sampling()).domain
    assert [each.names for each in outside.loops] == [("farfield",), ("wall",)]


def test_a_domain_of_four_corners_is_one_block_though_one_of_them_is_blunt() -> None:
    points = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, 1.5], [0.3, 1.0]])  # the last of 142 degrees
    shape = polygon_shape([PolygonRing(points, corners=[0, 1, 2, 3])])
    sides = shape.boundary(Sampling(ni=11, nj=7))
    corners = np.array([sides.south[0], sides.south[-1], sides.north[-1], sides.north[0]])
    assert corners == pytest.approx(points)


@pytest.mark.parametrize("degrees", np.linspace(0.0, 90.0, 7))
@pytest.mark.parametrize(("sides", "cells"), [(8, [2] * 8), (12, []), (3, [1] * 3)])
def test_corners_do_not_depend_on_rounding(sides, cells, degrees):
    angle = np.radians(degrees) + 2.0 * np.pi * np.arange(sides) / sides  # 12 of them turn by 30 degrees each
    polygon = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    assert Loop.of_polygon(polygon).corner_cells.tolist() == cells
    hole = Loop.of_polygon(polygon[::-1])
    assert hole.corner_cells.tolist() == ([2] * 8 if sides == 8 else [] if sides == 12 else [3] * 3)
