import numpy as np
import pytest
from sections import STATIONS, selig, surfaces

from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.shapes.airfoil.clean import clean_section

SHARP, BLUNT = selig(0.12, 0.03), selig(0.12, 0.03, base=0.01)


def started_at(points: np.ndarray, k: int) -> np.ndarray:
    ring = points[:-1]
    ring = np.roll(ring, -k, axis=0)
    return np.concatenate([ring, ring[:1]])


def test_runs_clockwise_from_the_trailing_edge():
    section = clean_section(SHARP)
    assert not section.blunt
    assert polygon_area(section.points) < 0
    np.testing.assert_array_equal(section.points[0], [1, 0])
    assert section.points[1, 1] < section.points[-1, 1]


@pytest.mark.parametrize("points", [SHARP, BLUNT], ids=["sharp", "blunt"])
def test_either_way_round_gives_the_same_section(points):
    np.testing.assert_array_equal(clean_section(points).points, clean_section(points[::-1]).points)


@pytest.mark.parametrize("k", [0, 7, 30, 60, 61, 75, 100, 119])
def test_any_start_finds_the_same_trailing_edge(k):
    section = clean_section(started_at(SHARP, k))
    np.testing.assert_array_equal(section.points[0], [1, 0])
    assert len(section.points) == 120


def test_a_blunt_section_that_starts_at_the_nose_keeps_its_base():
    upper, lower = surfaces(0.12, 0.03, base=0.01)
    section = clean_section(np.concatenate([upper, lower[::-1]]))
    assert section.blunt
    np.testing.assert_allclose(section.points[[0, -1]], [[1, -0.005], [1, 0.005]])


def test_index_says_which_given_point_each_is():
    section = clean_section(BLUNT)
    np.testing.assert_array_equal(BLUNT[section.index], section.points)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ([], []),
        ([[1, 0]], [[1, 0]]),
        ([], [[1, 0.005]]),
        ([], [[1, 0]]),
        ([[1, -0.002], [1, 0.002]], []),
        ([[1, -0.005]], []),
    ],
    ids=[
        "open",
        "closed in the middle",
        "closed at a corner",
        "one side",
        "on the base",
        "first is the other corner",
    ],
)
def test_points_on_the_base_do_not_hide_its_corners(before, after):
    points = np.concatenate([np.array(before).reshape(-1, 2), BLUNT, np.array(after).reshape(-1, 2)])
    section = clean_section(points)
    assert section.blunt
    assert section.gap == pytest.approx(0.01)
    np.testing.assert_allclose(section.points[[0, -1]], [[1, -0.005], [1, 0.005]])


def test_a_gap_too_small_to_matter_is_closed_at_its_middle():
    section = clean_section(selig(0.12, base=1.9e-4))
    assert not section.blunt
    assert section.gap == pytest.approx(1.9e-4)
    np.testing.assert_allclose(section.points[0], [1, 0], atol=1e-12)
    assert clean_section(selig(0.12, base=2.1e-4)).blunt


def test_a_slanted_base_is_a_base():
    points = BLUNT.copy()
    points[-1] = [0.99, -0.0065]
    section = clean_section(points)
    assert section.blunt
    np.testing.assert_array_equal(section.points[0], [0.99, -0.0065])


def test_a_surface_that_stops_short_is_joined_to_the_edge_of_the_other():
    points = np.delete(SHARP, -1, axis=0)
    section = clean_section(points)
    assert not section.blunt
    np.testing.assert_array_equal(section.points[0], [1, 0])


def test_a_rounded_trailing_edge_has_no_corner():
    t = np.linspace(0, 2 * np.pi, 81)
    ellipse = np.stack([0.5 + 0.5 * np.cos(t), 0.1 * np.sin(t)], axis=1)
    section = clean_section(ellipse)
    assert not section.blunt
    assert section.corners.size == 0
    np.testing.assert_allclose(section.points[0], [1, 0], atol=1e-15)


def test_repeated_points_are_dropped_and_near_ones_count_as_repeated():
    points = np.repeat(SHARP, 2, axis=0)
    points[1::2] += 1e-7
    np.testing.assert_allclose(clean_section(points).points, clean_section(SHARP).points, atol=2e-7)


def test_neighbours_in_the_wrong_order_are_swapped():
    points = SHARP.copy()
    points[[20, 21]] = points[[21, 20]]
    np.testing.assert_array_equal(clean_section(points).points, clean_section(SHARP).points)


def test_a_sharp_nose_is_a_corner_and_a_coarse_round_one_is_not():
    x = np.linspace(0, 1, 21)
    lens = np.concatenate(
        [np.stack([x, 0.2 * x * (1 - x)], 1)[::-1], np.stack([x, -0.2 * x * (1 - x)], 1)[1:]]
    )
    assert clean_section(lens).corners.tolist() == [0, 20]
    assert clean_section(selig(0.05, x=STATIONS)).corners.tolist() == [0]


def test_a_flap_kink_is_a_corner():
    points = selig(0.12)
    flapped = points[:, 0] > 0.75
    points[flapped, 1] -= 0.3 * (points[flapped, 0] - 0.75)
    section = clean_section(points)
    kinks = section.points[section.corners[1:]]
    assert len(kinks) == 2
    np.testing.assert_allclose(kinks[:, 0], 0.75, atol=0.03)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.zeros((9, 2)), "no extent"),
        (SHARP * 1e200, "extent of"),
        (np.array([[1.0, 0], [0.5, 0.1], [1, 0]]), "2 distinct points; an airfoil needs at least 4"),
        (np.stack([np.linspace(1, 0, 20), np.zeros(20)], axis=1), "enclose no area"),
        (surfaces(0.12)[0], "first and the last point lie .* chords apart; give both surfaces"),
    ],
)
def test_refuses_what_is_no_section(points, message):
    with pytest.raises(InputError, match=message):
        clean_section(points)


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("start", [0, 1])
@pytest.mark.parametrize("base", [0.01, 2.2e-4, 0.2])
def test_points_of_a_curve_that_begins_in_the_middle_of_its_base_give_the_same_section(
    base: float, start: int, way: int
) -> None:
    """Its ends are the middle and a corner: half a base apart, which alone may look like a sharp edge."""
    section = clean_section(selig(0.3, 0.03, base=base))
    ring = np.concatenate([[0.5 * (section.points[0] + section.points[-1])], section.points])
    again = clean_section(np.roll(ring, -start, axis=0)[::way])
    assert again.blunt
    assert again.gap == pytest.approx(base)
    np.testing.assert_array_equal(again.points, section.points)


def test_a_base_with_rounded_corners_is_kept_if_the_points_begin_in_its_middle() -> None:
    """No corner turns by more than 35 degrees, but half the base is much longer than the pieces beside it."""
    upper, lower = surfaces(0.4, base=0.2)
    rounding = [[1.0, 0.1], [0.9997, 0.1005], [0.998, 0.104]]
    upper = np.concatenate([upper[upper[:, 0] < 0.99], rounding[::-1]])
    lower = upper * [1, -1]
    section = clean_section(np.concatenate([[[1.0, 0.0]], lower[::-1], upper[1:]]))
    assert section.blunt
    assert section.gap == pytest.approx(0.2)
