"""Grids as layers: members of batches are those alone, of any size, type and number."""

from typing import Any

import pytest

torch = pytest.importorskip("torch")
from layer_inputs import AROUND, QUADS, domains, inputs, sides_of  # noqa: E402 - it imports torch

from meshonet import layer  # noqa: E402


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_members_through_vmap_are_those_alone(function: Any) -> None:
    nodes, sides = inputs(function, 8)

    def loss(*sides: Any) -> Any:
        return (nodes(*sides) ** 3).sum()

    together = torch.func.vmap(nodes)(*sides)
    slopes = torch.func.vmap(torch.func.grad(loss))(*sides)
    for k in (0, 3, 7):
        alone = [side[k].clone().requires_grad_() for side in sides]
        grid = nodes(*alone)
        torch.testing.assert_close(together[k], grid.detach(), rtol=0, atol=1e-11)
        (grid**3).sum().backward()
        torch.testing.assert_close(slopes[k], alone[0].grad, rtol=1e-9, atol=1e-8)


@pytest.mark.parametrize("function", [*QUADS[:3], layer.QuadGrids()])
def test_members_through_two_levels_of_vmap_are_those_of_one_batch(function: Any) -> None:
    sides = [side[:4] for side in sides_of(domains(9, 8, 8))]
    nested = torch.func.vmap(torch.func.vmap(function))(*(side.unflatten(0, (2, 2)) for side in sides))
    torch.testing.assert_close(nested.flatten(0, 1), function(*sides), rtol=0, atol=1e-11)


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_single_precision_has_the_nodes_of_double_precision_rounded(function: Any) -> None:
    nodes, sides = inputs(function, 2)
    single = [side.float() for side in sides]
    result = nodes(*single)
    assert result.dtype == torch.float32
    assert torch.equal(result, nodes(*(side.double() for side in single)).float())


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_grids_of_any_size_are_those_of_unit_size(function: Any) -> None:
    nodes, sides = inputs(function, 2)
    unit = nodes(*sides)
    for size in (2.0**-500, 2.0**500):
        scaled = [(side * size).requires_grad_() for side in sides]
        result = nodes(*scaled)
        torch.testing.assert_close(result.detach() / size, unit, rtol=0, atol=1e-11)
        (result / size).sum().backward()
        assert all(bool(side.grad.isfinite().all()) for side in scaled)


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_an_empty_batch_has_no_grids(function: Any) -> None:
    nodes, sides = inputs(function, 1)
    none = [side[:0].requires_grad_() for side in sides]
    result = nodes(*none)
    assert result.shape == (0, *nodes(*sides).shape[1:])
    result.sum().backward()
    assert none[0].grad.shape == none[0].shape


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_grids_are_made_in_inference_mode_too(function: Any) -> None:
    nodes, sides = inputs(function, 1)
    with torch.inference_mode():
        result = nodes(*sides)
    torch.testing.assert_close(result, nodes(*sides), rtol=0, atol=1e-11)


def test_sides_keep_their_nodes_and_dtype() -> None:
    sides = [side.float() for side in sides_of(domains(17, 9, 3))]
    nodes = layer.winslow(*sides)
    assert nodes.dtype == torch.float32
    for side, edge in zip(sides, (nodes[:, :, 0], nodes[:, :, -1], nodes[:, 0], nodes[:, -1]), strict=True):
        assert torch.equal(side, edge)


def test_one_side_serves_a_whole_batch() -> None:
    south, north, west, east = sides_of(domains(9, 8, 5)[:1])
    souths = south + torch.zeros(2, 3, 1, 1)
    assert layer.winslow(souths, north[0], west[0], east[0]).shape == (2, 3, 9, 8, 2)
