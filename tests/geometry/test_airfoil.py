import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sections import STATIONS, farthest, oblique, selig, surfaces

from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.self_intersection import find_crossing
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.closed_curve import closed_curve
from meshonet.geometry.spacing.sampling import Sampling

FORMULA = np.linspace(0, 1, 150) ** 2


@settings(max_examples=25, deadline=None)
@given(
    ratio=st.floats(0.03, 0.4),
    camber=st.floats(-0.02, 0.09),
    base=st.sampled_from([0.0, 1e-4, 3e-4, 2e-3, 0.02, 0.15]),
    coarse=st.booleans(),
    digits=st.integers(4, 8),
    turn=st.floats(-3.1, 3.1),
    size=st.sampled_from([1e-3, 1.0, 250.0]),
)
def test_curve_passes_every_given_point_and_does_not_cross_itself(
    ratio, camber, base, coarse, digits, turn, size
):
    points = selig(ratio, camber, base, STATIONS if coarse else None).round(digits)
    points = size * points @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) + size
    airfoil = Airfoil(points)
    curve = airfoil.curve
    s = np.union1d(np.linspace(0, curve.length, 4001), curve.knots)
    dense = curve.at(s)
    assert farthest(points, dense) < 1e-4 * airfoil.chord
    assert find_crossing(dense[:-1]) is None
    assert airfoil.chord == pytest.approx(size, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.06, 0.12, 0.21])
def test_fits_the_formula_between_the_stations_of_old_reports(ratio):
    """The formula is known between the points; 35 of them should give it to 0.05 % of chord."""
    airfoil = Airfoil(selig(ratio, x=STATIONS))
    curve = airfoil.curve.at(np.linspace(0, airfoil.curve.length, 20_001))
    assert farthest(selig(ratio, x=FORMULA), curve) < 5e-4
    fine = Airfoil(selig(ratio, x=0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 101))))
    assert farthest(selig(ratio, x=FORMULA), fine.curve.at(np.linspace(0, fine.curve.length, 40_001))) < 1e-5


def test_edges_chord_and_gap_of_a_known_section():
    airfoil = Airfoil(selig(0.12, base=0.004))
    assert airfoil.blunt
    assert airfoil.gap == pytest.approx(0.004)
    np.testing.assert_allclose(airfoil.trailing_edge, [1, 0], atol=1e-15)
    np.testing.assert_allclose(airfoil.leading_edge, [0, 0], atol=1e-12)
    assert airfoil.chord == pytest.approx(1)
    assert airfoil.nose_radius == pytest.approx(1.1019 * 0.12**2, rel=0.15)  # the formula's own radius
    slope = 2 * np.degrees(np.arctan(5 * 0.12 * 0.24225 - 0.002))
    assert airfoil.wedge == pytest.approx(slope, abs=0.3)


@pytest.mark.parametrize("shape", [Airfoil, closed_curve], ids=["file", "array"])
@pytest.mark.parametrize("ratio", [0.03, 0.06, 0.12])
def test_wall_nodes_lie_on_an_oblique_base(ratio, shape):
    points = oblique(ratio)
    wall = shape(points, "section").boundary(Sampling(301, 41, "o")).south
    behind = wall[wall[:, 0] > 0.98]
    assert farthest(behind, np.concatenate([points, points[:1]])) < 1e-5


@pytest.mark.parametrize("ratio", [0.03, 0.06])
def test_wall_cells_hardly_jump_at_an_oblique_base_that_counts_as_sharp(ratio: float) -> None:
    points = oblique(ratio)
    section = Airfoil(np.concatenate([points, points[:1]]))
    assert not section.blunt
    wall = section.boundary(Sampling(257, 97, "o", "curvature")).south
    cells = np.log(np.linalg.norm(np.diff(wall, axis=0), axis=1))
    assert np.exp(np.abs(cells - np.roll(cells, 1)).max()) < 1.4


