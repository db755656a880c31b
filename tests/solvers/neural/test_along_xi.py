"""Layers of the wavelet, Koopman and Laplace neural operators do what their papers say."""

import numpy as np
import pytest
import torch
from families import arches
from scipy.integrate import solve_ivp

from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.fit.operators import OperatorTask
from meshonet.solvers.neural.models.along_xi import WNO, respond, wavelets
from meshonet.solvers.neural.models.architecture import Frame
from meshonet.solvers.neural.models.architectures import architecture
from meshonet.solvers.neural.models.fourier import mix_modes


@pytest.mark.parametrize(("n", "levels"), [(16, 1), (112, 3), (16, 4)])
def test_wavelets_are_orthonormal(n: int, levels: int) -> None:
    functions = wavelets(n, levels)
    assert functions.shape == (2 * (n >> levels), n)
    np.testing.assert_allclose(functions @ functions.T, np.eye(len(functions)), atol=1e-12)


def test_wavelets_have_four_vanishing_moments() -> None:
    """Of a cubic the details are zero, except where the period begins."""
    details = wavelets(64, 1)[32:] @ np.linspace(-1.0, 1.0, 64) ** 3
    assert np.abs(details[:28]).max() < 1e-12 < 1e-3 < np.abs(details[28:]).max()


def test_a_wavelet_layer_of_unit_matrices_changes_nothing() -> None:
    model = WNO(width=3, levels=2)
    h = np.random.default_rng(0).standard_normal((2, 21, 3))
    count = model.layer_shapes(Frame("quad", 21, 9))["kernel0/weight"][0]
    unit = np.broadcast_to(np.eye(3), (count, 3, 3))
    np.testing.assert_allclose(model._convolved(np, unit, h), h, atol=1e-12)
    assert np.abs(model._convolved(np, 0.0 * unit, h) - h).max() > 0.1


def test_more_levels_than_the_nodes_permit_are_refused() -> None:
    with pytest.raises(InputError, match="levels=5 of grids of 21 nodes along xi"):
        architecture("wno", "quad", {"levels": 5}).shapes(Frame("quad", 21, 21))


def test_the_koopman_operator_is_one_matrix_for_all_its_modes() -> None:
    rng = np.random.default_rng(0)
    h, weight = rng.standard_normal((2, 20, 3)), rng.standard_normal((3, 3, 2))
    every = mix_modes(np, np.broadcast_to(weight, (6, 3, 3, 2)), h, 6, 4)
    np.testing.assert_allclose(mix_modes(np, weight, h, 6, 4), every, atol=1e-12)


def test_the_laplace_layer_integrates_linear_systems_from_rest() -> None:
    """Against Runge-Kutta of order 8, for an input of two frequencies and two real systems of a pole pair."""
    n, decay, turn, residue = 41, 3.0, 4.0, 2.0 - 0.7j
    xi, step = np.linspace(0.0, 1.0, n), 1.0 / (n - 1)
    omega = 2 * np.pi / (n * step)
    mu = -decay + 1j * np.pi * turn

    def signal(t: np.ndarray) -> np.ndarray:
        return 0.4 + np.cos(omega * t) - 0.5 * np.sin(3 * omega * t)

    poles = np.array([[[np.log(decay), turn]]])
    result = respond(np, poles, np.array([[[[residue.real, residue.imag]]]]), signal(xi)[None, :, None])
    exact = solve_ivp(lambda t, y: mu * y + signal(t), (0, 1), [0j], "DOP853", xi, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(result[0, :, 0], (residue * exact.y[0]).real, atol=1e-8)


def test_the_koopman_operator_learns_to_reconstruct_its_inputs() -> None:
    samples = arches()
    task = OperatorTask(architecture("kno", "quad"), samples, None, None, 0, torch.device("cpu"))
    assert task.parts == ("interior", "boundary", "penalty")
    parts = task.forward(torch.arange(len(samples)), 1)
    parts[2].backward()
    assert float(task.get_parameter("inputs/0/weight").grad.abs().max()) > 0
    none = OperatorTask(architecture("lno", "quad"), samples, None, None, 0, torch.device("cpu"))
    assert none.forward(torch.arange(len(samples)), 1).shape == (2,)
