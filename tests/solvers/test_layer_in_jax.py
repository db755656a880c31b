"""Grids in JAX: the nodes of torch's functions, and gradients that finite differences confirm."""

from typing import Any

import numpy as np
import pytest
from random_quads import random_quad

jax = pytest.importorskip("jax")
torch = pytest.importorskip("torch")
jax.config.update("jax_enable_x64", True)
from jax.test_util import check_grads  # noqa: E402

from meshonet import layer  # noqa: E402 - it imports torch
from meshonet.geometry.shapes.airfoil.naca import naca  # noqa: E402
from meshonet.geometry.spacing.sampling import Sampling  # noqa: E402


def sides() -> list[Any]:
    drawn = [boundary for boundary in (random_quad(seed, 9, 8) for seed in range(8)) if boundary][:4]
    return [np.stack([getattr(b, name) for b in drawn]) for name in ("south", "north", "west", "east")]


def test_nodes_and_gradients_are_those_of_torch_and_of_finite_differences() -> None:
    given = sides()
    nodes = jax.jit(layer.in_jax(layer.winslow))
    expected = layer.winslow(*map(torch.tensor, given)).numpy()
    np.testing.assert_allclose(nodes(*given), expected, rtol=0, atol=1e-14)
    np.testing.assert_allclose(jax.vmap(nodes)(*given), expected, rtol=0, atol=1e-11)

    south, *others = (side[0] for side in given)
    within = np.sin(np.linspace(0.0, np.pi, len(south)))[:, None]  # the corners are those of west and east

    def loss(move: Any) -> Any:
        return (nodes(south + within * move, *others) ** 3).sum()

    check_grads(loss, (0.0 * south,), order=1, modes=["rev"])
    moves = 0.01 * np.arange(3.0)[:, None, None] * np.ones_like(south)
    slopes = jax.vmap(jax.grad(loss))(moves)
    np.testing.assert_allclose(slopes[2], jax.grad(loss)(moves[2]), rtol=0, atol=1e-10)


def test_bodies_take_the_count_across() -> None:
    section = naca("2412").boundary(Sampling(25, 6, "o", far_field=3.0))
    nodes = layer.in_jax(layer.conformal, 6)(section.south, section.north)
    expected = layer.conformal(torch.tensor(section.south), torch.tensor(section.north), 6)
    np.testing.assert_allclose(nodes, expected.numpy(), rtol=0, atol=1e-14)
