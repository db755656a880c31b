from itertools import pairwise

import numpy as np
import pytest
import shapely

from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.laws import LAWS
from meshonet.geometry.spacing.sampling import Sampling

SQUARE = np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]])
T = np.linspace(0, 2 * np.pi, 80, endpoint=False)
CIRCLE = np.stack([3 + np.cos(T), np.sin(T)], axis=1)
L_SHAPE = np.array([[0.0, 0], [2, 0], [2, 0.4], [1, 0.4], [1, 1], [0, 1]])
WAVY = np.array([[x, 0.1 * np.sin(5 * x)] for x in np.linspace(0, 2, 31)] + [[2, 1.0], [0, 1.0]])


@pytest.mark.parametrize("turned", [0, 1, 2, 3])
@pytest.mark.parametrize("way", [1, -1])
def test_the_lowest_edge_is_south_from_any_start_and_either_way(turned, way):
    b = Outline(np.roll(SQUARE, turned, axis=0)[::way]).boundary(Sampling(ni=21, nj=11))
    assert b.topology == "quad"
    corners = [b.south[0], b.south[-1], b.north[-1], b.north[0]]
    np.testing.assert_array_equal(corners, SQUARE)


@pytest.mark.parametrize("spacing", [law for law in LAWS if law != "conformal"])
def test_every_corner_of_the_outline_is_a_node(spacing):
    b = Outline(L_SHAPE).boundary(Sampling(ni=33, nj=24, spacing=spacing))
    outline = b.outline()
    for corner in L_SHAPE:
        assert (outline == corner).all(axis=1).any()
    assert shapely.Polygon(outline).equals_exact(shapely.Polygon(outline), 0)
    assert shapely.Polygon(outline).area == pytest.approx(1.4)


def test_a_side_of_few_points_between_bends_is_straight():
    ramp = np.array([[0.0, 0], [4, 0], [8, -1], [12, -1], [12, 1], [0, 1]])
    b = Outline(ramp, corners=(0, 3, 4, 5)).boundary(Sampling(ni=121, nj=9))
    assert shapely.Polygon(b.outline()).area == pytest.approx(shapely.Polygon(ramp).area, rel=1e-12)


ARC = np.linspace(0.0, np.pi / 2, 25)
MIDDLES = ((30, 10), (-30, 10), (-30, -10), (30, -10))
ROUNDED = np.concatenate([
    np.array(middle) + 10 * np.stack([np.cos(ARC + k * np.pi / 2), np.sin(ARC + k * np.pi / 2)], axis=1)
    for k, middle in enumerate(MIDDLES)
])  # fmt: skip
VENTURI = np.array([[0, 25], [100, 25], [167.4, 12.5], [192.4, 12.5], [287.3, 25], [437.3, 25]])


def curve_of(outline: Outline) -> np.ndarray:
    return outline.curve.polyline(np.linspace(0, 1, 16, endpoint=False))


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("start", [0, 13, 24, 25])
def test_lines_between_rounded_corners_are_straight_and_tangent_to_them(way, start):
    outline = Outline(np.roll(ROUNDED, start, axis=0)[::way])
    for curve in (outline.curve, outline.clockwise()):
        drawn = curve.polyline(np.linspace(0, 1, 16, endpoint=False))
        np.testing.assert_allclose(np.abs(drawn).max(axis=0), [40, 20], atol=3e-6)
        away = np.hypot(*np.maximum(np.abs(drawn) - [30, 10], 0.0).T)
        np.testing.assert_allclose(away, 10, atol=1e-5)  # the distance from a box inside
        ways = [curve.tangent(curve.knots + side * 1e-9 * curve.length) for side in (-1, 1)]
        np.testing.assert_allclose(ways[0], ways[1], atol=1e-6)


def test_a_long_chord_of_a_curve_stays_curved():
    turn = np.concatenate([np.linspace(0, 2, 40), [2.3], np.linspace(2.6, 6.2, 60)])
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    np.testing.assert_allclose(np.hypot(*curve_of(Outline(circle)).T), 1.0, atol=2e-4)


@pytest.mark.parametrize("spaced", [None, 2.5])
def test_a_wall_of_straight_parts_keeps_their_kinks(spaced):
    x = VENTURI[:, 0]
    if spaced:
        parts = [np.arange(a, b - spaced / 2, spaced) for a, b in pairwise(x)]
        x = np.append(np.concatenate(parts), x[-1])
    wall = np.stack([x, np.interp(x, *VENTURI.T)], axis=1)
    ring = np.concatenate([[[0, 0], [437.3, 0]], wall[::-1]])
    drawn = curve_of(Outline(ring, corners=(0, 1, 2, len(ring) - 1)))
    upper = drawn[(drawn[:, 1] > 12) & (drawn[:, 0] > 0) & (drawn[:, 0] < 437.3)]
    np.testing.assert_allclose(upper[:, 1], np.interp(upper[:, 0], *VENTURI.T), atol=1e-9)


