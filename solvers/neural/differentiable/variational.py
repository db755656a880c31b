"""The variational optimum in torch: converged grids of batches, and their gradients.

Newton's method starts from the grids of the compiled solver, which also chooses the weight of the edge
lengths for each member. Where the Hessian is not positive definite, it is moved towards its convex part, cell
by cell, no further than needed; where a step folds cells or does not lower the functional, it is halved.

Nocedal and Wright, Numerical Optimization (2006), section 3.4; Teran, Sifakis, Irving, Fedkiw, Robust
quasistatic finite elements and flesh simulation, SCA 2005 (the convex part).
"""

from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.solvers.energy.functional import Weights, value
from meshonet.solvers.energy.untangle import widen
from meshonet.solvers.energy.variational import solve
from meshonet.solvers.neural.differentiable.block_cholesky import BlockCholesky, storage
from meshonet.solvers.neural.differentiable.functional import (
    Functional,
    Stencil,
    aspect_of,
    smallest_jacobian,
)
from meshonet.solvers.neural.differentiable.implicit import bordered, inner
from meshonet.solvers.neural.differentiable.members import MemberError, check_finite

START, MOST = 1e-8, 1000  # tolerance and iterations of the compiled solver
STILL = 1e-10  # displacement of a node, relative to its shortest edge, at which a member has converged
ROUNDED = 1e-15  # displacement, relative to the largest coordinate, that rounding of the nodes hides
KEPT = 1e-3  # the same below which the next step takes the same factor
STEPS = 500  # of Newton's method at the most; few domains take more than 5, nearly degenerate ones up to 250
HALVINGS = 30  # of a step
FALL = 1e-4  # part of the decrease that the slope promises which a step has to reach
ROUNDING = 1e-13  # of the functional, relative, by which it may rise
CONVEX = 0.0, 1e-3, 1e-2, 0.1, 0.3, 1.0  # shares of the way from the Hessian to its convex part
HARD = 20.0  # value of the functional above which the compiled solver is far from an optimum
LARGEST = 2**34  # bytes of the factors of one member
FACTORS = 2**28, 2**33  # bytes of factors at once, on a CPU and on a GPU


class Optimum:
    """The equations of the variational optimum: the gradient of the functional is zero at inner nodes."""

    def most(self, nodes: Tensor) -> int:
        """Return the number of members to solve at once, so that their factors fit in the memory.

        Raises InputError: the factors of a single one are too large.
        """
        ni, nj = nodes.shape[2:]
        if storage(ni, nj) > LARGEST:
            problem = f"the optimum of {ni} x {nj} nodes needs factors of {storage(ni, nj) / 1e9:.0f} GB"
            raise InputError(problem, "use coarse=129, fewer nodes, or layer.winslow")
        return FACTORS[nodes.is_cuda] // storage(*nodes.shape[2:])

    def solve(self, nodes: Tensor) -> tuple[Tensor, Tensor]:
        """Return the optimum, and the weight (batch,) of the edge lengths."""
        check_finite(nodes)
        starts, weights = zip(*_compiled(nodes.detach().cpu().numpy()), strict=True)
        smoothness = torch.tensor(weights, dtype=nodes.dtype, device=nodes.device)
        start = torch.from_numpy(np.stack(starts)).to(nodes)
        return newton(nodes + bordered(inner(start - nodes)), smoothness), smoothness

    def adjoint(self, nodes: Tensor, number: Tensor, gradient: Tensor) -> Tensor:
        """Return the derivative of a functional with respect to the boundary nodes of an optimum."""
        functional = Functional(Weights().shape, number)
        with torch.enable_grad():
            x = nodes.detach().requires_grad_()
            (slope,) = torch.autograd.grad(functional.value(x, aspect_of(x)).sum(), x, create_graph=True)
        factor = BlockCholesky(functional.hessian(nodes, aspect_of(nodes)))
        share = bordered(factor.solve(inner(gradient)))
        return gradient - torch.autograd.grad(slope, x, share)[0]


def newton(nodes: Tensor, smoothness: Tensor) -> Tensor:
    """Return the optimum (batch, 2, ni, nj) from valid `nodes` near it.

    Raises MemberError, with the members that have not converged.
    """
    nodes = nodes.clone()
    moving = torch.arange(len(nodes), device=nodes.device)
    share = torch.zeros_like(moving)
    line = None
    for _ in range(STEPS):
        if line is None:
            line = _Quadratic(nodes[moving], Functional(Weights().shape, smoothness[moving]), share)
        state = line.stepped(nodes[moving])
        nodes[moving] = state.nodes
        far = ~(state.moved <= STILL)  # true where it is not a number
        if not bool(far.any()):
            return nodes
        if not bool(far.all()) or not bool(((state.moved < KEPT) & (line.share == 0)).all()):
            moving, share, line = moving[far], (line.share[far] - 1).clamp_min(0), None
    raise MemberError.of(moving.tolist(), "the variational optimum did not converge", "use layer.winslow")


