"""A note where the cells on a blunt base and beside it are unlike, and a size that puts it right."""

import re

import numpy as np
import pytest

from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.laws import Spacing
from meshonet.geometry.spacing.sampling import Sampling


def notes(name: str, te_spacing: float | None, **more: str) -> str:
    boundary = naca(name).boundary(Sampling(200, 60, "o", "curvature", te_spacing=te_spacing, **more))  # type: ignore[arg-type]
    return "; ".join(boundary.notes)


@pytest.mark.parametrize("name", ["0012", "2424", "4415"])
def test_unlike_cells_at_a_base_are_noted_with_their_ratio_and_a_size_that_fits(name: str) -> None:
    note = notes(name, 1e-3)
    result = re.search(
        r"base are (\S+) times smaller than those beside it: use {te_spacing} near (\S+),", note
    )
    assert result is not None
    ratio, fits = map(float, result.groups())
    wall = naca(name).boundary(Sampling(200, 60, "o", "curvature", te_spacing=1e-3)).south
    steps = np.hypot(*np.diff(wall[:40], axis=0).T)
    assert ratio == pytest.approx((steps[1:] / steps[:-1]).max(), rel=0.03)
    assert "on the base" not in notes(name, fits)


def test_like_cells_and_bases_that_are_none_are_not_noted() -> None:
    assert "on the base" not in notes("0012", None)
    assert "on the base" not in notes("0012", 1e-3, te="round")
    assert "on the base" not in notes("0012-sharp", 1e-3)


@pytest.mark.parametrize("spacing", ["auto", "curvature", "tanh", "cosine"])
@pytest.mark.parametrize("nodes", [5, 9, 31])
def test_a_base_has_the_nodes_asked_for(spacing: Spacing, nodes: int) -> None:
    body = naca("2412")
    wall = body.boundary(Sampling(200, 60, "o", spacing, base_nodes=nodes)).south
    ends = [int(np.argmin(np.hypot(*(wall - corner).T))) for corner in body.curve.points[[1, -1]]]
    assert (ends[0], len(wall) - 1 - ends[1]) == (nodes // 2, nodes // 2)
    np.testing.assert_allclose(wall[ends], body.curve.points[[1, -1]], atol=1e-12)


def test_a_wide_base_has_enough_cells_of_the_size_of_its_neighbours() -> None:
    wide = np.array([[1.0, 0.0], [1.0, 0.04]])  # half of a base of 8 % of the chord
    x = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 81)))
    half = 0.3 * (np.sqrt(x) - x) + wide[1, 1] * x**2
    body = Airfoil(
        np.concatenate([np.stack([x, half], axis=1)[::-1], np.stack([x, -half], axis=1)[1:]]), "wide"
    )
    counts = []
    for ni in (201, 401, 801):
        wall = body.boundary(Sampling(ni, 60, "o", "curvature")).south
        k = int(np.argmin(np.hypot(*(wall[: ni // 2] - body.curve.points[1]).T)))
        on, beside = (float(np.hypot(*(wall[i + 1] - wall[i]))) for i in (k - 1, k))
        assert beside / on == pytest.approx(1.0, abs=0.1)
        counts.append(2 * k)
    assert 40 <= counts[1] <= 60
    assert counts[0] < counts[1] < counts[2]


@pytest.mark.parametrize(
    ("name", "sampling", "message"),
    [
        ("0012-sharp", Sampling(base_nodes=9), "base_nodes: the trailing edge has no base; leave"),
        ("0012", Sampling(te="round", base_nodes=9), "base_nodes: the trailing edge has no base; leave"),
        (
            "0012",
            Sampling(base_nodes=8),
            "base_nodes: a base of 8 nodes has none in its middle, .* use 7 or 9",
        ),
        (
            "0012",
            Sampling(base_nodes=61, refined=4),
            "half of a base of 61 nodes has 30 cells, and refine needs a multiple of 4; use 57 or 65",
        ),
        ("0012", Sampling(41, base_nodes=43), "43 of 41 nodes on the base .*; use at most 37"),
        ("0012", Sampling(9, spacing="curvature", refined=8), "17 of 9 nodes on .*; use a finer res"),
    ],
)
def test_bases_that_cannot_be_had_are_refused(name: str, sampling: Sampling, message: str) -> None:
    with pytest.raises(InputError, match=message):
        naca(name).boundary(sampling)


@pytest.mark.parametrize("ni", [161, 257, 401])
def test_the_angles_of_a_base_are_those_of_the_outline_in_coarsened_grids(ni: int) -> None:
    x = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 161)))
    half = 0.3 * (np.sqrt(x) - x) + 0.05 * x**2
    lower = -half + 0.04 * np.exp(-(((1.0 - x) / 0.03) ** 2))  # a surface that turns by 30 degrees at its end
    body = Airfoil(np.concatenate([np.stack([x, half], axis=1)[::-1], np.stack([x, lower], axis=1)[1:]]))
    curve = body.curve
    wall = body.boundary(Sampling(ni, 60, "o", "curvature")).south
    tiny = 1e-7 * np.array([1.0, -1.0])
    ways = curve.tangent(curve.knots[[1, -1]] + tiny) * np.array([[1.0], [-1.0]])
    for coarser in (1, 2, 4):
        ring = wall[::coarser]
        for corner, way, step in zip(curve.points[[1, -1]], ways, (1, -1), strict=True):
            k = int(np.argmin(np.hypot(*(ring - corner).T)))
            assert np.hypot(*(ring[k] - corner)) < 1e-12
            edge = ring[k + step] - ring[k]
            lean = np.degrees(np.arctan2(edge[0] * way[1] - edge[1] * way[0], (edge * way).sum()))
            assert abs(lean) < 1.0


@pytest.mark.parametrize(("base", "rounding"), [(0.2, 3e-4), (3e-4, 0.0)])
def test_a_base_leaves_enough_nodes_to_the_nose_and_the_sides(base: float, rounding: float) -> None:
    """Cells at its corners are tiny: corners of the wide base are rounded, the other base is thin."""
    x = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 161)))
    half = (0.6 if rounding else 0.3) * (np.sqrt(x) - x) + 0.5 * base * x**2
    half -= 20.0 * rounding * np.exp((x - 1.0) / (4.0 * rounding)) if rounding else 0.0
    body = Airfoil(np.concatenate([np.stack([x, half], axis=1)[::-1], np.stack([x, -half], axis=1)[1:]]))
    wall = body.boundary(Sampling(257, 60, "o", "curvature")).south
    steps = np.diff(wall, axis=0)
    lengths = np.hypot(*steps.T)
    assert lengths.max() < 3.0 * lengths.mean()
    nose = wall[1:-1, 0] < 0.3
    turns = np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
    assert np.degrees(np.abs(turns[nose]).max()) < 10.0