def test_a_wall_of_few_points_that_turns_slowly_is_smooth():
    x = np.linspace(0, 2, 10)
    ring = np.concatenate([[[2, 1], [0, 1]], np.stack([x, 0.1 * np.cos(np.pi * x)], axis=1)])
    outline = Outline(ring, corners=(2, len(ring) - 1, 0, 1))
    assert outline.curve.corner_index.tolist() == [0, 1, 2, len(ring) - 1]


def test_asked_corners_start_at_the_south_west_one_and_go_on_counter_clockwise():
    for points, corners in ((SQUARE, (1, 2, 3, 0)), (SQUARE, (1, 0, 3, 2)), (SQUARE[::-1], (2, 1, 0, 3))):
        b = Outline(points).boundary(Sampling(ni=9, nj=9, corners=corners))
        np.testing.assert_array_equal(
            [b.south[0], b.south[-1], b.north[-1], b.north[0]], SQUARE[[1, 2, 3, 0]]
        )


def test_a_smooth_side_is_followed():
    b = Outline(WAVY).boundary(Sampling(ni=61, nj=11))
    np.testing.assert_allclose(b.south[:, 1], 0.1 * np.sin(5 * b.south[:, 0]), atol=2e-3)


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("start", [0, 13, 50])
def test_a_body_without_corners_is_surrounded(way, start):
    outline = Outline(np.roll(CIRCLE, start, axis=0)[::way], "disc")
    assert outline.topology == "o"
    b = outline.boundary(Sampling(ni=41, nj=11, far_field=10))
    np.testing.assert_allclose(b.south[0], [4, 0], atol=1e-12)
    assert polygon_area(b.south[:-1]) < 0
    np.testing.assert_allclose(np.hypot(*(b.north - [3, 0]).T), 20, rtol=1e-9)
    np.testing.assert_array_equal(b.wall.at(np.zeros(1))[0], b.south[0])
    assert polygon_area(b.wall.points) < 0
    assert b.name == "disc"


@pytest.mark.parametrize("start", [0, 1, 2, 3])
def test_a_square_body_starts_in_the_middle_of_its_right_side(start):
    for points in (SQUARE, SQUARE[::-1]):
        b = Outline(np.roll(points, start, axis=0)).boundary(Sampling(ni=41, nj=5, topology="o"))
        np.testing.assert_allclose(b.south[0], [2, 0.5], atol=1e-12)
        for corner in SQUARE:
            assert np.hypot(*(b.south - corner).T).min() < 1e-12


def test_a_smooth_body_gets_finer_cells_where_it_turns():
    b = Outline(np.stack([2 * np.cos(T), 0.5 * np.sin(T)], axis=1)).boundary(Sampling(ni=61, nj=9))
    steps = np.hypot(*np.diff(b.south, axis=0).T)
    assert steps[0] < 0.5 * steps[15]
    np.testing.assert_allclose(steps, steps[::-1], rtol=1e-9)


def test_a_round_outline_can_be_a_quad_all_the_same():
    b = Outline(CIRCLE).boundary(Sampling(ni=21, nj=21, topology="quad"))
    np.testing.assert_allclose(
        b.south[[0, -1]], [[3 - 0.5**0.5, -(0.5**0.5)], [3 + 0.5**0.5, -(0.5**0.5)]], atol=1e-12
    )


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (
            [[0, 0], [1, 1], [1, 0], [0, 1]],
            r"crosses itself at \(0.5, 0.5\), behind point 0 and behind point 2",
        ),
        ([[0, 0], [1, 0]], "give at least 3"),
        ([[0, 0], [1, 0], [1, 0], [1, 1]], "the same"),
        ([[0, 0], [1e-200, 0], [0, 1e-200]], "extent"),
    ],
)
def test_refuses_what_is_no_outline(points, message):
    with pytest.raises(InputError, match=message):
        Outline(np.array(points, dtype=float))


@pytest.mark.parametrize(
    ("sampling", "message"),
    [
        (Sampling(topology="c"), "needs the trailing edge of an airfoil"),
        (Sampling(te_spacing=0.01), "te_spacing needs an airfoil"),
        (Sampling(normalise=True), "normalise needs an airfoil"),
        (Sampling(spacing="conformal"), "conformal spacing needs a body"),
        (Sampling(corners=(0, 1, 2, 9)), "corner 9 of 4 points does not exist; use 0 to 3"),
        (Sampling(corners=(0, 2, 1, 3)), "are not in order along the outline"),
    ],
)
def test_says_what_an_outline_cannot_be(sampling, message):
    with pytest.raises(InputError, match=message):
        Outline(SQUARE).boundary(sampling)


@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_points_on_a_line_have_no_area(slope):
    x = np.array([0.0, 1.0, 2.0, 3.0])
    with pytest.raises(
        InputError, match="the outline has no area; give the points around a domain or a body"
    ):
        Outline(np.stack([x, slope * x], axis=1))
