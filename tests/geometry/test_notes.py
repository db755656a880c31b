"""What is changed of a user's geometry is said in the notes of its boundary."""

import numpy as np
import pytest
from sections import selig

from meshonet.geometry.notes import changes_in
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.assembly import assembled
from meshonet.geometry.shapes.far_field import o_boundary
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.sampling import Sampling, TrailingEdge

O_GRID = Sampling(121, 31, "o")


def test_a_clean_section_has_none() -> None:
    assert Airfoil(selig(0.12)).boundary(O_GRID).notes == ()


def test_neighbours_swapped_are_named() -> None:
    points = selig(0.12)
    points[[20, 21]] = points[[21, 20]]
    (note,) = Airfoil(points, places=[f"line {k + 2}" for k in range(len(points))]).boundary(O_GRID).notes
    assert note == "the outline is changed: points in the wrong order are swapped (line 22, line 23)"


def touching() -> Airfoil:
    """A section whose two surfaces cross by the last digit over the last 3 % of its chord."""
    points = selig(0.12)
    behind = points[:, 0] > 0.97
    lower = np.arange(len(points)) > len(points) // 2
    points[behind, 1] = np.where(lower[behind], 1e-6, -1e-6)
    points[[0, -1]] = 1.0, 0.0
    return Airfoil(points)


def test_a_base_rounded_at_its_corners_is_named() -> None:
    (note,) = Airfoil(selig(0.12, base=0.004)).boundary(Sampling(121, 31, "o", te="round")).notes
    assert note == "the outline is changed: its base, 0.004 chords wide, is rounded at its corners"


@pytest.mark.parametrize("te", ["round", "wedge", "exact"])
def test_a_treatment_of_the_base_without_one_is_named(te: TrailingEdge) -> None:
    (note,) = Airfoil(selig(0.12)).boundary(Sampling(121, 31, "o", te=te)).notes
    assert note == f"{{te}} {te} changes nothing, as the trailing edge is not blunt"


def test_a_c_grid_that_was_chosen_for_a_sharp_edge_is_named() -> None:
    section = Airfoil(selig(0.12))
    (note,) = section.boundary(Sampling(161, 31, viscous=True)).notes
    assert note == "c grid, as the trailing edge is sharp; {topology} o makes an O grid"
    assert section.boundary(Sampling(161, 31, "c", viscous=True)).notes == ()


@pytest.mark.parametrize("sampling", [O_GRID, Sampling(161, 31, "c"), Sampling(121, 31, "o", normalise=True)])
def test_surfaces_moved_apart_are_named(sampling: Sampling) -> None:
    notes = touching().boundary(sampling).notes
    assert any(
        "its surfaces touch near (0.9" in note and "are moved apart, by at most" in note for note in notes
    )


def test_straight_lines_for_a_spline_that_would_cross_itself_are_named() -> None:
    upper = [[1.0, 0.0], [0.99, 0.1], [0.88, 0.09], [0.51, 0.08], [0.34, 0.11], [0.32, 0.1], [0.18, 0.08]]
    lower = [[0.14, 0.05], [0.17, 0.0], [0.25, 0.03], [0.67, 0.03], [0.71, 0.07], [0.86, 0.04], [1.0, 0.0]]
    (note,) = Airfoil(np.array([*upper, [0.0, 0.0], *lower])).notes
    assert note.startswith("the outline follows straight lines between 3 of its 14 pairs of points")


def test_another_spacing_than_the_usual_one_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    from meshonet.geometry.errors import InputError

    def refused(*_: object, **__: object) -> None:
        raise InputError("the lifted wall is not star-shaped")

    monkeypatch.setattr("meshonet.geometry.shapes.airfoil.wall_nodes.conformal_knots", refused)
    monkeypatch.setattr("meshonet.geometry.conformal.spacing.conformal_knots", refused)
    because = "is used instead of conformal: the lifted wall is not star-shaped"
    assert Airfoil(selig(0.12)).boundary(O_GRID).notes == (f"spacing tanh {because}",)
    turn = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    ellipse = Outline(np.stack([2.0 * np.cos(turn), np.sin(turn)], axis=1))
    assert ellipse.boundary(O_GRID).notes == (f"spacing uniform {because}",)
    assert Airfoil(selig(0.12)).boundary(Sampling(121, 31, "o", spacing="tanh")).notes == ()


def test_a_far_field_that_begins_elsewhere_is_named() -> None:
    turn = -np.linspace(0.0, 2.0 * np.pi, 81)
    slanted = np.stack([np.cos(turn), 0.15 * np.sin(turn + 0.5) + 0.6 * np.cos(turn)], axis=1)
    slanted[-1] = slanted[0]
    notes = o_boundary(slanted, 11, np.array([0.4, 0.9]), 20.0).notes
    assert len(notes) == 1
    assert "the far field begins" in notes[0]
    assert "degrees from where the first wall node lies" in notes[0]


@pytest.mark.parametrize(
    ("te", "change"),
    [("round", "is rounded at its corners"), ("wedge", "is closed by a wedge 0.014 chords long")],
)
def test_in_blocks_the_change_of_each_body_is_named(te: TrailingEdge, change: str) -> None:
    blunt, sharp = Airfoil(selig(0.12, base=0.004)), Airfoil(selig(0.12) + np.array([0.0, 1.0]))
    both = assembled([blunt, sharp], ["main", "flap"], Sampling(te=te)).notes
    changed = f"the outline is changed: its base, 0.004 chords wide, {change}"
    assert both == (
        f"main: {changed}",
        f"flap: {{te}} {te} changes nothing, as the trailing edge is not blunt",
    )
    assert changes_in(both) == both[:1]
    assert assembled([blunt], ["blade"], Sampling(te=te)).notes == (changed,), "one body needs no name"
    assert assembled([blunt, sharp], ["main", "flap"], Sampling()).notes == ()


def test_in_blocks_a_curve_far_from_the_lines_between_its_points_is_named() -> None:
    coarse = Airfoil(selig(0.12)[::8])
    (note,) = assembled([coarse], ["body"], Sampling()).notes
    assert "is a smooth curve through the points, up to 0.0" in note
    assert coarse.boundary(O_GRID).notes == (note,)


@pytest.mark.parametrize("base", [0.0, 0.002])
def test_an_edge_opened_to_a_base_is_named_and_thicker_ones_stay(base: float) -> None:
    section = Airfoil(selig(0.12, base=base))
    opened = section.boundary(Sampling(121, 31, "o", base=0.01))
    assert opened.notes == (
        f"the outline is changed: its trailing edge, {section.gap:.2g} chords thick, is opened to 0.01",
    )
    gap = section.opened(0.01).gap
    assert gap == pytest.approx(0.01, rel=1e-3)
    nose = np.argmin(opened.south[:, 0])
    np.testing.assert_allclose(opened.south[nose], section.leading_edge, atol=2e-4)
    thick = Airfoil(selig(0.12, base=0.02))
    assert thick.boundary(Sampling(121, 31, "o", base=0.01)).notes == ()
    assert changes_in(assembled([section], ["a"], Sampling(base=0.01)).notes) == opened.notes
