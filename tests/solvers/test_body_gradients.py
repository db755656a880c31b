"""O grids around bodies in torch: those of numpy, and gradients that finite differences confirm."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from quad_models import random_model

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.families.bodies import boundary
from meshonet.geometry.shapes.far_field import straight
from meshonet.solvers.neural.registry import load

torch = pytest.importorskip("torch")
from meshonet.solvers.neural.differentiable import BodyGrids  # noqa: E402 - it imports torch

torch.set_num_threads(1)  # tests run side by side


def bodies(ni: int, nj: int) -> list[Boundary]:
    """Return two random bodies, and an angle whose centroid is outside it."""
    results = [boundary(np.random.default_rng([1, k]), ni, nj) for k in range(2)]
    corners = np.array([0j, 1j, 0.2 + 1j, 0.2 + 0.2j, 1 + 0.2j, 1 + 0j, 0j])
    wall = np.interp(np.linspace(0, 6, ni), np.arange(7), corners) * np.exp(0.3j)
    far = 0.5 + 0.5j + 4.0 * np.exp(-1j * np.linspace(3.9, 3.9 + 2 * np.pi, ni))
    wall[-1], far[-1] = wall[0], far[0]
    south, north = (np.stack([edge.real, edge.imag], 1) for edge in (wall, far))
    cut = straight(south[0], north[0], nj)
    return [*results, Boundary(south, north, cut, cut, topology="o")]


def walls(boundaries: list[Boundary]) -> list[Any]:
    return [torch.tensor(np.stack([getattr(b, side) for b in boundaries])) for side in ("south", "north")]


@pytest.mark.parametrize("model", ["hole-o", "hole-winslow"])
@pytest.mark.parametrize(("ni", "nj"), [(65, 33), (129, 17), (40, 50), (9, 2)])
def test_torch_equals_numpy(model: str, ni: int, nj: int) -> None:
    boundaries = bodies(ni, nj)
    result = BodyGrids(model)(*walls(boundaries), nj).numpy()
    for one, solution in zip(result, load(model).solve(boundaries, "off"), strict=True):
        expected = solution.grid.nodes
        np.testing.assert_allclose(one, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_walls_are_the_given_ones_and_the_cut_is_closed() -> None:
    south, north = walls(bodies(97, 21))
    result = BodyGrids()(south, north, 21)
    assert torch.equal(result[:, :, 0], south)
    assert torch.equal(result[:, :, -1], north)
    assert torch.equal(result[:, 0], result[:, -1])


@pytest.mark.parametrize("model", ["hole-o", "hole-winslow"])
def test_gradients_are_those_of_finite_differences(model: str) -> None:
    """A random direction of both walls against the change of a random sum of the nodes."""
    grids, given = BodyGrids(model), walls(bodies(73, 21))
    generator = torch.Generator().manual_seed(0)
    moves = [torch.randn(edge.shape, generator=generator, dtype=edge.dtype) for edge in given]
    for move in moves:
        move[:, -1] = move[:, 0]
    weights = torch.randn(grids(*given, 21).shape, generator=generator, dtype=torch.float64)

    def summed(step: float) -> Any:
        return (weights * grids(*(e + step * m for e, m in zip(given, moves, strict=True)), 21)).sum()

    leaves = [edge.clone().requires_grad_() for edge in given]
    (weights * grids(*leaves, 21)).sum().backward()
    result = sum(float((leaf.grad * move).sum()) for leaf, move in zip(leaves, moves, strict=True))
    h = 1e-6
    expected = float(8 * (summed(h) - summed(-h)) - (summed(2 * h) - summed(-2 * h))) / (12 * h)
    assert result == pytest.approx(expected, rel=1e-6)


def test_single_precision_is_near_double() -> None:
    given = walls(bodies(65, 33))
    result = BodyGrids(dtype=torch.float32)(*(edge.float() for edge in given), 33)
    assert result.dtype == torch.float32
    assert float((result - BodyGrids()(*given, 33)).abs().max()) < 1e-3


def test_what_it_does_not_take_is_told(tmp_path: Path) -> None:
    south, north = walls(bodies(33, 9))
    with pytest.raises(InputError, match="nj is 1 nodes; use at least 2"):
        BodyGrids()(south, north, 1)
    with pytest.raises(InputError, match="opposite sides need equal counts"):
        BodyGrids()(south, north[:, ::2], 9)
    with pytest.raises(InputError, match="do not go once round a middle of the body"):
        BodyGrids()(south + 1e3, north, 9)
    quads = str(random_model(tmp_path / "quads.safetensors"))
    with pytest.raises(InputError, match="makes quad grids; use one for bodies"):
        BodyGrids(quads)
