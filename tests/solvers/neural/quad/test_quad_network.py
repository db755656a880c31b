"""The quad network's layers against plain numpy, and the whole against torch and its own symmetries."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from relabelling import relabelled

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.kernels._native import (
    LayerProgram,
    activate,
    convolve,
    grid_features,
    upsample,
)
from meshonet.solvers.neural.quad.encoding import FEATURES, features
from meshonet.solvers.neural.quad.network import CHUNK, Network, shapes
from meshonet.solvers.neural.quad.picard import approach
from meshonet.solvers.neural.quad.symmetry import ORDER

WIDTHS, BLOCKS = (1, 2, 3), (0, 1, 2)
CLOSE: dict[Any, float] = {np.float32: 2e-5, np.float64: 1e-13}


def plain(x: Floats, kernel: Floats, bias: Floats, stride: int) -> Floats:
    """Convolve (batch, n, n, in) with (out, in, size, size), one tap after another."""
    size, n = kernel.shape[-1], x.shape[1]
    m = (n - size) // stride + 1
    out = np.zeros((len(x), m, m, len(kernel))) + bias
    for i in range(size):
        for j in range(size):
            stop = stride * (m - 1) + 1
            out += x[:, i : i + stop : stride, j : j + stop : stride] @ kernel[:, :, i, j].T
    return out


def packed(kernel: Floats, bias: Floats, dtype: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    out, into, size, _ = kernel.shape
    per = 64 // np.dtype(dtype).itemsize
    weight = np.zeros((size * size * into, -(-out // per) * per), dtype)
    weight[:, :out] = kernel.transpose(2, 3, 1, 0).reshape(-1, out)
    biases = np.zeros(weight.shape[1], dtype)
    biases[:out] = bias
    return weight, biases


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("more", [False, True])
@pytest.mark.parametrize(
    ("n", "into", "out", "size", "stride"),
    [(35, 16, 16, 3, 1), (35, 8, 24, 3, 2), (19, 24, 40, 3, 1), (11, 16, 48, 3, 1), (7, 8, 64, 3, 1),
     (5, 16, 48, 1, 1), (9, 17, 72, 1, 1), (5, 3, 100, 3, 1), (33, 16, 4, 1, 1), (3, 8, 8, 3, 1)],
)  # fmt: skip
def test_the_compiled_convolution_is_the_plain_one(
    n: int, into: int, out: int, size: int, stride: int, more: bool, dtype: Any
) -> None:
    rng = np.random.default_rng(0)
    x = rng.normal(size=(2, n, n, into)).astype(dtype)
    kernel = rng.normal(size=(out, into, size, size)).astype(dtype)
    bias = rng.normal(size=out).astype(dtype)
    expected = plain(x.astype(float), kernel.astype(float), bias.astype(float), stride)
    add = rng.normal(size=expected.shape).astype(dtype) if more else None
    result = np.full(expected.shape, np.nan, dtype)
    convolve(x, *packed(kernel, bias, dtype), size, stride, add, result)
    expected += 0.0 if add is None else add
    np.testing.assert_allclose(result, expected, rtol=0, atol=CLOSE[dtype] * np.abs(expected).max())


def test_a_convolution_of_arrays_that_do_not_fit_is_refused() -> None:
    x, out = np.zeros((1, 5, 5, 8)), np.zeros((1, 3, 3, 8))
    weight, bias = packed(np.zeros((8, 8, 3, 3)), np.zeros(8), np.float64)
    with pytest.raises(ValueError, match="is needed"):
        convolve(x, weight[1:], bias, 3, 1, None, out)
    with pytest.raises(ValueError, match="is needed"):
        convolve(x, weight, bias, 3, 2, None, out)
    with pytest.raises(ValueError, match="is needed"):
        convolve(x, weight, bias, 3, 1, x, out)
    with pytest.raises(ValueError, match="smaller than the kernel"):
        convolve(x[:, :2, :2].copy(), weight, bias, 3, 1, None, out)


@pytest.mark.parametrize(("dtype", "close"), [(np.float32, 1e-6), (np.float64, 2e-15)])
def test_activation_is_accurate_and_padded(dtype: Any, close: float) -> None:
    x = np.linspace(-60, 60, 2 * 7 * 7 * 24).astype(dtype).reshape(2, 7, 7, 24)
    x[0, 0, 0, :4] = -3e4, 3e4, 0, -1e-30
    result = np.full((2, 9, 9, 24), np.nan, dtype)
    activate(x, result)
    exact = x.astype(float)
    expected = exact * np.exp(np.minimum(exact, 0)) / (1 + np.exp(-np.abs(exact)))
    np.testing.assert_allclose(result[:, 1:-1, 1:-1], expected, rtol=close, atol=1e-25)
    result[:, 1:-1, 1:-1] = 0
    assert not result.any()


def test_activation_without_padding_is_what_stands_inside_it() -> None:
    x = np.random.default_rng(0).normal(size=(2, 7, 5, 8))
    padded, bare = np.empty((2, 9, 7, 8)), np.empty_like(x)
    activate(x, padded)
    activate(x, bare)
    np.testing.assert_array_equal(bare, padded[:, 1:-1, 1:-1])


def test_recorded_layers_do_what_they_do_at_once_for_fewer_of_a_batch_too() -> None:
    rng = np.random.default_rng(0)
    x, active, out = rng.normal(size=(3, 5, 5, 8)), np.empty((3, 7, 7, 8)), np.empty((3, 5, 5, 16))
    kernel = packed(rng.normal(size=(16, 8, 3, 3)), rng.normal(size=16), np.float64)
    later = LayerProgram()
    for program in (None, later):
        activate(x, active, False, program)
        convolve(active, *kernel, 3, 1, None, out, program)
    result = np.empty((2, 5, 5, 16))
    later.run(x[1:], result)
    np.testing.assert_array_equal(result, out[1:])
    with pytest.raises(ValueError, match="a batch of another size"):
        later.run(x, result)
    with pytest.raises(ValueError, match="arrays of other shapes than the layers"):
        later.run(x[1:].astype(np.float32), result)
    with pytest.raises(ValueError, match="arrays of other shapes than the layers"):
        LayerProgram().run(x, result)


def test_a_program_holds_so_many_layers() -> None:
    x, later = np.zeros((1, 3, 3, 8)), LayerProgram()
    for _ in range(256):
        activate(x, np.empty_like(x), False, later)
    with pytest.raises(ValueError, match="too many layers"):
        activate(x, np.empty_like(x), False, later)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_finer_copies_are_linear_between_nodes(dtype: Any) -> None:
    rng = np.random.default_rng(0)
    x, add = rng.normal(size=(2, 5, 5, 8)).astype(dtype), rng.normal(size=(2, 9, 9, 8)).astype(dtype)
    result = np.empty_like(add)
    upsample(x, add, result)
    matrix = np.maximum(0.0, 1.0 - np.abs(np.arange(9)[:, None] / 2 - np.arange(5)))
    expected = add + np.einsum("ip,jq,bpqc->bijc", matrix, matrix, x)
    np.testing.assert_allclose(result, expected, rtol=0, atol=8 * np.finfo(dtype).eps)


def test_compiled_features_are_those_in_numpy() -> None:
    z = grids(17)
    near, step = approach(z, np)
    result = np.empty((2, 17, 17, FEATURES))
    grid_features(planes(near), planes(step), result)
    np.testing.assert_allclose(result, features(near, step, np), rtol=0, atol=1e-12)


def planes(values: Complexes) -> Floats:
    return np.stack([values.real, values.imag], axis=1)


def grids(n: int, count: int = 2) -> Complexes:
    rng = np.random.default_rng(0)
    t = np.linspace(-0.5, 0.5, n)
    noise = rng.normal(size=(2, count, n, n))
    return np.asarray(t[:, None] + 1j * t + 0.2 / n * (noise[0] + 1j * noise[1]))


def seen_of(z: Complexes) -> Floats:
    return np.asarray(features(*approach(z, np), np))


def weights(dtype: Any = np.float64) -> dict[str, NDArray[Any]]:
    rng = np.random.default_rng(0)
    return {
        name: (rng.normal(size=shape) * (2.0 / np.prod(shape[1:])) ** 0.5).astype(dtype)
        for name, shape in shapes(WIDTHS, BLOCKS, 2).items()
    }


@pytest.mark.parametrize("element", range(ORDER))
def test_the_answer_to_a_relabelled_grid_is_the_relabelled_answer(element: int) -> None:
    z, network = grids(17), Network(weights(), BLOCKS)
    answer = network(seen_of(z))
    moved = network(seen_of(relabelled(z, element)))
    np.testing.assert_allclose(moved, relabelled(answer, element), rtol=0, atol=1e-12 * np.abs(answer).max())


def test_the_answer_vanishes_on_the_rim_alone() -> None:
    answer = Network(weights(), BLOCKS)(seen_of(grids(17)))
    assert not answer[..., [0, -1], :].any()
    assert not answer[..., [0, -1]].any()
    assert (answer[..., 1:-1, 1:-1] != 0).all()


def test_a_batch_is_answered_as_each_of_it() -> None:
    seen, network = seen_of(grids(17, CHUNK + 3)), Network(weights(), BLOCKS)
    together = network(seen)
    for k in range(len(seen)):
        np.testing.assert_array_equal(network(seen[k : k + 1])[0], together[k])
        np.testing.assert_array_equal(network(seen[k : k + 1], head=1)[0], together[k, 1])


def test_single_precision_is_close_to_double() -> None:
    seen = seen_of(grids(17))
    double, single = (Network(weights(), BLOCKS, dtype)(seen) for dtype in (np.float64, np.float32))
    np.testing.assert_allclose(single, double, rtol=0, atol=1e-5 * np.abs(double).max())


def test_numpy_equals_torch() -> None:
    torch = pytest.importorskip("torch")
    from meshonet.solvers.neural.fit.networks import QuadUNet

    model = QuadUNet(WIDTHS, BLOCKS).double()
    held = weights()
    assert {name: tuple(value.shape) for name, value in model.state_dict().items()} == shapes(
        WIDTHS, BLOCKS, 2
    )
    model.load_state_dict({name: torch.from_numpy(value) for name, value in held.items()})
    seen = seen_of(grids(17))
    with torch.no_grad():
        expected = model(torch.from_numpy(seen)).numpy()
    result = Network(held, BLOCKS)(seen)
    np.testing.assert_allclose(result, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
