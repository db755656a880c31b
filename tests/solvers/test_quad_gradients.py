"""Quad grids in torch: those of numpy, and gradients that finite differences confirm."""

from typing import Any

import numpy as np
import pytest
from quad_models import random_model
from random_quads import random_quad

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.neural.registry import load

torch = pytest.importorskip("torch")
from meshonet.solvers.neural.differentiable import QuadGrids  # noqa: E402 - it imports torch

SIDES = ("south", "north", "west", "east")


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(random_model(tmp_path_factory.mktemp("model") / "random.safetensors"))


def domains(ni: int, nj: int, seeds: tuple[int, ...] = (3, 5)) -> list[Boundary]:
    results = [random_quad(seed, ni, nj) for seed in seeds]
    return [boundary for boundary in results if boundary is not None]


def edges(boundaries: list[Boundary]) -> list[Any]:
    return [torch.tensor(np.stack([getattr(b, side) for b in boundaries])) for side in SIDES]


@pytest.mark.parametrize("name", ["random", "quad-winslow"])
@pytest.mark.parametrize(("ni", "nj"), [(33, 33), (65, 50), (20, 81)])
def test_torch_equals_numpy(model: str, ni: int, nj: int, name: str) -> None:
    boundaries, name = domains(ni, nj), model if name == "random" else name
    result = QuadGrids(name)(*edges(boundaries)).numpy()
    for one, solution in zip(result, load(name).solve(boundaries, "off"), strict=True):
        np.testing.assert_allclose(one, solution.grid.nodes, rtol=0, atol=1e-12)


def test_edges_are_the_given_ones(model: str) -> None:
    given = edges(domains(30, 40))
    result = QuadGrids(model)(*given)
    for edge, expected in zip(
        (result[:, :, 0], result[:, :, -1], result[:, 0], result[:, -1]), given, strict=True
    ):
        assert torch.equal(edge, expected)


@pytest.mark.parametrize("name", ["random", "quad-winslow"])
def test_gradients_are_those_of_finite_differences(model: str, name: str) -> None:
    """A random direction of all four edges, corners kept, against the change of a random sum of the nodes."""
    grids, given = QuadGrids(model if name == "random" else name), edges(domains(25, 41, (3,)))
    generator = torch.Generator().manual_seed(0)
    moves = [torch.randn(edge.shape, generator=generator, dtype=edge.dtype) for edge in given]
    for move in moves:
        move[:, [0, -1]] = 0.0
    weights = torch.randn(grids(*given).shape, generator=generator, dtype=torch.float64)

    def summed(step: float) -> Any:
        return (weights * grids(*(e + step * m for e, m in zip(given, moves, strict=True)))).sum()

    leaves = [edge.clone().requires_grad_() for edge in given]
    (weights * grids(*leaves)).sum().backward()
    result = sum(float((leaf.grad * move).sum()) for leaf, move in zip(leaves, moves, strict=True))
    h = 1e-6
    expected = float(8 * (summed(h) - summed(-h)) - (summed(2 * h) - summed(-2 * h))) / (12 * h)
    assert result == pytest.approx(expected, rel=1e-6)


def test_a_step_down_the_gradient_makes_the_middle_cells_more_even(model: str) -> None:
    grids, given = QuadGrids(model), edges(domains(33, 33, (3,)))
    middle = torch.tensor(0.0, dtype=torch.float64, requires_grad=True)

    def spread(shift: Any) -> Any:
        bump = torch.sin(torch.linspace(0, torch.pi, 33, dtype=torch.float64))
        north = given[1] + shift * torch.stack([0 * bump, bump], -1)
        nodes = grids(given[0], north, given[2], given[3])
        return torch.log((nodes[:, :, 1:] - nodes[:, :, :-1]).norm(dim=-1)).std()

    before = spread(middle)
    (slope,) = torch.autograd.grad(before, middle)
    assert spread(-1e-2 * torch.sign(slope)) < before
