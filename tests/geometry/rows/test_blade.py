"""Blades through profiles: edges, directions, order."""

import re

import blade_row
import numpy as np
import pytest
import radial_rows
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Change
from meshonet.geometry.rows.blade import clustered
from meshonet.geometry.rows.row import Row


def section(profiles) -> np.ndarray:
    row = Row(profiles, blade_row.HUB, blade_row.SHROUD, blade_row.BLADES)
    return row.surface.section(0.4, clustered(60))


def test_direction_start_and_a_repeated_point_of_a_profile_do_not_matter() -> None:
    profiles = list(blade_row.profiles())
    changed = [
        np.roll(profiles[0], 17, axis=0),
        profiles[1][::-1],
        np.concatenate([profiles[2], profiles[2][:1]]),
        profiles[3],
    ]
    assert section(changed) == pytest.approx(section(profiles), abs=1e-6)


def test_a_section_starts_at_the_leading_edge_on_the_side_of_larger_theta() -> None:
    s, theta = section(blade_row.profiles()).T
    assert s.argmin() in (59, 0, 1)
    assert s.argmax() in (29, 30, 31)
    assert theta[1:30].mean() > theta[31:].mean()


def test_a_profile_is_met_at_its_height() -> None:
    row = blade_row.blade_row()
    points = blade_row.profiles()[1]
    r = np.hypot(points[:, 1], points[:, 2])
    s, h = row.channel.places(np.stack([points[:, 0], r], axis=1))
    u = np.linspace(0.0, 1.0, 4001)
    lines = row.surface.lines(u)(row.surface.knots[1:2])[0]
    theta = np.arctan2(points[:, 1], points[:, 2])
    away = np.hypot(lines[:, 0] - s[:, None], lines[:, 1] - theta[:, None])
    assert away.min(axis=1).max() < 5e-4  # half the distance of the samples
    assert lines[:, 2].min() == pytest.approx(h.min(), abs=1e-5)


def test_sections_are_where_splines_through_profiles_reach_a_height_and_straight_beyond() -> None:
    surface = blade_row.blade_row().surface
    u, knots = np.linspace(0.02, 0.97, 23), surface.knots
    values = np.stack([profile.at(u) for profile in surface.profiles])
    heights = np.array([knots[0] - 0.02, *np.linspace(knots[0], knots[-1], 7), knots[-1] + 0.02])
    sections = surface.at(u, np.repeat(heights[:, None], len(u), axis=1))
    for column, lines in enumerate(values.swapaxes(0, 1)):
        spline = CubicSpline(knots, lines, bc_type="not-a-knot")
        met = [crossing(spline, height) for height in heights]
        assert sections[:, column] == pytest.approx(np.array(met), abs=1e-12)


def crossing(spline: CubicSpline, height: float) -> np.ndarray:
    """Return s, theta where a line (s, theta, h), straight beyond its knots, has a height."""

    def line(place: float) -> np.ndarray:
        inside = np.clip(place, spline.x[0], spline.x[-1])
        return spline(inside) + (place - inside) * spline(inside, 1)

    return line(brentq(lambda place: line(place)[2] - height, height - 0.1, height + 0.1, xtol=1e-15))[:2]