def test_leading_edge_is_the_farthest_place_of_the_curve():
    airfoil = Airfoil(selig(0.15, 0.06))
    dense = airfoil.curve.at(np.linspace(0, airfoil.curve.length, 200_001))
    far = np.hypot(*(dense - airfoil.trailing_edge).T).max()
    assert airfoil.chord == pytest.approx(far, rel=1e-9)


def test_a_symmetric_flat_front_has_its_leading_edge_in_the_middle():
    plate = np.array([[1, 0.01], [0.5, 0.02], [0, 0.02], [0, -0.02], [0.5, -0.02], [1, -0.01]])
    np.testing.assert_allclose(Airfoil(plate).leading_edge, [0, 0], atol=1e-12)


@pytest.mark.parametrize("ni", [50, 101, 200])
@pytest.mark.parametrize("spacing", ["uniform", "cosine", "tanh", "curvature"])
@pytest.mark.parametrize("base", [0.0, 0.004, 0.05])
def test_a_symmetric_section_gets_symmetric_nodes(ni, spacing, base):
    for x in (STATIONS, None):
        wall = Airfoil(selig(0.12, base=base, x=x)).wall(ni, Sampling(spacing=spacing))
        np.testing.assert_allclose(wall, wall[::-1] * [1, -1], atol=1e-12)


def test_wall_nodes_are_points_of_the_curve_bitwise():
    airfoil = Airfoil(selig(0.12, 0.02, 0.003))
    boundary = airfoil.boundary(Sampling(ni=101, nj=11, spacing="tanh"))
    from meshonet.geometry.shapes.airfoil.wall_nodes import wall_arcs

    nodes = boundary.wall.at(wall_arcs(airfoil, 101, Sampling(spacing="tanh")))
    np.testing.assert_array_equal(boundary.south[:-1], nodes[:-1])
    np.testing.assert_array_equal(boundary.south[-1], boundary.south[0])


def test_boundary_is_an_o_of_the_size_asked_for():
    boundary = Airfoil(10 * selig(0.12, 0.02), "ten").boundary(
        Sampling(ni=61, nj=21, far_field=20, spacing="tanh")
    )
    assert (boundary.topology, boundary.ni, boundary.nj, boundary.name) == ("o", 61, 21, "ten")
    assert polygon_area(boundary.south[:-1]) < 0
    centre = boundary.north[:-1].mean(axis=0)
    np.testing.assert_allclose(np.hypot(*(boundary.north - centre).T), 200, rtol=1e-3)


def test_units_and_position_stay_unless_normalised():
    turn = np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])
    airfoil = Airfoil(250 * selig(0.12) @ turn + [7, -3])
    np.testing.assert_allclose(airfoil.leading_edge, [7, -3], atol=1e-9)
    unit = airfoil.normalised()
    np.testing.assert_allclose([*unit.leading_edge, *unit.trailing_edge], [0, 0, 1, 0], atol=1e-12)
    south = airfoil.boundary(Sampling(ni=51, nj=9, normalise=True, spacing="tanh")).south
    np.testing.assert_allclose(south, Airfoil(selig(0.12)).wall(51, Sampling(spacing="tanh")), atol=1e-9)


def test_crossing_surfaces_are_refused_with_the_place_and_the_points():
    points = selig(0.12)
    points[5:8, 1] = [-0.04, -0.05, -0.06]
    body = Airfoil(points, places=[f"line {k + 2}" for k in range(len(points))])
    with pytest.raises(InputError) as caught:
        body.boundary(Sampling(81, 21, "o"))
    wanted = str(caught.value)
    assert "crosses itself at (0.9" in wanted
    assert "between line 6 and line 7" in wanted or "between line 7 and line 6" in wanted
    assert "correct these points" in wanted


