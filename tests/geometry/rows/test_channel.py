"""Channels between hub and casing: heights, gaps, and the conformal coordinate along surfaces."""

import blade_row
import numpy as np
import pytest

from meshonet.geometry.errors import InputError
from meshonet.geometry.rows.channel import Channel

LINE = np.linspace(0.0, 1.0, 21)


def cone(low: float, high: float) -> np.ndarray:
    return np.stack([2.0 * LINE, low + (high - low) * LINE], axis=1)


def test_places_are_the_inverse_of_positions_also_beyond_hub_and_casing() -> None:
    channel = Channel(blade_row.HUB, blade_row.SHROUD, 0.01, 0.03)
    rng = np.random.default_rng(1)
    s, h = rng.uniform(0.02, 0.98, 200), rng.uniform(0.0, 1.0, 200)
    result = channel.places(channel.at(s, h))
    assert result[0] == pytest.approx(s, abs=1e-12)
    assert result[1] == pytest.approx(h, abs=1e-12)
    assert channel.places(np.array([[0.0, 1.9]]))[1] < 0.0
    assert channel.places(np.array([[0.0, 3.1]]))[1] > 1.0


def test_places_in_space_are_those_of_the_meridional_plane_turned_about_the_axis() -> None:
    channel = Channel(blade_row.HUB, blade_row.SHROUD, 0.01, 0.03)
    s, theta, h = values = np.random.default_rng(2).uniform(-0.2, 1.2, (3, 5, 77))
    x, r = np.moveaxis(channel.at(s, h), -1, 0)
    space = channel.in_space(np.stack(values, axis=-1))
    np.testing.assert_allclose(space, np.stack([x, r * np.sin(theta), r * np.cos(theta)], -1), atol=1e-14)


def test_columns_on_the_blade_begin_there_with_exact_first_cells_and_keep_their_ends() -> None:
    channel = Channel(blade_row.HUB, blade_row.SHROUD, 0.01, 0.03)
    rng = np.random.default_rng(3)
    start, way = rng.uniform(0.3, 0.6, (4, 31, 1, 3)), rng.uniform(0.5, 1.0, (4, 31, 1, 3))
    before = start + np.linspace(0.0, 0.05, 9)[:, None] ** 1.5 * way
    wall, columns = before[:, :, 0, :2] + rng.uniform(-1e-4, 1e-4, (4, 31, 2)), before.copy()
    channel.put_on_blade(columns, wall, 2e-3)
    np.testing.assert_allclose(
        columns[:, :, 0], np.concatenate([wall, before[:, :, 0, 2:]], axis=-1), rtol=1e-15
    )
    space = channel.in_space(columns)
    np.testing.assert_allclose(np.linalg.norm(space[:, :, 1] - space[:, :, 0], axis=-1), 2e-3, rtol=1e-9)
    assert (columns[:, :, -1] == before[:, :, -1]).all()
    assert (np.diff(columns[..., 2], axis=2) > 0.0).all()


def test_nodes_are_stored_at_their_numbers() -> None:
    channel = Channel(blade_row.HUB, blade_row.SHROUD)
    values, ids = np.random.default_rng(4).uniform(0.0, 1.0, (3, 70, 3)), 2 * np.arange(70)[::-1]
    space = np.zeros((3, 140, 3))
    channel.store(values, ids, space)
    assert (space[:, ids] == channel.in_space(values)).all()
    assert (space[:, 1::2] == 0.0).all()
    with pytest.raises(ValueError, match="out of range"):
        channel.store(values, ids + 2, space)


def test_gaps_are_as_wide_everywhere_measured_at_right_angles_to_the_wall() -> None:
    channel = Channel(cone(1.0, 1.3), cone(2.0, 1.6), 0.02, 0.05)
    s = np.linspace(0.1, 0.9, 50)
    slopes = (("foot", channel.foot, cone(1.0, 1.3), 0.02), ("tip", channel.tip, cone(2.0, 1.6), 0.05))
    for _, height, wall, gap in slopes:
        (x, r), (dx, dr) = channel.at(s, np.full(50, height)).T, wall[-1] - wall[0]
        away = np.abs((x - wall[0, 0]) * dr - (r - wall[0, 1]) * dx) / np.hypot(dx, dr)
        assert away == pytest.approx(gap, rel=1e-12)


def test_the_coordinate_of_a_cone_is_the_logarithm_of_its_radius() -> None:
    channel = Channel(cone(1.0, 2.0), cone(1.5, 3.0))
    to = channel.meridional(0.0)
    s = np.linspace(0.0, 1.0, 11)
    slant = np.hypot(2.0, 1.0)  # dm = slant dr
    assert to.forward(s) == pytest.approx(slant * np.log(1.0 + s), abs=1e-9)
    assert to.back(to.forward(s)) == pytest.approx(s, abs=1e-9)


@pytest.mark.parametrize(
    ("hub", "casing", "gap", "words"),
    [
        (cone(1.0, 1.0), cone(2.0, 2.0), 0.6, "gaps of 0.6 in a channel 1 wide; use less than half"),
        (cone(2.0, 2.0), cone(1.0, 1.0), 0.0, "the hub is outside, at r = 2 to 2, the shroud at 1 to 1"),
        (cone(1.0, 1.0)[::-1], cone(2.0, 2.0)[::-1], 0.0, "hub and shroud run from outlet to inlet, or"),
        (cone(1.0, 1.0), cone(2.0, 2.0)[::-1], 0.0, "shroud: runs from outlet to inlet"),
        (cone(1.0, 2.0), cone(2.0, 1.0), 0.0, "hub and casing cross or turn back near x = 2"),
        (cone(0.1, -0.1), cone(2.0, 2.0), 0.0, "the hub reaches the axis"),
    ],
)
def test_what_is_no_channel_is_refused(hub: np.ndarray, casing: np.ndarray, gap: float, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Channel(hub, casing, 0.0, gap)
