"""C boundaries: the wake is one line used both ways, leaves along the bisector, and the far field is a C."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from sections import selig

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.connection import wake_nodes
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.airfoil.trailing_edge import REACH
from meshonet.geometry.shapes.wake import wake_line
from meshonet.geometry.spacing.sampling import Sampling

SHARP = Airfoil(selig(0.12))
CAMBERED = Airfoil(selig(0.12, 0.04))
BLUNT = Airfoil(selig(0.12, base=0.004))


def c(airfoil: Airfoil = SHARP, **settings: object) -> Boundary:
    return airfoil.boundary(Sampling(**{"ni": 160, "nj": 40, "topology": "c", **settings}))  # type: ignore[arg-type]


def growth(line: np.ndarray) -> np.ndarray:
    step = np.hypot(*np.diff(line, axis=0).T)
    return np.maximum(step[1:] / step[:-1], step[:-1] / step[1:]) - 1


def span(boundary: Boundary, name: str) -> tuple[int, int]:
    patch = next(patch for patch in boundary.patches if patch.name == name)
    return patch.start, patch.stop


def turn_of_wake(boundary: Boundary) -> float:
    """Return the angle in degrees between the first wake cell and the bisector of the two last wall cells."""
    first, last = span(boundary, "wall")
    edge = boundary.south[first]
    sides = [edge - boundary.south[k] for k in (first + 1, last - 1)]
    bisector = sum(side / np.hypot(*side) for side in sides)
    leaving = boundary.south[first - 1] - edge
    return float(np.degrees(np.arctan2(*bisector[::-1]) - np.arctan2(*leaving[::-1])))


def test_south_is_wake_wall_wake_and_the_wakes_coincide_bitwise() -> None:
    boundary = c()
    first, last = span(boundary, "wall")
    assert (boundary.ni, boundary.nj, boundary.topology) == (160, 40, "c")
    assert first == 159 - last > 10
    np.testing.assert_array_equal(boundary.south[: first + 1], boundary.south[last:][::-1])
    assert wake_nodes(boundary.south) == first + 1
    wall = boundary.south[first : last + 1]
    np.testing.assert_array_equal(wall[[0, -1]], np.tile(SHARP.trailing_edge, (2, 1)))
    assert wall[1, 1] < 0 < wall[-2, 1]
    names = [(patch.name, patch.side) for patch in boundary.patches]
    sides = ("north", "east", "west")
    assert names == [(n, "south") for n in ("wake", "wall", "wake")] + [("farfield", s) for s in sides]


@pytest.mark.parametrize("airfoil", [SHARP, CAMBERED], ids=["symmetric", "cambered"])
def test_the_wake_leaves_along_the_bisector_and_ends_along_x(airfoil: Airfoil) -> None:
    boundary = c(airfoil, ni=600)
    edge = boundary.south[span(boundary, "wall")[0]]
    assert abs(turn_of_wake(boundary)) < 0.1
    ending = boundary.south[0] - boundary.south[1]
    assert abs(ending[1] / ending[0]) < 1e-5
    assert boundary.south[0, 0] == pytest.approx(edge[0] + 15.0, rel=1e-6)


def test_cells_grow_evenly_from_the_wall_into_the_wake() -> None:
    boundary = c(CAMBERED, ni=250)
    assert growth(boundary.south[: span(boundary, "wall")[1] + 1]).max() < 0.16
    assert growth(boundary.north).max() < 0.05


def test_the_far_field_is_half_a_circle_and_two_lines_square_to_the_outlet() -> None:
    boundary = c(far_field=8.0, wake=12.0)
    front = boundary.north[boundary.north[:, 0] <= 0.5]
    np.testing.assert_allclose(np.hypot(front[:, 0] - 0.5, front[:, 1]), 8.0, rtol=1e-12)
    behind = boundary.north[boundary.north[:, 0] > 0.5]
    np.testing.assert_allclose(np.abs(behind[:, 1]), 8.0, rtol=1e-12)
    for side in (boundary.west, boundary.east):
        np.testing.assert_allclose(side[:, 0], 13.0, rtol=1e-12)


def test_length_and_nodes_of_the_wake_are_those_asked_for() -> None:
    boundary = c(wake=30.0, wake_nodes=50)
    assert span(boundary, "wall") == (49, 110)
    assert boundary.south[0, 0] == pytest.approx(31.0, rel=1e-12)


def test_the_growth_of_the_wake_sets_in_slowly_and_stays_nearly_the_same() -> None:
    ratio = growth(c(wake=30.0, wake_nodes=50).south[:50])[::-1]  # from the trailing edge on
    assert ratio[0] < 0.4 * ratio[12]
    assert (np.diff(ratio) > 0).all()
    assert ratio[-1] < 1.1 * ratio[12]
    assert ratio[-1] > 1.03 * ratio[24]  # a little faster at the outlet than in the middle


@pytest.mark.parametrize("droop", [1.0, -1.2])
def test_a_wake_leaves_no_steeper_than_the_axis_can_follow(droop: float) -> None:
    sides = np.array([[np.cos(turn), np.sin(turn)] for turn in (droop - 0.1, droop + 0.1)])
    edge = np.array([1.0, 0.0])
    wall = np.array([edge, edge - sides[0], [-1.0, 0.0], edge - sides[1], edge])
    x, y = (wake_line(wall, np.array([1.0, 0.0]), 1.0, 10.0, 0.1, 40)[1:] - edge).T
    assert np.degrees(np.arctan(y / -np.expm1(-x))) == pytest.approx(np.sign(droop) * 34.0, abs=1e-9)


def test_a_turned_airfoil_keeps_a_level_wake_a_steep_one_follows_its_chord() -> None:
    points = SHARP.curve.points
    for angle, level in ((0.3, True), (1.2, False)):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        boundary = c(Airfoil(points @ turn), ni=300)
        ending = boundary.south[0] - boundary.south[1]
        assert np.arctan2(*ending[::-1]) == pytest.approx(0.0 if level else angle, abs=1e-4)


def test_a_wedge_closes_a_blunt_edge_keeps_its_points_and_is_told() -> None:
    wedge = BLUNT.wedged()
    assert not wedge.blunt
    half = 5 * 0.12 * 0.24225 - 0.002  # the surfaces' slope, by the formula, meets the axis sooner than REACH
    np.testing.assert_allclose(wedge.trailing_edge, [1 + min(REACH, 0.5 / half) * 0.004, 0.0], atol=1e-4)
    original, kept = BLUNT.curve.points[1:], wedge.curve.points
    assert all((kept == point).all(axis=1).any() for point in original)
    assert 10 < wedge.wedge < 20
    assert SHARP.wedged() is SHARP
    boundary = c(BLUNT)
    assert "its base, 0.004 chords wide, is closed by a wedge 0.014 chords long" in boundary.notes[0]
    assert boundary.chord == BLUNT.unit
    assert c(SHARP).notes == ()


def test_auto_is_c_for_thin_cells_at_sharp_edges_only() -> None:
    assert c(topology="auto").topology == "o"
    assert c(topology="auto", viscous=True).topology == "c"
    assert c(BLUNT, topology="auto", viscous=True).topology == "o"
    assert c(BLUNT, topology="auto", viscous=True, te="wedge").topology == "c"
    assert c(BLUNT, topology="auto", viscous=True, te="round").topology == "o"
    t = np.linspace(0.0, 1.0, 40)
    lens = np.concatenate([np.stack([1 - t, t * (1 - t)], 1), np.stack([t, -t * (1 - t)], 1)[1:-1]])
    assert Airfoil(lens).wedge > 50
    assert Airfoil(lens).boundary(Sampling(100, 40, viscous=True)).topology == "o"


def test_resampled_boundaries_keep_wall_wake_and_parts() -> None:
    boundary = c(CAMBERED)
    other = boundary.boundary(Sampling(239, 61))
    first, last = span(other, "wall")
    assert (other.ni, other.nj) == (239, 61)
    np.testing.assert_array_equal(other.south[: first + 1], other.south[last:][::-1])
    np.testing.assert_array_equal(other.south[[0, first]], boundary.south[[0, span(boundary, "wall")[0]]])
    assert [p.stop for p in other.patches if p.side in ("west", "east")] == [60, 60]
    with pytest.raises(InputError, match="4 nodes along a C boundary with a wake; use at least 5"):
        boundary.boundary(Sampling(4, 40))


def test_parts_nobody_named_are_told_by_the_nodes() -> None:
    boundary = c()
    assert replace(boundary, patches=()).patches == boundary.patches


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"te": "exact"},
            "a C grid needs a sharp trailing edge; give first_cell or y_plus, close it with te wedge, or use "
            "topology o",
        ),
        ({"te": "round"}, "a C grid has no rounded trailing edge; leave te out, close it with te wedge"),
        (
            {"ni": 20, "wake_nodes": 9},
            "twice 9 of them on the wake, leave too few for the wall; use at least 21",
        ),
        ({"wake": 0.1}, "wake: 0.1 chords; use 0.5 to 1e6"),
        ({"wake_nodes": 2}, "wake_nodes: 2 nodes; use 3 to 100000"),
        ({"topology": "quad"}, "topology quad is not made from an airfoil; use o or c"),
    ],
)
def test_what_cannot_be_made_is_named(settings: dict[str, object], message: str) -> None:
    with pytest.raises(InputError) as error:
        c(BLUNT, **settings)
    assert message in str(error.value)


def test_normalised_naca_sections_make_c_grids() -> None:
    assert naca("4415").boundary(Sampling(120, 40, "c", normalise=True)).topology == "c"


def test_the_chord_of_a_boundary_from_elsewhere_is_that_of_the_body_not_of_the_wake() -> None:
    boundary = c()
    assert replace(boundary, chord=0.0).chord == pytest.approx(SHARP.chord, rel=1e-3)


@pytest.mark.parametrize("asked", [{"wake": 5.0}, {"wake_nodes": 20}])
def test_a_wake_asked_of_an_o_grid_is_not_ignored(asked: dict[str, Any]) -> None:
    (name,) = asked
    with pytest.raises(InputError, match=f"an O grid has no wake; leave {name} out, or use topology c"):
        naca("0012").boundary(Sampling(ni=60, nj=20, topology="o", **asked))
    with pytest.raises(InputError, match="an O grid has no wake"):
        naca("0012").boundary(Sampling(ni=60, nj=20, viscous=True, **asked))  # blunt: an O by itself


def test_a_wake_of_too_few_nodes_says_what_to_change() -> None:
    with pytest.raises(
        InputError, match=r"2 cells from .* would grow by more than 10 each; use more nodes, wake_nodes"
    ):
        c(wake_nodes=3)


@pytest.mark.parametrize(("ni", "multiple"), [(257, 8), (513, 8), (253, 4), (255, 2)])
def test_the_wake_ends_on_a_node_that_coarsening_keeps(ni: int, multiple: int) -> None:
    first, last = span(c(CAMBERED, ni=ni), "wall")
    assert first % multiple == last % multiple == 0


@pytest.mark.parametrize("ratio", [0.12, 0.2, 0.3])
@pytest.mark.parametrize("base", [2.1e-4, 2.4e-4, 2.8e-4])
def test_a_wedge_finer_than_the_points_of_a_file_closes_the_base(ratio: float, base: float) -> None:
    section = Airfoil(selig(ratio, 0.02, base))
    closed = section.wedged()
    assert not closed.blunt
    assert len(closed.curve.points) > len(section.curve.points)
    boundary = section.boundary(Sampling(301, 11, "c", far_field=50.0, te="wedge"))
    assert growth(boundary.south).max() < 0.15
    assert abs(turn_of_wake(boundary)) < 2.0
