"""Rounded trailing edges: the rest of the outline stays, nothing sticks out, no corner is left."""

import numpy as np
import pytest
import shapely

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import per_cell
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.hyperbolic.march import hyperbolic


def dense(curve: Curve) -> np.ndarray:
    return curve.at(np.linspace(0.0, curve.length, 20001)[:-1])


@pytest.fixture(params=["0012", "4415", "23018"])
def airfoil(request: pytest.FixtureRequest) -> Airfoil:
    return naca(request.param)


@pytest.mark.slow
def test_only_the_base_is_changed_and_from_inside(airfoil: Airfoil) -> None:
    original, made = (dense(body.curve) for body in (airfoil, airfoil.rounded()))
    outline = shapely.Polygon(original)
    assert outline.buffer(1e-3 * airfoil.gap).covers(shapely.Polygon(made))
    assert 0 < outline.area - shapely.Polygon(made).area < airfoil.gap**2
    made = made[::10]
    off = shapely.distance(outline.exterior, shapely.points(made))
    distance = np.hypot(*(made - airfoil.trailing_edge).T)
    assert off[distance > 2 * airfoil.gap].max() < 1e-6
    assert off.max() > 0.05 * airfoil.gap


def test_no_corner_is_left(airfoil: Airfoil) -> None:
    curve = airfoil.rounded().curve
    tangent = curve.tangent(np.linspace(0.0, curve.length, 200_001))
    turn = np.abs(
        np.cross(np.c_[tangent[:-1], 0 * tangent[1:, 0]], np.c_[tangent[1:], 0 * tangent[1:, 0]])[:, 2]
    )
    assert turn.max() < 0.1  # radians in 1e-5 of the way round; a corner turns by 1.4
    assert airfoil.rounded().rounded().curve is curve or not airfoil.rounded().blunt


def test_a_symmetric_section_stays_so() -> None:
    wall = naca("0012").boundary(Sampling(151, 40, spacing="curvature", te="round")).south
    np.testing.assert_allclose(wall, wall[::-1] * [1, -1], atol=1e-9)


def test_a_sharp_edge_is_left_alone() -> None:
    x = np.linspace(0, np.pi, 40)
    lens = np.r_[np.c_[np.cos(x), 0.1 * np.sin(x) ** 2], np.c_[-np.cos(x), -0.1 * np.sin(x) ** 2][1:-1]]
    body = Airfoil(0.5 + 0.5 * lens)
    assert body.rounded() is body


def test_marched_grids_are_nearly_orthogonal_round_the_edge(airfoil: Airfoil) -> None:
    def worst(te: str) -> float:
        boundary = airfoil.boundary(Sampling(250, 100, spacing="curvature", te=te))  # type: ignore[arg-type]
        grid = hyperbolic(boundary, wall_spacing=1e-5).grid
        np.testing.assert_array_equal(grid.nodes[:, 0], boundary.south)
        return max(per_cell(grid, "max_angle").max() - 90, 90 - per_cell(grid, "min_angle").min())

    assert worst("exact") > 35
    assert worst("round") < 11


def test_what_has_no_trailing_edge_or_no_such_law_is_refused() -> None:
    with pytest.raises(InputError, match="te needs an airfoil; leave te out, or write"):
        Outline(np.eye(3)[:, :2]).boundary(Sampling(20, 20, topology="o", te="round"))
    with pytest.raises(InputError, match="trailing edge 'blade' is not known; use auto/exact/round/wedge"):
        Sampling(te="blade")  # type: ignore[arg-type]


def test_nodes_of_a_rounded_base_share_its_turning_and_sizes_change_slowly() -> None:
    """By length alone one cell turns by 16 degrees, which is the worst angle of the grid twice over."""
    wall = naca("0012").boundary(Sampling(250, 20, "o", "curvature", te="round")).south
    step = np.diff(np.vstack([wall, wall[1:3]]), axis=0)
    way = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    assert np.degrees(np.abs(np.diff(way))).max() < 12.5
    size = np.hypot(*step.T)
    assert np.abs(np.log(size[1:] / size[:-1])).max() < np.log(1.12)


def test_a_slanted_base_has_more_cells_where_it_turns_more() -> None:
    points = naca("0012").curve.points[1:].copy()  # from the lower corner of the base to the upper
    points[-1] += [0.002, -0.0003]
    wall = Airfoil(points).boundary(Sampling(250, 20, "o", "curvature", te="round")).south
    step = np.diff(wall, axis=0)
    way = np.degrees(np.abs(np.diff(np.unwrap(np.arctan2(step[:, 1], step[:, 0])))))
    assert way[-30:].sum() > way[:30].sum() + 50.0
    assert way.max() < 20.0
    size = np.hypot(*np.diff(np.vstack([wall[-40:-1], wall[:40]]), axis=0).T)
    assert np.abs(np.log(size[1:] / size[:-1])).max() < np.log(1.15)
