"""Grids as layers: gradients are those of finite differences, of some sides alone too."""

from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch")
from layer_inputs import AROUND, QUADS, domains, inputs, sides_of, uneven  # noqa: E402 - it imports torch

from meshonet import layer  # noqa: E402


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_gradients_are_those_of_finite_differences(function: Any) -> None:
    nodes, sides = inputs(function, 2)
    sides = [side.requires_grad_() for side in sides]
    assert torch.autograd.gradcheck(nodes, sides, fast_mode=True)


def test_the_gradient_of_a_slow_conformal_grid_is_that_of_finite_differences() -> None:
    """Along a random way of both sides at once: gradcheck makes twice the grids, each of 185 steps."""
    sides, rng = sides_of([uneven()])[:2], np.random.default_rng(0)
    ways = [torch.from_numpy(rng.normal(size=side.shape)) for side in sides]

    def moved(by: Any) -> Any:
        return layer.conformal(*(side + by * way for side, way in zip(sides, ways, strict=True)), 9)

    by = torch.zeros((), dtype=torch.float64, requires_grad=True)
    nodes = moved(by)
    weights = torch.from_numpy(rng.normal(size=nodes.shape))
    (slope,) = torch.autograd.grad((weights * nodes).sum(), by)
    difference = (weights * (moved(1e-6) - moved(-1e-6))).sum() / 2e-6
    torch.testing.assert_close(slope, difference, rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_one_side_may_have_a_gradient_alone_and_any_memory_layout(function: Any) -> None:
    nodes, sides = inputs(function, 2)
    every = [side.clone().requires_grad_() for side in sides]
    nodes(*every).square().sum().backward()
    for k in range(len(sides)):
        some = [side.mT.contiguous().mT.requires_grad_(i == k) for i, side in enumerate(sides)]
        nodes(*some).square().sum().backward()
        torch.testing.assert_close(some[k].grad, every[k].grad, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("function", [layer.transfinite, layer.winslow])
def test_gradients_at_a_repeated_node_are_finite(function: Any) -> None:
    sides = sides_of(domains(9, 8, 4))
    sides[0][1, 4] = sides[0][1, 5]
    sides = [side.requires_grad_() for side in sides]
    function(*sides).square().sum().backward()
    assert all(bool(side.grad.isfinite().all()) for side in sides)
