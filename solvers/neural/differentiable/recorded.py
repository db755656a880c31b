"""Makes `torch.func` applicable to functions whose decisions depend on the values of tensors.

`torch.func.vmap` cannot follow such decisions. The function is therefore called once for the whole batch, and
gradients come from the operations that torch recorded in the forward pass.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import torch
from torch import Tensor

from meshonet.solvers.neural.differentiable.arguments import unit_of
from meshonet.solvers.neural.differentiable.members import as_one_batch, check_finite


def recorded(function: Callable[..., Tensor], *sides: Tensor) -> Tensor:
    """Return the value of `function`, from sides (batch, n, 2) to nodes (batch, ni, nj, 2)."""
    return _Function.apply(_Record(function, torch.is_grad_enabled()), *sides)  # type: ignore[no-untyped-call]


@dataclass
class _Record:
    function: Callable[..., Tensor]
    wanted: bool
    sides: list[Tensor] = field(default_factory=list)
    nodes: Tensor | None = None


class _Function(torch.autograd.Function):
    @staticmethod
    def forward(record: _Record, *sides: Tensor) -> Tensor:
        for side in sides:
            check_finite(side)
        unit = unit_of(torch.cat(sides, 1))
        if not record.wanted:
            return unit[..., None] * record.function(*(side / unit for side in sides))
        with torch.enable_grad():
            record.sides = [side.detach().requires_grad_() for side in sides]
            record.nodes = unit[..., None] * record.function(*(side / unit for side in record.sides))
        return record.nodes.detach()

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Tensor) -> None:  # noqa: ARG004 - torch's signature
        ctx.record = inputs[0]

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor | None, ...]:
        return None, *_Pulled.apply(ctx.record, gradient)  # type: ignore[no-untyped-call]

    @staticmethod
    def vmap(info: Any, in_dims: Any, *inputs: Any) -> Any:
        return as_one_batch(_Function.apply, info.batch_size, in_dims, *inputs)


class _Pulled(torch.autograd.Function):
    """The derivative with respect to the sides, from that with respect to the nodes."""

    @staticmethod
    def forward(record: _Record, gradient: Tensor) -> tuple[Tensor, ...]:
        return torch.autograd.grad(record.nodes, record.sides, gradient, retain_graph=True)  # type: ignore[arg-type]

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: tuple[Tensor, ...]) -> None:
        """Keep nothing: second derivatives are not available."""

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> None:
        raise NotImplementedError("these grids have no second derivatives")

    @staticmethod
    def vmap(info: Any, in_dims: Any, *inputs: Any) -> Any:
        return as_one_batch(_Pulled.apply, info.batch_size, in_dims, *inputs)
