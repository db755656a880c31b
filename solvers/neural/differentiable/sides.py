"""Shared parts of differentiable operators: the network, conversions of arrays."""

from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

import torch
from torch import Tensor

from meshonet.geometry.arrays import Topology
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.differentiable.arguments import batched
from meshonet.solvers.neural.differentiable.recorded import recorded
from meshonet.solvers.neural.fit.networks import QuadUNet
from meshonet.solvers.neural.operator import Operator
from meshonet.solvers.neural.quad.encoding import features
from meshonet.solvers.neural.quad.operator import QuadOperator
from meshonet.solvers.neural.registry import load

SHIPPED: dict[Topology, str] = {"quad": "quad-general", "o": "hole-o"}  # by topology


class NetworkGrids:
    """An operator of the quad network as a differentiable function.

    `model`: an operator, the name of a shipped one, or the path of a file; `device`: torch's name of the
    device; `dtype`: floating-point type of the arithmetic. Raises InputError: no such model, or one that
    cannot be read or makes grids of another topology.
    """

    topology: ClassVar[Topology]
    remedy: ClassVar[str]

    def __init__(
        self, model: str | Operator = "", device: str = "cpu", dtype: torch.dtype = torch.float64
    ) -> None:
        operator = load(model or SHIPPED[self.topology]) if isinstance(model, str) else model
        if not isinstance(operator, QuadOperator) or operator.topology != self.topology:
            raise InputError(f"model {operator.name} makes {operator.topology} grids", self.remedy)
        self._dtype, self._device, self._head = dtype, device, operator.head
        self._network = QuadUNet(operator.widths, operator.blocks, around=self.topology == "o")
        state = {name: torch.from_numpy(array) for name, array in operator.weights.items()}
        self._network.load_state_dict(state)
        self._network.to(device=device, dtype=dtype).requires_grad_(False)

    def _batched(self, make: Callable[..., Tensor], *sides: Tensor, nj: int | None = None) -> Tensor:
        return batched(partial(recorded, make), sides, nj, self._dtype, self._device)

    def _answer(self, near: Tensor, step: Tensor) -> Tensor:
        return self._network(features(near, step, torch, self.topology == "o"))[:, self._head]


def as_complex(planes: Tensor) -> Tensor:
    """Return planes (batch, 2, ...) of x and y as x + iy."""
    return torch.complex(planes[:, 0], planes[:, 1])


def as_planes(z: Tensor) -> Tensor:
    """Return complex numbers (batch, ...) as planes (batch, 2, ...) of x and y."""
    return torch.stack([z.real, z.imag], 1)


def as_numpy(values: Tensor) -> Any:
    """Return `values` as a NumPy array, without gradients."""
    return values.detach().cpu().numpy()
