"""Gradients, by implicit differentiation, of grids x that solve R(x, b) = 0 for boundary nodes b.

A functional with the derivative g by x has the derivative -R_bᵀ λ by b, where R_xᵀ λ = g.
"""

from typing import Any, Protocol

import torch
from torch import Tensor

from meshonet.solvers.neural.differentiable.arguments import unit_of
from meshonet.solvers.neural.differentiable.members import BatchFunction, FirstDerivative, in_parts


class Equations(Protocol):
    """Equations for the inner nodes of four-sided grids, and their adjoint."""

    def most(self, nodes: Tensor) -> int:
        """Return how many grids of the batch `nodes` (batch, 2, ni, nj) should be solved at once."""
        ...

    def solve(self, nodes: Tensor) -> tuple[Tensor, Tensor]:
        """Return the solutions (batch, 2, ni, nj), and for each a number (batch,) that `adjoint` needs.

        Only the boundary nodes of `nodes` are used. Raises MemberError if a grid has no solution.
        """
        ...

    def adjoint(self, nodes: Tensor, number: Tensor, gradient: Tensor) -> Tensor:
        """Return derivatives (batch, 2, ni, nj) of a function of each grid with respect to boundary nodes.

        `nodes` and `number` (batch,) are the results of `solve`. `gradient` has the function's derivatives
        with respect to all nodes. The result is meaningless at inner nodes.
        """
        ...


class Converged(BatchFunction):
    """Torch function from the boundary nodes of grids to the solution of `Equations`, with gradients."""

    @staticmethod
    def forward(equations: Equations, nodes: Tensor) -> tuple[Tensor, Tensor]:
        """Return the result of `Equations.solve`."""
        unit = unit_of(nodes)
        solution, number = in_parts(equations.solve, equations.most(nodes), nodes / unit)
        return unit * solution, number

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Equations, Tensor], output: tuple[Tensor, Tensor]) -> None:
        """Keep the solution for `backward`."""
        ctx.equations = inputs[0]
        ctx.mark_non_differentiable(output[1])
        ctx.save_for_backward(*output)

    @staticmethod
    def backward(ctx: Any, gradient: Tensor, _: Tensor) -> tuple[None, Tensor]:
        """Return None for the equations, and a function's derivatives with respect to boundary nodes.

        `gradient` (batch, 2, ni, nj) has derivatives by all nodes. The result is 0 at inner nodes.
        """
        return None, Adjoint.apply(ctx.equations, *ctx.saved_tensors, gradient)  # type: ignore[no-untyped-call]


class Adjoint(FirstDerivative):
    """Torch function: derivatives with respect to boundary nodes from those with respect to all nodes."""

    @staticmethod
    def forward(equations: Equations, nodes: Tensor, number: Tensor, gradient: Tensor) -> Tensor:
        """Return the result of `Equations.adjoint` for these arguments, with 0 for inner nodes."""
        most, scaled = equations.most(nodes), nodes / unit_of(nodes)
        (result,) = in_parts(lambda *part: (equations.adjoint(*part),), most, scaled, number, gradient)
        inner(result).zero_()
        return result


def inner(nodes: Tensor) -> Tensor:
    """Return the inner nodes (batch, 2, ni-2, nj-2)."""
    return nodes[:, :, 1:-1, 1:-1]


def bordered(inner: Tensor) -> Tensor:
    """Return `inner` (batch, 2, mi, mj) with a border of zeros."""
    return torch.nn.functional.pad(inner, (1, 1, 1, 1))
