"""Profiles: each threshold decides where it should."""

import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.quality.figures import Figures
from meshonet.geometry.quality.gates import beyond
from meshonet.geometry.quality.measure import measure
from meshonet.geometry.quality.profiles import (
    PROFILES,
    CheckResult,
    ProfileReport,
    profile_report,
)


def oblique(slope: float, stretch: float = 1.0) -> Grid:
    x, y = np.meshgrid(np.arange(5.0), stretch * np.arange(4.0), indexing="ij")
    return Grid.from_nodes(np.stack([x + slope * y / stretch, y], axis=-1))


def judged(grid: Grid, profile: str, *walls: Patch) -> ProfileReport:
    return profile_report(Figures(grid, measure(grid), walls), profile)


def verdicts(judgement: ProfileReport) -> dict[str, str]:
    return {checked.check.figure: checked.verdict for checked in judgement.results}


def result(judgement: ProfileReport, figure: str) -> CheckResult:
    return next(checked for checked in judgement.results if checked.check.figure == figure)


@pytest.mark.parametrize("profile", PROFILES)
def test_squares_pass_and_folds_fail(profile: str) -> None:
    square = judged(oblique(0), profile, Patch("wall", "south", 0, 4))
    assert square.passed
    assert "fail" not in verdicts(square).values()
    folded = judged(Grid.from_nodes(oblique(0).nodes[::-1]), profile, Patch("wall", "south", 0, 4))
    assert not folded.passed
    assert result(folded, "folded").value == 12


def ladder(first: float, second: float) -> Grid:
    y = np.array([0.0, first, first + second, first + 2 * second])
    x, y = np.meshgrid(np.arange(5.0), y, indexing="ij")
    return Grid.from_nodes(np.stack([x, y], axis=-1))


@pytest.mark.parametrize(
    ("profile", "grid", "figure", "value", "verdict"),
    [
        ("openfoam", oblique(2.7), "non_orthogonality", 69.7, "pass"),
        ("openfoam", oblique(2.8), "non_orthogonality", 70.3, "warn"),
        ("openfoam", oblique(0, 1001), "box_ratio", 1001, "warn"),
        ("openfoam", oblique(0, 1000), "box_ratio", 1000, "pass"),
        ("openfoam", oblique(3.9), "face_skewness", 3.9, "pass"),
        ("openfoam", oblique(4.1), "face_skewness", 4.1, "fail"),
        ("pointwise", oblique(3.0), "skewness", 0.795, "pass"),
        ("pointwise", oblique(3.2), "skewness", 0.807, "warn"),
        ("pointwise", oblique(6.5), "skewness", 0.903, "fail"),
        ("verdict", oblique(3.1), "scaled_jacobian", 0.307, "pass"),
        ("verdict", oblique(3.3), "scaled_jacobian", 0.29, "fail"),
        ("verdict", oblique(0.99), "max_angle", 134.7, "pass"),
        ("verdict", oblique(1.01), "max_angle", 135.3, "warn"),
        ("verdict", oblique(1.01), "min_angle", 44.7, "warn"),
        ("viscous", ladder(1, 1.24), "wall_growth", 1.24, "pass"),
        ("viscous", ladder(1, 1.26), "wall_growth", 1.26, "fail"),
        ("viscous", ladder(1, 1.26), "equal_wall_cells", 1, "warn"),
        ("viscous", ladder(1, 1.001), "equal_wall_cells", 3, "pass"),
        ("viscous", oblique(3.2), "min_angle", 17.35, "warn"),
        ("viscous", oblique(3.0), "min_angle", 18.4, "pass"),
    ],
)  # fmt: skip
def test_thresholds(profile: str, grid: Grid, figure: str, value: float, verdict: str) -> None:
    checked = result(judged(grid, profile, Patch("floor", "south", 0, 4)), figure)
    assert checked.value == pytest.approx(value, rel=2e-3)
    assert checked.verdict == verdict


def test_the_far_field_is_counted_in_chords() -> None:
    turn = np.linspace(0, -2 * np.pi, 61)[:, None]
    for chords, verdict in ((99.0, "warn"), (101.0, "pass")):
        radius = np.array([[0.5, 1.0, chords]]) * 2
        nodes = np.stack([7 + radius * np.cos(turn), 3 + radius * np.sin(turn)], axis=-1)
        nodes[-1] = nodes[0]
        checked = result(
            judged(Grid.from_nodes(nodes, "o"), "viscous", Patch("wall", "south", 0, 60)), "far_field"
        )
        assert checked.value == pytest.approx(chords, rel=1e-2)
        assert checked.verdict == verdict


def test_what_a_grid_does_not_have_is_not_judged() -> None:
    message = verdicts(judged(oblique(0), "viscous"))
    assert (message["wall_growth"], message["equal_wall_cells"], message["far_field"]) == (
        "none",
        "none",
        "none",
    )
    assert judged(oblique(0), "viscous").passed


def test_growth_is_taken_away_from_the_wall() -> None:
    floor, side = Patch("wall", "south", 0, 4), Patch("wall", "west", 0, 3)
    grid = ladder(1, 1.5)
    assert result(judged(grid, "viscous", floor), "wall_growth").value == pytest.approx(1.5)
    assert result(judged(grid, "viscous", side), "wall_growth").value == pytest.approx(1.0)
    assert result(judged(grid, "viscous", side, floor), "wall_growth").value == pytest.approx(1.5)


def test_what_is_no_number_breaks_every_limit() -> None:
    assert beyond(float("nan"), "<", 0.3)
    assert beyond(float("nan"), ">", 4)
    assert not beyond(4.0, ">", 4)


def test_places_have_the_centre_of_their_cell() -> None:
    grid = oblique(0.5)
    place = result(judged(grid, "verdict"), "max_angle")
    assert place.at is not None
    i, j = place.at
    assert place.centre == pytest.approx(grid.nodes[i : i + 2, j : j + 2].mean(axis=(0, 1)))
    assert result(judged(grid, "verdict"), "folded").centre is None
