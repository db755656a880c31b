"""Airfoil grids in torch: those of numpy, and gradients that finite differences confirm."""

from typing import Any

import numpy as np
import pytest
from inferred import infer

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import SolverError
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.far_field import straight
from meshonet.geometry.spacing.sampling import Sampling

torch = pytest.importorskip("torch")
from meshonet.solvers.neural.differentiable import AirfoilGrids  # noqa: E402 - it imports torch


def airfoil(designation: str, ni: int, nj: int, **settings: Any) -> Boundary:
    return naca(designation).boundary(Sampling(ni, nj, "o", **settings))


def walls(*boundaries: Boundary) -> list[Any]:
    return [torch.tensor(np.stack([getattr(b, side) for b in boundaries])) for side in ("south", "north")]


@pytest.mark.parametrize(
    ("designation", "ni", "nj", "spacing"),
    [("2412", 161, 60, "cosine"), ("4412-sharp", 120, 41, "cosine"), ("23012", 90, 30, "conformal")],
)
@pytest.mark.parametrize(("model", "polish"), [("base", 2), ("airfoil-o", 0), ("airfoil-o", 1)])
def test_torch_equals_numpy(
    designation: str, ni: int, nj: int, spacing: Any, model: str, polish: int
) -> None:
    boundary = airfoil(designation, ni, nj, spacing=spacing)
    expected = infer(boundary, model, polish or "off")
    assert expected.method == ("conformal" if model == "base" else "operator")
    result = AirfoilGrids(model, polish)(*walls(boundary), nj)[0].numpy()
    np.testing.assert_allclose(result, expected.grid.nodes, rtol=0, atol=1e-12 * np.abs(boundary.north).max())


def test_a_mirrored_and_a_symmetric_body_are_those_of_numpy_in_one_batch() -> None:
    one, other = airfoil("0012-sharp", 101, 40), airfoil("4412-sharp", 101, 40)
    south, north = walls(one, other)
    turned = [edge.flip(1) * torch.tensor([1.0, -1.0]) for edge in (south, north)]
    grids = AirfoilGrids("airfoil-o", 1)
    result = grids(*(torch.cat(pair) for pair in zip((south, north), turned, strict=True)), 40)
    mirrored = result[2:].flip(1) * torch.tensor([1.0, -1.0])
    np.testing.assert_allclose(mirrored, result[:2], rtol=0, atol=2e-11)
    np.testing.assert_allclose(result[0], infer(one, "airfoil-o", 1).grid.nodes, rtol=0, atol=2e-11)


@pytest.mark.parametrize("designation", ["2412", "4412-sharp"])
def test_a_section_far_from_the_origin_has_the_grid_of_the_same_one_near_it(designation: str) -> None:
    """A thousand chords away its nodes are rounded to 1e-13; the grids differ by little more."""
    near, away = airfoil(designation, 101, 30), np.array([1e3, -2e3])
    south, north = near.south + away, near.north + away
    cut = straight(south[0], north[0], 30)
    there = Boundary(south, north, cut, cut, topology="o")
    south, north = south - away, north - away  # rounded alike
    cut = straight(south[0], north[0], 30)
    here = infer(Boundary(south, north, cut, cut, topology="o"), "airfoil-o", 1).grid.nodes
    for result in (
        infer(there, "airfoil-o", 1).grid.nodes,
        AirfoilGrids(polish=1)(*walls(there), 30)[0].numpy(),
    ):
        np.testing.assert_allclose(result - away, here, rtol=0, atol=1e-11)


def test_walls_are_the_given_ones() -> None:
    south, north = walls(airfoil("2412", 81, 20))
    result = AirfoilGrids("base", 1)(south, north, 20)
    assert torch.equal(result[:, :, 0], south)
    assert torch.equal(result[:, :, -1], north)


@pytest.mark.parametrize("designation", ["2412", "4412-sharp"])
def test_gradients_are_those_of_finite_differences(designation: str) -> None:
    """A smooth random direction of both walls, against the change of a random sum of the nodes."""
    south, north = walls(airfoil(designation, 101, 31, spacing="cosine"))
    grids = AirfoilGrids("airfoil-o", 1)
    rng = np.random.default_rng(4)
    theta = 2.0 * np.pi * np.arange(101) / 100
    waves = np.stack([np.cos(k * theta + k) / (k + 1) for k in range(5)])
    moves = [torch.tensor((rng.standard_normal((2, 5)) @ waves).T[None] * size) for size in (0.02, 0.5)]
    for move in moves:
        move[:, -1] = move[:, 0]
    weights = torch.tensor(rng.standard_normal((1, 101, 31, 2)))
    given = [edge.clone().requires_grad_() for edge in (south, north)]
    (grids(*given, 31) * weights).sum().backward()
    slope = sum(float((edge.grad * move).sum()) for edge, move in zip(given, moves, strict=True))
    step = 1e-5

    def total(way: float) -> float:
        moved = [edge + way * move for edge, move in zip((south, north), moves, strict=True)]
        return float((grids(*moved, 31) * weights).sum())

    assert slope == pytest.approx((total(step) - total(-step)) / (2.0 * step), rel=1e-6)


@pytest.mark.parametrize("polish", [0, 2])
def test_gradients_of_a_symmetric_section(polish: int) -> None:
    """Along moves that keep it symmetric, and along others, which the nodes jump at.

    The network's answers to two mirror images are not one when these are nearly the same; their slope is what
    is left of differences over two lengths.
    """
    south, north = walls(airfoil("0012-sharp", 101, 31))
    grids = AirfoilGrids("airfoil-o", polish)
    rng = np.random.default_rng(4)
    theta = 2.0 * np.pi * np.arange(101) / 100
    waves = np.stack([np.cos(k * theta + k) / (k + 1) for k in range(5)])
    move = torch.tensor((rng.standard_normal((2, 5)) @ waves).T[None] * 0.02)
    move[:, -1] = move[:, 0]
    image = move.flip(1) * torch.tensor([1.0, -1.0])
    weights = torch.tensor(rng.standard_normal((1, 101, 31, 2)))
    given = south.clone().requires_grad_()
    (grids(given, north, 31) * weights).sum().backward()

    def change(way: Any, step: float) -> float:
        both = [float((grids(south + s * way, north, 31) * weights).sum()) for s in (step, -step)]
        return both[0] - both[1]

    even, odd = 0.5 * (move + image), 0.5 * (move - image)
    step = 1e-4
    assert float((given.grad * even).sum()) == pytest.approx(change(even, step) / (2 * step), rel=1e-5)
    left = (change(odd, 2 * step) - change(odd, step)) / (2 * step)
    assert float((given.grad * odd).sum()) == pytest.approx(left, rel=2e-5)


def test_a_body_that_cannot_be_lifted_is_refused() -> None:
    angle = -2.0 * np.pi * np.arange(8) / 7
    ring = torch.tensor(np.stack([np.cos(angle), np.sin(angle)], 1)[None])
    with pytest.raises(SolverError, match="the wall has 7 nodes"):
        AirfoilGrids("base")(ring, 5.0 * ring, 10)