class _Step(NamedTuple):
    nodes: Tensor
    moved: Tensor
    """(batch,) largest displacement of a node in its shortest edges."""


class _Quadratic:
    """The functional near `nodes`, by its Hessian, or by a convex matrix where that is not positive.

    `share` (batch,) is the index in `CONVEX` of the first share to try; the attribute is that of the share
    that was taken.
    """

    def __init__(self, nodes: Tensor, functional: Functional, share: Tensor) -> None:
        self._functional, self._aspect, self.share = functional, aspect_of(nodes), share
        stencil = exact = functional.hessian(nodes, self._aspect)
        convex: Stencil = {}
        while True:
            if bool(self.share.any()):
                convex = convex or functional.hessian(nodes, self._aspect, convex=True)
                part = torch.tensor(CONVEX).to(nodes)[self.share][:, None, None, None, None]
                stencil = {key: torch.lerp(exact[key], convex[key], part) for key in exact}
            self._factor = BlockCholesky(stencil)
            more = ~self._factor.positive & (self.share < len(CONVEX) - 1)
            if not bool(more.any()):
                return
            self.share = self.share + more

    def stepped(self, nodes: Tensor) -> _Step:
        """Return the nodes after a step of Newton's method from `nodes`, shortened where it has to be."""
        with torch.enable_grad():
            x = nodes.detach().requires_grad_()
            value = self._functional.value(x, self._aspect)
            slope = inner(torch.autograd.grad(value.sum(), x)[0])
        value = value.detach()
        step = -self._factor.solve(slope)
        promise = FALL * (slope * step).sum((1, 2, 3))
        rounded = ROUNDED * nodes.abs().amax((1, 2, 3))[:, None, None]
        seen = (step.square().sum(1).sqrt() - rounded).clamp_min(0.0)
        far = (seen / inner(shortest_edges(nodes)[:, None])[:, 0]).amax((1, 2))
        size = torch.ones_like(far)
        for _ in range(HALVINGS):
            trial = nodes + bordered(size[:, None, None, None] * step)
            after = self._functional.value(trial, self._aspect)
            good = smallest_jacobian(trial) > 0
            good &= after <= value + size * promise + ROUNDING * value.abs()
            if bool(good.all()):
                break
            size = torch.where(good, size, 0.5 * size)
        return _Step(torch.where(good[:, None, None, None], trial, nodes), far)


def shortest_edges(nodes: Tensor) -> Tensor:
    """Return the length (batch, ni, nj) of the shortest edge at each of `nodes` (batch, 2, ni, nj)."""
    along, across = (nodes.diff(dim=axis).square().sum(1).sqrt() for axis in (2, 3))
    far = float("inf")
    shortest = torch.full_like(nodes[:, 0], far)
    for edge, low, high in ((along, (0, 0, 1, 0), (0, 0, 0, 1)), (across, (1, 0), (0, 1))):
        for way in (low, high):
            shortest = torch.minimum(shortest, torch.nn.functional.pad(edge, way, value=far))
    return shortest


def _compiled(batch: Floats) -> list[tuple[Floats, float]]:
    """Return the grids (2, ni, nj) of the compiled solver inside the boundary nodes of `batch`, and their β.

    Raises MemberError, with the members for which it finds no valid grid.
    """
    found, reasons = [], {}
    for member, nodes in enumerate(batch):
        sides = nodes[:, :, 0], nodes[:, :, -1], nodes[:, 0], nodes[:, -1]
        south, north, west, east = (np.ascontiguousarray(side.T) for side in sides)
        try:
            solution = solve(Boundary(south, north, west, east), tol=START, max_cycles=MOST)
        except MeshonetError as error:
            reasons[member] = str(error), "change its sides"
            continue
        if solution.notes:
            reasons[member] = "no grid without folded cells was found", "change its sides"
            continue
        weights = Weights(smoothness=solution.grid.provenance["smoothness"])
        start = solution.grid.nodes
        if value(start, weights) > HARD:
            widen(start, weights)
        found.append((np.moveaxis(start, -1, 0), weights.smoothness))
    if reasons:
        raise MemberError(reasons)
    return found
