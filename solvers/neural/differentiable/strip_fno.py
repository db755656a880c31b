"""The strip network in torch, for training and for gradients."""

import torch
from torch import Tensor

from meshonet.solvers.neural.differentiable.named import NamedParameters
from meshonet.solvers.neural.strip.network import StripNetwork, shapes


class StripFNO(NamedParameters):
    """Channels and scalars of `meshonet.solvers.neural.strip.encoding` to `outputs` channels.

    `inputs`, `scalars`, `outputs`: channel counts; `width`, `modes`, `layers`: of the hidden state.
    """

    def __init__(
        self, inputs: int, scalars: int, outputs: int, width: int = 32, modes: int = 32, layers: int = 3
    ) -> None:
        wanted = shapes(inputs + scalars, outputs, width, (modes,) * (layers + 1))
        super().__init__({name: _initial(name, shape, wanted) for name, shape in wanted.items()})

    def forward(self, channels: Tensor, scalars: Tensor) -> Tensor:
        """(batch, inputs, columns), (batch, scalars) to (batch, outputs, columns)."""
        out: Tensor = StripNetwork(dict(self.named_parameters()), torch)(channels, scalars)
        return out


def _initial(name: str, shape: tuple[int, ...], shapes: dict[str, tuple[int, ...]]) -> Tensor:
    """Return first values: spectral ones normal over their inputs, others uniform as torch's layers have."""
    if name.startswith("spectral"):
        return torch.randn(shape) / shape[1]
    _, inputs, taps = shapes[name.replace("bias", "weight")]
    return (2.0 * torch.rand(shape) - 1.0) / (inputs * taps) ** 0.5
