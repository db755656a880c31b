"""Notes on what a wall is: an oblique base, a curve that leaves the straight lines between the points."""

import numpy as np
import pytest
from sections import oblique

import meshonet
from meshonet.geometry.arrays import Floats
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.sampling import Sampling


def section(points: int = 121) -> Floats:
    """NACA 2412 with a sharp edge, clockwise from there."""
    angle = np.linspace(0.0, np.pi, points // 2 + 1)
    x = 0.5 * (1.0 + np.cos(angle))
    y = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    return np.concatenate([np.stack([x, -y], axis=1), np.stack([x, y], axis=1)[-2::-1]])


def notes(points: Floats, **sampling: bool) -> str:
    return "; ".join(Airfoil(points).boundary(Sampling(ni=81, nj=11, **sampling)).notes)


@pytest.mark.parametrize(("ratio", "kept"), [(0.06, "lower"), (0.12, "")])
def test_an_oblique_base_is_named_with_width_and_angle(ratio: float, kept: str) -> None:
    points = oblique(ratio)
    ends = points[0] - points[-1]
    for normalise in (False, True):
        text = notes(points, normalise=normalise)
        assert text.count("oblique") == 1
        words = text.split("trailing edge, ")[1].split()
        assert float(words[0]) == pytest.approx(np.hypot(*ends), rel=0.01)
        assert float(words[5]) == pytest.approx(np.degrees(np.arctan(ends[0] / ends[1])), abs=2)
        assert ("last piece of the lower surface" in text) == bool(kept)
    assert ("the upper surface" in notes(points * [1.0, -1.0])) == bool(kept)
    assert "oblique" not in notes(oblique(0.21))  # 25 degrees
    assert "oblique" not in notes(section())
    assert "oblique" not in notes(section()[2:-2])  # a base across the chord


def test_a_coarse_outline_says_how_far_the_wall_leaves_it() -> None:
    assert "straight lines" not in notes(section(201))
    text = notes(section(31))
    assert "the wall is a smooth curve through the points, up to " in text
    off = float(text.split("points, up to ")[1].split()[0])
    wall = Airfoil(section(31)).boundary(Sampling(ni=2001, nj=11)).south
    a, b = section(31)[:-1, None], np.diff(section(31), axis=0)[:, None]
    along = np.clip(((wall - a) * b).sum(-1) / (b**2).sum(-1), 0.0, 1.0)[..., None]
    nearest = np.hypot(*np.moveaxis(wall - a - along * b, -1, 0)).min(axis=0)
    assert off == pytest.approx(nearest.max(), rel=0.05)  # to the two digits of the note, and places searched


def test_the_departure_of_a_curve_is_that_of_its_circle() -> None:
    from meshonet.geometry.curves.curve import Curve

    angle = np.linspace(0.0, 2.0 * np.pi, 13)[:-1]
    circle = Curve(np.stack([np.cos(angle), np.sin(angle)], axis=1), closed=True)
    assert circle.departure() == pytest.approx(1.0 - np.cos(np.pi / 12), rel=0.01)


@pytest.mark.parametrize("settings", [{}, {"te": "round"}, {"topology": "c"}, {"y_plus": 1, "reynolds": 1e6}])
def test_an_array_of_an_airfoil_is_one_as_its_file_is(tmp_path: object, settings: dict[str, object]) -> None:
    points = naca("2412").curve.points
    path = f"{tmp_path}/foil.dat"
    np.savetxt(path, points, fmt="%.17g", header="foil", comments="")
    whole = {"res": (81, 41), **settings}
    np.testing.assert_array_equal(meshonet.grid(points, **whole).nodes, meshonet.grid(path, **whole).nodes)


def test_an_array_that_is_no_airfoil_stays_an_outline() -> None:
    square = np.array([[0, 0], [2, 0], [2, 1], [0, 1]], dtype=float)
    assert meshonet.grid(square, res=(11, 11)).topology == "quad"
    with pytest.raises(meshonet.InputError, match="te needs an airfoil"):
        meshonet.grid(square, res=(11, 11), te="round")


def test_sides_given_by_few_points_of_an_arc_say_how_far_they_leave_the_lines_between_them() -> None:
    angle = np.linspace(np.pi, 0.0, 8)
    arch = np.concatenate(
        [np.stack([np.cos(angle), np.sin(angle)], axis=1), [[2.0, 0.0], [2.0, 3.0], [-1.0, 3.0]]]
    )
    text = "; ".join(Outline(arch, corners=(0, 8, 9, 10)).boundary(Sampling(ni=31, nj=11)).notes)
    off = float(text.split("smooth curves through the points, up to ")[1].split()[0])
    assert off == pytest.approx(1.0 - np.cos(np.pi / 14), rel=0.1)
