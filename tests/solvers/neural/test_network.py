"""The numpy network is the torch network."""

import numpy as np
import torch

from meshonet.solvers.conformal.strip import COLUMNS
from meshonet.solvers.neural.fit.networks import StripFNO
from meshonet.solvers.neural.strip.encoding import CHANNELS, SCALARS
from meshonet.solvers.neural.strip.network import StripNetwork


def test_numpy_equals_torch_to_round_off() -> None:
    torch.manual_seed(3)
    net = StripFNO(CHANNELS, SCALARS, 8, width=12, modes=20, layers=2).double()
    rng = np.random.default_rng(1)
    channels, scalars = rng.normal(size=(2, CHANNELS, COLUMNS)), rng.normal(size=(2, SCALARS))
    with torch.no_grad():
        wanted = net(torch.tensor(channels), torch.tensor(scalars)).numpy()
    weights = {name: value.numpy() for name, value in net.state_dict().items()}
    result = StripNetwork(weights)(channels, scalars)
    assert np.abs(result - wanted).max() <= 1e-12 * np.abs(wanted).max()


def test_the_network_commutes_with_shifts_of_theta() -> None:
    torch.manual_seed(4)
    net = StripFNO(CHANNELS, SCALARS, 4, width=8, modes=12, layers=2).double()
    weights = {name: value.numpy() for name, value in net.state_dict().items()}
    rng = np.random.default_rng(2)
    channels, scalars = rng.normal(size=(1, CHANNELS, COLUMNS)), rng.normal(size=(1, SCALARS))
    shifted = StripNetwork(weights)(np.roll(channels, 17, axis=2), scalars)
    np.testing.assert_allclose(
        shifted, np.roll(StripNetwork(weights)(channels, scalars), 17, axis=2), atol=1e-12
    )
