"""Edges of profiles that end in a point are opened and rounded."""

import blade_row
import numpy as np
import pytest

import meshonet
from meshonet.geometry.notes import Change
from meshonet.geometry.rows.profile import BladeProfile
from meshonet.geometry.rows.row import Row
from meshonet.geometry.rows.thick_edge import pointed, thick_edged


def lens(radius: float, base: float = 0.0, *, forward: bool = False) -> np.ndarray:
    """Points around half an ellipse and a straight tail that ends in a `base`, on a cylinder.

    The tail is in front if `forward`.
    """
    x = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 80)))
    half = np.where(x < 0.3, 0.04 * np.sqrt(np.clip(1.0 - (x / 0.3 - 1.0) ** 2, 0.0, None)), 0.04)
    half = np.where(x < 0.3, half, 0.04 + (0.5 * base - 0.04) * (x - 0.3) / 0.7)
    ring = np.concatenate([np.stack([x, half], axis=1)[::-1], np.stack([x, -half], axis=1)[1:]])
    ring = ring if base else ring[:-1]
    a, b = ring.T if not forward else (1.0 - ring).T
    angle = (a * 0.5 + b * 0.866) / radius
    return np.stack([0.866 * a - 0.5 * b, radius * np.sin(angle), radius * np.cos(angle)], axis=1)


@pytest.fixture
def channel():
    return blade_row.blade_row().channel


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("forward", [False, True])
def test_a_point_becomes_one_percent_thick_and_round(channel, turned: bool, forward: bool) -> None:
    points = lens(2.5, forward=forward)
    given = BladeProfile(points[::-1] if turned else np.roll(points, 50, axis=0), channel)
    made = thick_edged(given, not forward)
    assert given.corner_counts == ((1, 0) if forward else (0, 1))
    assert made.corner_counts == (0, 0)
    lead, trail = given.curve.at(np.array([given.leading, given.trailing]))
    begin = given.leading
    if forward:
        lead, trail, begin = trail, lead, given.trailing
    chord = trail - lead
    size = np.hypot(*chord)
    frame = np.array([chord, [-chord[1], chord[0]]]) / size**2
    around = np.linspace(0.0, 1.0, 4001) + 0.5 * forward
    x, y = frame @ (made.curve.at(made.arcs(np.mod(around, 1.0))) - lead).T
    upper = np.interp(0.98, x[:1980], y[:1980])
    lower = np.interp(0.98, x[:2020:-1], y[:2020:-1])
    assert upper - lower == pytest.approx(0.98 * 0.01 + 0.02 * 0.08 / 0.7, abs=3e-4)  # and the wedge
    assert x.max() == pytest.approx(1.005, abs=1e-3)
    front = np.linspace(0.0, 0.1, 50)
    arcs = front * size
    same = made.trailing if forward else made.leading
    off = made.curve.at(np.mod(same + arcs * made.curve.length, made.curve.length)) - given.curve.at(
        np.mod(begin + arcs * given.curve.length, given.curve.length)
    )
    assert np.abs(off).max() < 2e-3 * size


def test_bases_and_round_edges_stay(channel) -> None:
    for points in (lens(2.5, 0.02), lens(2.5, 0.004), blade_row.profiles()[1]):
        profile = BladeProfile(points, channel)
        assert not pointed(profile, True)
        assert not pointed(profile, False)


@pytest.mark.parametrize(("name", "forward"), [("trailing", False), ("leading", True)])
def test_a_row_of_sharp_profiles_is_made_with_a_note(name: str, forward: bool) -> None:
    profiles = [lens(radius, forward=forward) for radius in (1.95, 2.5, 3.02)]
    row = Row(profiles, blade_row.HUB, blade_row.SHROUD, blade_row.BLADES)
    (note,) = row.changes
    assert isinstance(note, Change)
    assert f"{name} edges of 3 of 3 profiles, which are points, are opened to 0.01 chords" in note
    grid = meshonet.stack(row, cells=20_000, first_cell=5e-4, growth=1.5)
    assert grid.quality()["scaled_jacobian"].min > 0.2
    reverse = Row(profiles[::-1], blade_row.HUB, blade_row.SHROUD, blade_row.BLADES)
    assert len(reverse.changes) == 2
