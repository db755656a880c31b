"""Functions that decide by the values of tensors, for `torch.func.vmap`, which cannot follow them."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import torch
from torch import Tensor

from meshonet.solvers.neural.differentiable.arguments import unit_of
from meshonet.solvers.neural.differentiable.members import (
    BatchFunction,
    FirstDerivative,
    check_finite,
    without_failed,
)


def recorded(
    function: Callable[..., Tensor], *sides: Tensor, counts: tuple[int, int] | None = None
) -> Tensor:
    """Return nodes (batch, ni, nj, 2) that `function` computes from `sides` (batch, n, 2), also under `vmap`.

    A batch member without a grid raises MemberError or, if its node `counts` (ni, nj) are given, gets NaN.
    """
    call = partial(_of_unit_size, function)
    if counts is not None:
        call = partial(without_failed, call, counts)
    return _Function.apply(_Record(call, torch.is_grad_enabled()), *sides)  # type: ignore[no-untyped-call]


def _of_unit_size(function: Callable[..., Tensor], *sides: Tensor) -> Tensor:
    """Return the value of `function` for `sides`, which it is given divided by a power of 2."""
    check_finite(*sides)
    unit = unit_of(torch.cat(sides, 1))
    return unit[..., None] * function(*(side / unit for side in sides))


@dataclass
class _Record:
    function: Callable[..., Tensor]
    wanted: bool
    sides: list[Tensor] = field(default_factory=list)
    nodes: Tensor | None = None


class _Function(BatchFunction):
    @staticmethod
    def forward(record: _Record, *sides: Tensor) -> Tensor:
        if not record.wanted:
            return record.function(*sides)
        with torch.enable_grad():
            record.sides = [side.detach().requires_grad_() for side in sides]
            record.nodes = record.function(*record.sides)
        return record.nodes.detach()

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Tensor) -> None:  # noqa: ARG004 - torch's signature
        ctx.record = inputs[0]

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor | None, ...]:
        return None, *_Pulled.apply(ctx.record, gradient)  # type: ignore[no-untyped-call]


class _Pulled(FirstDerivative):
    """The derivative with respect to the sides, from that with respect to the nodes."""

    @staticmethod
    def forward(record: _Record, gradient: Tensor) -> tuple[Tensor, ...]:
        if record.nodes is None or not record.nodes.requires_grad:  # no member has a grid
            return tuple(map(torch.zeros_like, record.sides))
        return torch.autograd.grad(record.nodes, record.sides, gradient, retain_graph=True)