@pytest.mark.parametrize(
    ("profiles", "words"),
    [
        (
            [blade_row.profiles()[k] for k in (0, 2, 1, 3)],
            "profile 3: is at .* % of the span, .*; give profiles from hub to casing",
        ),
        ([p[:80] for p in blade_row.profiles()], "profile 1: is open between its first and its last point"),
        ([p * [1, 0, 1] for p in blade_row.profiles()], "profile 1: encloses no area"),
        (
            [np.concatenate([p[:40], p[40:80][::-1], p[80:]]) for p in blade_row.profiles()],
            "profile 1: crosses itself near",
        ),
        (
            [p * [1, -1, -1] if k == 2 else p for k, p in enumerate(blade_row.profiles())],
            "profile 3: lies 179.* degrees around the axis",
        ),
        (
            [p * (0.75 + 0.5 * p[:, :1]) if k == 1 else p for k, p in enumerate(blade_row.profiles())],
            "profile 2: crosses the one before|profile 3: crosses the one before",
        ),
        (blade_row.profiles()[2:], "profile 1: begins at 7.* % of the span"),
        (
            blade_row.profiles()[:2],
            "profile 2: ends at .* % of the span; give a profile nearer to the casing",
        ),
        ([p[:5] for p in blade_row.profiles()], "profile 1: 5 points; give 12 or more"),
        (
            [p + np.array([2.0, 0.0, 0.0]) for p in blade_row.profiles()],
            "profile 1: hub and casing end before the blade",
        ),
        (
            [p - np.array([1.2, 0.0, 0.0]) for p in blade_row.profiles()],
            "profile 1: hub and casing begin behind the blade",
        ),
    ],
)
def test_profiles_that_make_no_blade_are_refused_by_number(profiles, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Row(profiles, blade_row.HUB, blade_row.SHROUD, blade_row.BLADES)


def test_profiles_from_casing_to_hub_are_reversed_with_a_note() -> None:
    profiles = blade_row.profiles()
    row = Row(profiles[::-1], blade_row.HUB, blade_row.SHROUD, blade_row.BLADES)
    assert row.changes == ("profiles are given from casing to hub and are taken the other way round",)
    assert np.array_equal(section(profiles[::-1]), section(profiles))
    with pytest.raises(InputError, match="profile 2: begins at 7"):
        Row(profiles[:1:-1], blade_row.HUB, blade_row.SHROUD, blade_row.BLADES)


def row_of(profiles) -> Row:
    return Row(profiles, blade_row.HUB, blade_row.SHROUD, blade_row.BLADES)


PITCH = 360.0 / blade_row.BLADES


@pytest.mark.parametrize(
    "pitches", [(0, 0, 1, 0), (0, -2, 0, 0), (0, 0, 0, 1), (1, 0, 0, 0), (0, 0, 1, 1), (3, 0, 0, 0)]
)
def test_profiles_of_the_next_blades_are_turned_back_with_a_note(pitches) -> None:
    profiles = blade_row.profiles()
    row = row_of([blade_row.turned(p, k * PITCH) for p, k in zip(profiles, pitches, strict=True)])
    u = np.linspace(0.05, 0.95, 30)
    s, theta = (row.surface.section(0.4, u) - row_of(profiles).surface.section(0.4, u)).T
    assert s == pytest.approx(np.zeros(30), abs=1e-12)
    assert np.ptp(theta) < 1e-12  # but for whole pitches of all
    moved = {k for k in range(4) if pitches[k] != sorted(pitches)[1]}
    assert len(row.changes) == len(moved)
    for note, k in zip(row.changes, sorted(moved), strict=True):
        assert isinstance(note, Change)
        angle = -(pitches[k] - sorted(pitches)[1]) * PITCH
        assert f"profile {k + 1} is turned by {angle:.6g} degrees, whole pitches" in note


@pytest.mark.parametrize("lean", [(0, 12, 24, 33), (0, 5, 16, 30), (0, -16, -32, -45)])
def test_a_blade_may_lean_by_more_than_a_pitch(lean) -> None:
    row = row_of([blade_row.turned(p, angle) for p, angle in zip(blade_row.profiles(), lean, strict=True)])
    assert row.changes == ()
    at = [row.surface.section(row.surface.knots[k], np.full(1, 0.25))[0, 1] for k in (0, 3)]
    plain = row_of(blade_row.profiles()).surface
    upright = [plain.section(plain.knots[k], np.full(1, 0.25))[0, 1] for k in (0, 3)]
    assert np.degrees(np.diff(at) - np.diff(upright)) == pytest.approx(lean[3], abs=0.2)


@pytest.mark.parametrize(("kept", "words"), [(slice(0, 3), r"1\d % .*casing"), (slice(0, 4), "")])
def test_a_blade_that_is_continued_is_noted(kept: slice, words: str) -> None:
    shroud = blade_row.SHROUD - [0.0, 0.15]
    row = Row(blade_row.profiles()[kept], blade_row.HUB, shroud, blade_row.BLADES)
    assert len(row.changes) == bool(words)
    for note in row.changes:
        assert re.fullmatch(f"the blade ends {words} or its gap, and is continued straight to it", note)


def test_what_edges_are_is_said() -> None:
    assert row_of(blade_row.profiles()).surface.edges == "leading edge round; trailing edge round"
    few = row_of([p[::8] for p in blade_row.profiles()]).surface.edges
    assert re.fullmatch(
        r"leading edge round, by one point .* by 1\d\d degrees.*; trailing edge round, .*", few
    )
    blunt = row_of([np.concatenate([p[4:-3], p[-3:-3]]) for p in blade_row.profiles()]).surface.edges
    assert blunt == "leading edge round; trailing edge blunt"


def test_blades_that_touch_are_refused() -> None:
    with pytest.raises(InputError, match=r"profile 1: is 2.49\d degrees thick, and blades are 1.8 apart"):
        Row(blade_row.profiles(), blade_row.HUB, blade_row.SHROUD, 200)


def test_points_that_repeat_each_other_do_not_matter() -> None:
    twice = [np.repeat(p, 2, axis=0) for p in blade_row.profiles()]
    assert np.array_equal(section(twice), section(blade_row.profiles()))


def test_a_row_may_be_given_as_lists() -> None:
    lists = [p.tolist() for p in blade_row.profiles()]
    row = Row(lists, blade_row.HUB.tolist(), blade_row.SHROUD.tolist(), np.int64(23), np.float32(0.0))
    u = np.linspace(0.0, 1.0, 9)
    assert np.array_equal(row.surface.section(0.5, u), blade_row.blade_row().surface.section(0.5, u))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"profiles": [p[:, :2] for p in blade_row.profiles()]}, r"profile 1: no points of shape \(160, 2\)"),
        ({"profiles": [p * np.nan for p in blade_row.profiles()]}, "profile 1: points that are not finite"),
        ({"profiles": blade_row.profiles()[0]}, r"profile 1: no points of shape \(3,\)"),
        ({"profiles": [["a"]] * 3}, "profile 1: no points"),
        ({"hub": [1, 2, 3]}, r"hub: no points of shape \(3,\); give numbers \(n, 2\)"),
        ({"shroud": blade_row.HUB + np.inf}, "shroud: points that are not finite"),
        ({"blades": 2.5}, "blades: 2.5 blades; use a whole number"),
        ({"blades": "23"}, "blades: 23 blades; use a whole number"),
        ({"tip_gap": np.nan}, "tip_gap: nan is no width of a gap"),
        ({"hub_gap": "1 %"}, "hub_gap: '1 %' is no width of a gap; use a number"),
    ],
)
def test_what_is_no_row_in_python_is_refused(change, words: str) -> None:
    given = {"profiles": blade_row.profiles(), "hub": blade_row.HUB, "shroud": blade_row.SHROUD, "blades": 23}
    with pytest.raises(InputError, match=words):
        Row(**(given | change))


@pytest.mark.parametrize("seed", [1, 9, 13, 21, 29])
def test_corners_of_an_oblique_base_are_at_the_same_places_along_the_span(seed: int) -> None:
    """Of some profiles of these rows one corner of the base or none stands out from the points around it."""
    row = radial_rows.turbine(seed)
    assert len(row.surface.corners) == 2
    for number, points in enumerate(row.profiles):
        s, theta, h = row.surface.lines(row.surface.corners)(row.surface.knots[number : number + 1])[0].T
        x, r = row.channel.at(s, h).T
        made = np.stack([x, r * np.sin(theta), r * np.cos(theta)], axis=1)
        away = np.linalg.norm(made[:, None] - points, axis=-1)
        assert away.min(axis=1).max() < 1e-7 * row.chord
        assert abs(np.diff(away.argmin(axis=1))[0]) == 1  # the base is one straight step
