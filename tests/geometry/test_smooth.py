"""Sections whose coordinates ripple are named, and smoothed within a tolerance, their corners kept."""

from typing import Any

import numpy as np
import pytest

import meshonet
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import changes_in
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.airfoil.section_curve import RIPPLES, sign_changes
from meshonet.geometry.spacing.sampling import Sampling

O_GRID = Sampling(161, 41, "o")


def rounded(digits: int, designation: str = "0012") -> Airfoil:
    """A section from coordinates of so many digits."""
    body = naca(designation)
    points = body.curve.points[1:] if body.blunt else body.curve.points
    every = points[:: max(len(points) // 160, 1)]
    return Airfoil(np.concatenate([every.round(digits), points[-1:].round(digits)]), "rounded")


@pytest.mark.parametrize("designation", ["0012", "2412", "23012", "4415-sharp"])
def test_what_does_not_ripple_is_not_said_to(designation: str) -> None:
    assert not any("ripples" in note for note in naca(designation).boundary(O_GRID).notes)


def test_rounded_coordinates_are_said_to_ripple() -> None:
    body = rounded(4)
    count = sign_changes(body.curve, body.chord)
    assert count > 10
    note = f"the outline ripples: its curvature changes sign {count} times; see {{smooth}}"
    assert note in body.boundary(O_GRID).notes


@pytest.mark.parametrize("tolerance", [1e-4, 5e-4])
@pytest.mark.parametrize("designation", ["0012", "2412", "23012"])
def test_a_smoothed_section_is_near_and_keeps_its_corners(designation: str, tolerance: float) -> None:
    body = rounded(4, designation)
    after = body.smoothed(tolerance)
    moved = np.hypot(*(after.curve.points - body.curve.points).T)
    assert 0.0 < moved.max() <= tolerance * body.chord
    corners = body.curve.corner_index
    np.testing.assert_array_equal(after.curve.corner_index, corners)
    np.testing.assert_array_equal(after.curve.points[corners], body.curve.points[corners])
    assert sign_changes(after.curve, after.chord) < 0.5 * sign_changes(body.curve, body.chord)
    true = naca(designation)
    assert after.nose_radius == pytest.approx(true.nose_radius, rel=0.05)
    (change,) = changes_in(after.notes)
    assert "smoothed by up to" in change


def test_grids_are_made_of_the_smoothed_section() -> None:
    plain, smooth = (rounded(4).boundary(Sampling(161, 41, "o", smooth=s)) for s in (None, 1e-4))
    assert 0.0 < np.abs(plain.south - smooth.south).max() < 1e-2  # nodes move along the wall too
    assert any("smoothed by up to" in note for note in smooth.notes)


def noisy(designation: str, noise: float, seed: int, n: int = 201) -> tuple[Airfoil, Airfoil]:
    """A section with normally distributed noise, and the section it comes from."""
    true = naca(designation)
    every = true.curve.points[1 if true.blunt else 0 :]
    points = every[np.linspace(0, len(every) - 1, n).round().astype(int)]
    points = points if true.blunt else np.concatenate([points[:-1], points[:1]])
    return Airfoil(points + np.random.default_rng(seed).normal(0.0, noise, points.shape)), true


def distance(body: Airfoil, true: Airfoil) -> float:
    """Root mean square of the distances in chords of a curve from another."""
    off = body.curve.polyline(np.array([0.0, 0.5]))[:, None] - true.curve.polyline(np.arange(32) / 32)
    return float(np.sqrt((off**2).sum(axis=-1).min(axis=1).mean()))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("designation", ["0012-sharp", "2408-sharp", "4415", "0006-sharp"])
def test_noise_is_removed_with_three_times_its_standard_deviation(designation: str, seed: int) -> None:
    body, true = noisy(designation, 2e-4, seed)
    after = body.smoothed(6e-4)
    assert distance(after, true) < 2e-4
    assert (
        sign_changes(body.points_curve, body.chord) > 100 > RIPPLES > sign_changes(after.curve, after.chord)
    )
    assert after.wedge == pytest.approx(true.wedge, rel=0.3)


def test_surfaces_that_cross_by_noise_are_smoothed_first() -> None:
    body, _ = next(pair for seed in range(20) if (pair := noisy("0006-sharp", 2e-4, seed))[0].crossing)
    with pytest.raises(InputError, match=r"crosses itself at .*; .*give smooth about 3 times the noise"):
        body.boundary(O_GRID)
    assert body.boundary(Sampling(161, 41, "o", smooth=6e-4)).south.shape == (161, 2)


def test_a_base_that_noise_could_have_made_is_closed() -> None:
    points = naca("0012-sharp").curve.points
    opened = np.concatenate([points, points[:1]])
    opened[[0, -1], 1] += [-2.5e-4, 2.5e-4]
    body = Airfoil(opened)
    assert body.blunt
    after = body.smoothed(6e-4)
    assert not after.blunt
    assert any("its base, 0.0005 chords wide" in change for change in changes_in(after.notes))
    assert body.smoothed(3e-4).blunt


def test_coordinates_of_few_digits_are_smoothed_with_as_many_knots_as_they_need() -> None:
    curve = naca("2412").curve
    points = curve.at(np.linspace(0.0, curve.length, 100, endpoint=False)).round(3)
    body = Airfoil(points)
    assert np.hypot(*(body.smoothed(1e-4).curve.points - body.curve.points).T).max() <= 1e-4 * body.chord


@pytest.mark.parametrize("topology", ["o", "c", "blocks"])
def test_a_section_is_smoothed_before_its_edge_is_opened(topology: str) -> None:
    body, _ = noisy("0006-sharp", 2e-4, 0)
    assert body.crossing  # until it is smoothed
    asked: dict[str, Any] = {"blocks": "auto"} if topology == "blocks" else {"topology": topology}
    notes = meshonet.infer(body, base=0.003, smooth=6e-4, **asked).notes
    changes = [note for note in notes if note.startswith("the outline is changed")]
    assert ["smoothed by" in change for change in changes[:2]] == [True, False]
    assert changes[1].endswith("is opened to 0.003")


@pytest.mark.parametrize("smooth", [None, 1e-4])
def test_edges_of_sections_that_do_not_repeat_their_first_point_are_opened(smooth: float | None) -> None:
    points = naca("0012-sharp").curve.points[::12]
    body = Airfoil(points)
    assert (body.blunt, body.gap) == (False, 0.0)
    opened = body.prepared(Sampling(base=0.003, smooth=smooth))
    assert opened.gap == pytest.approx(0.003 * body.chord, rel=1e-5)


@pytest.mark.parametrize("tolerance", [0.0, 1e-9, 0.1, float("nan")])
def test_other_tolerances_are_refused(tolerance: float) -> None:
    with pytest.raises(InputError, match=r"smooth: .* chords; use 1e-07 to 0.01|use 1e-7 to 0.01"):
        Sampling(smooth=tolerance)