def test_surfaces_that_touch_by_rounding_are_still_an_airfoil():
    x = np.linspace(0, 1, 41)
    upper, lower = surfaces(0.12, 0.04, x=x)
    thin = 0.5 * (upper - lower) * (1 - (1 - x[:, None]) ** 2 * 0) * ((1 - x[:, None]) ** 2.5)
    middle = 0.5 * (upper + lower)
    points = np.concatenate([(middle + thin)[::-1], (middle - thin)[1:]]).round(4)
    airfoil = Airfoil(points)
    dense = airfoil.curve.at(np.union1d(np.linspace(0, airfoil.curve.length, 8001), airfoil.curve.knots))
    assert find_crossing(dense[:-1]) is None
    assert farthest(points, dense) < 1e-4


@pytest.mark.parametrize(
    ("sampling", "message"),
    [
        (Sampling(topology="quad"), "topology quad is not made from an airfoil; use o"),
        (Sampling(corners=(0, 1, 2, 3)), "an airfoil has no corners to choose"),
        (Sampling(ni=4), "4 nodes around an airfoil; use at least"),
        (Sampling(spacing="uniform", le_spacing=0.01), "uniform spacing leaves no cell size to choose"),
    ],
)
def test_says_what_an_airfoil_cannot_be(sampling, message):
    with pytest.raises(InputError, match=message):
        Airfoil(selig()).boundary(sampling)


def test_an_airfoil_prints_its_name_chord_and_edge():
    points = selig(0.12, 0.0, 0.002, STATIONS)
    assert repr(Airfoil(points, "a")).startswith("<Airfoil 'a': chord 1")
    assert "blunt trailing edge 0.002" in repr(Airfoil(points, "a"))


@pytest.mark.parametrize("ratio", [0.02, 0.03, 0.04])
def test_an_opened_base_leaves_the_nose_as_it_is(ratio):
    """The place farthest from the trailing edge is next to a given point here, and is no second one."""
    upper, lower = surfaces(ratio, x=np.delete(STATIONS, 1))
    section = Airfoil(np.concatenate([upper[::-1], lower[1:] * [1, 0.12]]))
    opened = section.opened(0.0022)
    assert opened.gap == pytest.approx(0.0022, rel=1e-3)
    assert len(opened.curve.corners) == 2
    wall = opened.boundary(Sampling(301, 11, "o", spacing="curvature")).south
    steps = np.hypot(*np.diff(wall, axis=0).T)
    assert np.maximum(steps[1:] / steps[:-1], steps[:-1] / steps[1:]).max() < 1.2


def test_a_base_that_takes_most_wall_nodes_has_a_note() -> None:
    """Its corners are rounded, so that cells beside them are tiny."""
    upper, _ = surfaces(0.4, base=0.2)
    rounding = [[1.0, 0.1], [0.9997, 0.1005], [0.998, 0.104]]
    upper = np.concatenate([upper[upper[:, 0] < 0.99], rounding[::-1]])
    section = Airfoil(np.concatenate([upper[::-1], (upper * [1, -1])[1:]]))
    crowded = Sampling(129, 65, "o", "curvature", te_spacing=1e-6)
    (note,) = (n for n in section.boundary(crowded).notes if "wall nodes lie on the base" in n)
    spacing = float(re.search(r"use \{te_spacing\} (\S+) or more nodes", note)[1])  # type: ignore[index]
    notes = section.boundary(replace(crowded, te_spacing=spacing)).notes
    assert not [n for n in notes if "wall nodes lie on the base" in n]
    notes = section.boundary(replace(crowded, te_spacing=None, base_nodes=81)).notes
    assert [n for n in notes if n.endswith("use fewer {base_nodes}")]


@pytest.mark.parametrize("name", ["0012-sharp", "4412-sharp", "2412"])
def test_normalised_edges_are_at_0_and_1_for_sharp_and_blunt_sections(name: str) -> None:
    section = naca(name)
    body = section.normalised()
    assert len(body.curve.points) == len(section.curve.points)
    assert body.trailing_edge == pytest.approx([1.0, 0.0], abs=1e-14)
    assert body.leading_edge == pytest.approx([0.0, 0.0], abs=1e-14)
