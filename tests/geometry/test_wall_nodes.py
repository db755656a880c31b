import numpy as np
import pytest
from sections import selig

from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.spacing.laws import LAWS
from meshonet.geometry.spacing.sampling import Sampling

BASES = [2.2e-4, 8e-4, 3e-3, 0.02, 0.2]


def steps(wall: np.ndarray) -> np.ndarray:
    return np.hypot(*np.diff(wall, axis=0).T)


def growth(wall: np.ndarray) -> float:
    d = steps(wall)
    ratio = np.roll(d, -1) / d
    return float(np.maximum(ratio, 1 / ratio).max())


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("ni", [7, 20, 50, 100, 333])
@pytest.mark.parametrize("spacing", LAWS)
def test_nodes_are_distinct_and_both_corners_of_the_base_are_among_them(base, ni, spacing):
    wall = Airfoil(selig(0.12, 0.02, base)).wall(ni, Sampling(spacing=spacing))
    assert len(wall) == ni
    assert steps(wall).min() > 0
    np.testing.assert_array_equal(wall[0], wall[-1])
    np.testing.assert_allclose(wall[0], [1, 0], atol=1e-15)
    for y in (-base / 2, base / 2):
        assert np.hypot(*(wall - [1, y]).T).min() < 1e-15


@pytest.mark.parametrize("base", [0.0, *BASES])
@pytest.mark.parametrize("ni", [100, 200, 401])
def test_cells_grow_smoothly_everywhere(base, ni):
    airfoil = Airfoil(selig(0.12, 0.03, base))
    limit = 1.4 if ni == 100 else 1.3
    assert growth(airfoil.wall(ni, Sampling(spacing="tanh"))) < limit
    assert growth(airfoil.wall(ni, Sampling(spacing="curvature"))) < limit + 0.25 * (ni == 100)


@pytest.mark.parametrize("base", BASES)
def test_a_base_gets_at_least_two_cells_a_side_and_more_when_wide(base):
    wall = Airfoil(selig(0.12, 0.0, base)).wall(200, Sampling(spacing="tanh"))
    inside = int(np.argmin(np.abs(wall[:100, 1] + base / 2) + np.abs(wall[:100, 0] - 1)))
    assert inside >= 2
    assert inside >= 2 * (base / 1e-3) ** (1 / 3)


@pytest.mark.parametrize("spacing", ["tanh", "cosine", "curvature"])
@pytest.mark.parametrize("base", [0.0, 2e-3])
@pytest.mark.parametrize("ni", [100, 201, 400])
@pytest.mark.parametrize(("le", "te"), [(2e-3, 4e-3), (1e-3, 1e-3), (5e-4, 2e-4)])
def test_asked_spacings_are_met(spacing, base, ni, le, te):
    airfoil = Airfoil(selig(0.12, 0.02, base))
    wall = airfoil.wall(ni, Sampling(spacing=spacing, le_spacing=le, te_spacing=te))
    d = steps(wall) / airfoil.chord
    first = 0 if base == 0 else int(np.argmin(np.hypot(*(wall[: ni // 2] - [1, -base / 2]).T)))
    assert d[first] == pytest.approx(te, rel=0.05)
    assert d[-1 - first] == pytest.approx(te, rel=0.05)
    ahead = np.hypot(*(wall - airfoil.leading_edge).T)
    near = int(np.argmin(ahead))
    at_nose = (
        [d[near - 1], d[near]] if ahead[near] < 1e-9 else [d[near - (ahead[near - 1] < ahead[near + 1])]]
    )
    assert min(at_nose) == pytest.approx(le, rel=0.06)


@pytest.mark.parametrize("spacing", [name for name, law in LAWS.items() if law.place and law.sets_ends])
def test_cells_at_the_nose_of_a_blunt_section_follow_the_law(spacing):
    airfoil, ni = Airfoil(selig(0.12, 0.0, 3e-3)), 200
    wall = airfoil.wall(ni, Sampling(spacing=spacing))
    on_base = int((np.abs(wall[:, 0] - 1) < 1e-12).sum()) - 1
    side = 0.5 * (airfoil.upper_end - airfoil.half_base)
    expected = side * LAWS[spacing].place(np.array([2 / (ni - on_base)]))[0]
    assert steps(wall)[ni // 2 - 6 : ni // 2 + 6].min() == pytest.approx(expected, rel=0.1)


def test_one_spacing_alone_is_met():
    airfoil = Airfoil(selig(0.12))
    for setting in ({"te_spacing": 1e-3}, {"le_spacing": 1e-3}):
        d = steps(airfoil.wall(201, Sampling(spacing="tanh", **setting)))
        assert d[0 if "te_spacing" in setting else 100] == pytest.approx(1e-3, rel=0.05)


def test_uniform_has_equal_arcs_and_cosine_the_half_circle_s():
    airfoil = Airfoil(selig(0.12))
    d = steps(airfoil.wall(201, Sampling(spacing="uniform")))
    assert d.max() / d.min() < 1.05
    d = steps(airfoil.wall(201, Sampling(spacing="cosine")))
    q = np.linspace(0, np.pi, 101)
    np.testing.assert_allclose(d[:100] / d[:100].sum(), np.diff(0.5 - 0.5 * np.cos(q)), atol=2e-4)


def test_corners_of_the_sides_are_nodes():
    points = selig(0.12)
    flapped = points[:, 0] > 0.75
    points[flapped, 1] -= 0.3 * (points[flapped, 0] - 0.75)
    airfoil = Airfoil(points)
    kinks = airfoil.curve.points[airfoil.curve.corner_index[1:]]
    assert len(kinks) == 2
    for spacing in ("auto", "tanh", "curvature"):
        wall = airfoil.wall(150, Sampling(spacing=spacing))
        for kink in kinks:
            assert (wall == kink).all(axis=1).any()
