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
from meshonet.solvers.energy.functional import Weights
from meshonet.solvers.energy.variational import solve
from meshonet.solvers.neural.differentiable.block_cholesky import BlockCholesky, storage
from meshonet.solvers.neural.differentiable.functional import Functional, aspect_of, smallest_jacobian
from meshonet.solvers.neural.differentiable.implicit import bordered, inner
from meshonet.solvers.neural.differentiable.members import MemberError, check_finite

START, MOST = 1e-8, 1000  # tolerance and iterations of the compiled solver
STILL = 1e-10  # displacement of a node, relative to its shortest edge, at which a member has converged
KEPT = 1e-3  # the same below which the next step takes the same factor
STEPS = 200  # of Newton's method at the most; few domains take more than 5, nearly degenerate ones some 70
HALVINGS = 30  # of a step
FALL = 1e-4  # part of the decrease that the slope promises which a step has to reach
ROUNDING = 1e-13  # of the functional, relative, by which it may rise
CONVEX = 1e-3, 1e-2, 0.1, 0.3, 1.0  # shares of the way from the Hessian to its convex part
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
        starts, weights = zip(*map(_compiled, range(len(nodes)), nodes.detach().cpu().numpy()), strict=True)
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

    Raises MemberError, with the index of the first member of the batch that has not converged.
    """
    nodes = nodes.clone()
    moving = torch.arange(len(nodes), device=nodes.device)
    line = None
    for _ in range(STEPS):
        if line is None:
            line = _Quadratic(nodes[moving], Functional(Weights().shape, smoothness[moving]))
        state = line.stepped(nodes[moving])
        nodes[moving] = state.nodes
        far = ~(state.moved <= STILL)  # true where it is not a number
        if not bool(far.any()):
            return nodes
        if not bool(far.all()) or not bool((state.moved < KEPT).all()):
            moving, line = moving[far], None
    raise MemberError(int(moving[0]), "the variational optimum did not converge", "use layer.winslow")


class _Step(NamedTuple):
    nodes: Tensor
    moved: Tensor
    """(batch,) largest displacement of a node in its shortest edges."""


class _Quadratic:
    """The functional near `nodes`, by its Hessian, or by a convex matrix where that is not positive."""

    def __init__(self, nodes: Tensor, functional: Functional) -> None:
        self._functional, self._aspect = functional, aspect_of(nodes)
        stencil = functional.hessian(nodes, self._aspect)
        self._factor = BlockCholesky(stencil)
        where = (~self._factor.positive).nonzero().flatten()
        if not len(where):
            return
        few = Functional(functional.shape, functional.smoothness[where])
        convex = few.hessian(nodes[where], self._aspect[where], convex=True)
        exact = {offset: blocks[where] for offset, blocks in stencil.items()}
        shares = torch.zeros_like(few.smoothness)
        for share in CONVEX:
            shares[~self._factor.positive[where]] = share
            for offset, blocks in stencil.items():
                part = torch.lerp(exact[offset], convex[offset], shares[:, None, None, None, None])
                blocks.index_copy_(0, where, part)
            self._factor = BlockCholesky(stencil)
            if bool(self._factor.positive.all()):
                return

    def stepped(self, nodes: Tensor) -> _Step:
        """Return the nodes after a step of Newton's method from `nodes`, shortened where it has to be."""
        with torch.enable_grad():
            x = nodes.detach().requires_grad_()
            value = self._functional.value(x, self._aspect)
            slope = inner(torch.autograd.grad(value.sum(), x)[0])
        value = value.detach()
        step = -self._factor.solve(slope)
        promise = FALL * (slope * step).sum((1, 2, 3))
        far = (step.square().sum(1).sqrt() / inner(shortest_edges(nodes)[:, None])[:, 0]).amax((1, 2))
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


def _compiled(member: int, nodes: Floats) -> tuple[Floats, float]:
    """Return the grid (2, ni, nj) of the compiled solver inside the boundary nodes of `nodes`, and its β."""
    sides = nodes[:, :, 0], nodes[:, :, -1], nodes[:, 0], nodes[:, -1]
    south, north, west, east = (np.ascontiguousarray(side.T) for side in sides)
    try:
        solution = solve(Boundary(south, north, west, east), tol=START, max_cycles=MOST)
    except MeshonetError as error:
        raise MemberError(member, str(error), "change its sides") from error
    if solution.notes:
        raise MemberError(member, "no grid without folded cells was found", "change its sides")
    return np.moveaxis(solution.grid.nodes, -1, 0), float(solution.grid.provenance["smoothness"])
