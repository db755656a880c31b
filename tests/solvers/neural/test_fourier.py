"""FNO2D transforms by products with the few waves it keeps: the same as whole transforms and a mask."""

import numpy as np
import pytest
import torch

from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.models.architecture import Frame
from meshonet.solvers.neural.models.fourier import FNO2D


def masked(h: np.ndarray, weight: np.ndarray, model: FNO2D) -> np.ndarray:
    """Mix the lowest modes of whole transforms of h, which zeros continue."""
    (ni, nj), m = h.shape[1:3], model.modes
    size = (ni + model.padding, nj + model.padding)
    spectrum = np.fft.rfft2(h, size, (1, 2))
    mixed = np.zeros_like(spectrum)
    matrix = weight[..., 0] + 1j * weight[..., 1]
    for half, rows in ((matrix[:m], slice(0, m)), (matrix[m:], slice(-m, None))):
        mixed[:, rows, :m] = np.einsum("bmnc,mncd->bmnd", spectrum[:, rows, :m], half)
    return np.fft.irfft2(mixed, size, (1, 2))[:, :ni, :nj]


@pytest.mark.parametrize(("ni", "nj", "modes"), [(21, 33, 8), (20, 17, 5), (16, 40, 1)])
def test_a_fourier_layer_mixes_the_lowest_modes(ni: int, nj: int, modes: int) -> None:
    rng = np.random.default_rng(0)
    model = FNO2D(width=3, modes=modes)
    h, weight = rng.standard_normal((2, ni, nj, 3)), rng.standard_normal((2 * modes, modes, 3, 3, 2))
    result = model._mixed(np, weight, h)
    assert result.dtype == np.float64
    assert result == pytest.approx(masked(h, weight, model), abs=1e-12)
    by_torch = model._mixed(torch, torch.from_numpy(weight), torch.from_numpy(h))
    assert by_torch.numpy() == pytest.approx(result, abs=1e-12)
    single = model._mixed(torch, torch.from_numpy(weight).float(), torch.from_numpy(h).float())
    assert single.dtype == torch.float32


def test_more_modes_than_the_grids_have_are_refused() -> None:
    frame = Frame("quad", 25, 31)
    assert FNO2D(modes=17).shapes(frame)["mix0/spectral"][:2] == (34, 17)
    for modes in (0, 18, 40):
        with pytest.raises(InputError, match=f"modes={modes} of grids of 25 x 31 nodes; use 1 to 17"):
            FNO2D(modes=modes).shapes(frame)
