"""The minimum of the variational functional in torch: on a coarse copy, and splines from there.

The compiled solver comes near the minimum of each coarse copy, on the CPU. Newton's method with dense Hessians,
for all members at once, makes it exact; the last Hessian gives the gradients, by the implicit function theorem
(`meshonet.solvers.derivatives.optimum`).
"""

from typing import Any

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.differentiable.functional import energy, slopes
from meshonet.solvers.differentiable.members import MemberError, as_one_batch, check_finite
from meshonet.solvers.differentiable.resample import between, refined
from meshonet.solvers.differentiable.transfinite import Sides, arc_lengths, interpolated
from meshonet.solvers.differentiable.winslow import bordered, inner
from meshonet.solvers.energy.descent import descend
from meshonet.solvers.energy.functional import Weights
from meshonet.solvers.energy.variational import winslow_start

COARSE = 17  # nodes along a direction of the copy on which the functional is minimised, at the most
NEAR = 1e-7  # `tol` of the compiled descent that precedes Newton's method
STILL = 1e-11  # step of Newton's method, relative to the extent, at which a grid is converged
STEPS = 3000, 12  # of the compiled descent, of Newton's method, at the most


def minimised(sides: Sides, weights: Weights) -> Tensor:
    """Return nodes (batch, 2, ni, nj), float64, by splines from the minimum on a coarse copy of `sides`.

    Raises MemberError, with the index of the first member of the batch without a valid minimum.
    """
    counts = [min(side.shape[-1], COARSE) for side in sides]
    few = tuple(between(side, n) for side, n in zip(sides, counts, strict=True))
    laws = tuple(between(law, n) for law, n in zip(arc_lengths(sides), counts, strict=True))
    coarse = Minimum.apply(interpolated(few, laws), weights)  # type: ignore[arg-type]
    same = counts[0] == sides[0].shape[-1] and counts[2] == sides[2].shape[-1]
    return coarse if same else refined(coarse, sides)  # type: ignore[no-any-return]


class Minimum(torch.autograd.Function):
    """From nodes (batch, 2, m, n), of which only those of the boundary count, to the minimum."""

    @staticmethod
    def forward(nodes: Tensor, weights: Weights) -> Tensor:
        """Return the minimum with the boundary nodes of `nodes`."""
        check_finite(nodes)
        return _converged(_start(nodes, weights), weights)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Tensor, Weights], output: Tensor) -> None:
        """Keep the minimum."""
        ctx.save_for_backward(output)
        ctx.weights = inputs[1]

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, None]:
        """Return the derivative with respect to the boundary nodes, zero at inner nodes."""
        return Pulled.apply(*ctx.saved_tensors, gradient, ctx.weights), None

    @staticmethod
    def vmap(info: Any, in_dims: Any, nodes: Tensor, weights: Weights) -> tuple[Tensor, int]:
        """Minimise all members of both batches as one batch."""
        return as_one_batch(lambda x: Minimum.apply(x, weights), info.batch_size, in_dims[:1], nodes)


class Pulled(torch.autograd.Function):
    """The derivative with respect to boundary nodes, from that with respect to all nodes of a minimum."""

    @staticmethod
    def forward(nodes: Tensor, gradient: Tensor, weights: Weights) -> Tensor:
        """Return the derivative (batch, 2, m, n), zero at inner nodes."""
        _, hessian = slopes(nodes, weights)
        solution = torch.linalg.solve(hessian, inner(gradient).flatten(1)).view_as(inner(gradient))
        with torch.enable_grad():
            x = nodes.detach().requires_grad_()
            slope = torch.autograd.grad(energy(x, weights).sum(), x, create_graph=True)[0]
            result = gradient - torch.autograd.grad(inner(slope), x, solution)[0]
        inner(result).zero_()
        return result

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Tensor) -> None:
        """Keep nothing: second derivatives are not available."""

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> None:
        """Raise NotImplementedError: there are no second derivatives."""
        raise NotImplementedError("variational grids have no second derivatives")

    @staticmethod
    def vmap(
        info: Any, in_dims: Any, nodes: Tensor, gradient: Tensor, weights: Weights
    ) -> tuple[Tensor, int]:
        """Solve all members of both batches as one batch."""
        apply = lambda x, g: Pulled.apply(x, g, weights)  # noqa: E731
        return as_one_batch(apply, info.batch_size, in_dims[:2], nodes, gradient)


def _start(nodes: Tensor, weights: Weights) -> Tensor:
    """Return grids near the minimum, by the compiled solver, one member after another."""
    z = nodes.detach().movedim(1, -1).cpu().numpy()
    starts = []
    for k, member in enumerate(z):
        boundary = Boundary(member[:, 0], member[:, -1], member[0], member[-1])
        start = winslow_start(boundary).copy(order="K")
        if not descend(start, weights, NEAR, STEPS[0])[1]:
            raise MemberError(k, "no grid without folded cells was reached", "use solve_pde for this boundary")
        starts.append(start)
    return torch.as_tensor(np.stack(starts)).movedim(-1, 1).to(nodes)


def _converged(nodes: Tensor, weights: Weights) -> Tensor:
    """Return the minima near `nodes` (batch, 2, m, n), by Newton's method."""
    nodes = nodes.clone()
    extent = (nodes.amax((2, 3)) - nodes.amin((2, 3))).amax(1)
    moving = torch.arange(len(nodes), device=nodes.device)
    for _ in range(STEPS[1]):
        x = nodes[moving]
        slope, hessian = slopes(x, weights)
        factor, failed = torch.linalg.cholesky_ex(hessian)
        if bool((failed > 0).any()):
            break
        step = torch.cholesky_solve(slope[:, :, None], factor).view_as(inner(x))
        nodes[moving] = x - bordered(step)
        moving = moving[step.abs().amax((1, 2, 3)) > STILL * extent[moving]]
        if not len(moving):
            return nodes
    problem = "the variational functional has no isolated minimum"
    raise MemberError(int(moving[0]), problem, "use solve_pde for this boundary")
