"""The optimum of the variational functional in torch, by Newton's method, and its gradients.

Nocedal and Wright, Numerical Optimization (2006), section 3.4; Teran et al., SCA 2005 (the convex part).
"""

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.solvers.energy.functional import Weights, value
from meshonet.solvers.energy.untangle import widen
from meshonet.solvers.energy.variational import solve
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
        """Return how many grids can be solved at once; their Cholesky factors must fit into memory.

        Raises InputError if the factor of one grid is too large.
        """
        ni, nj = nodes.shape[2:]
        if storage(ni, nj) > LARGEST:
            problem = f"the optimum of {ni} x {nj} nodes needs factors of {storage(ni, nj) / 1e9:.0f} GB"
            raise InputError(problem, "use coarse=129, fewer nodes, or layer.winslow")
        return FACTORS[nodes.is_cuda] // storage(*nodes.shape[2:])

    def solve(self, nodes: Tensor) -> tuple[Tensor, Tensor]:
        """Return the optimal grids (batch, 2, ni, nj), and the weights (batch,) of their smoothness term."""
        check_finite(nodes)
        starts, weights = zip(*_compiled(nodes.detach().cpu().numpy()), strict=True)
        smoothness = torch.tensor(weights, dtype=nodes.dtype, device=nodes.device)
        start = torch.from_numpy(np.stack(starts)).to(nodes)
        return newton(nodes + bordered(inner(start - nodes)), smoothness), smoothness

    def adjoint(self, nodes: Tensor, number: Tensor, gradient: Tensor) -> Tensor:
        """Return derivatives (batch, 2, ni, nj) of a function of each grid with respect to boundary nodes.

        `nodes` are the grids that `solve` returns, `number` (batch,) the weights of their smoothness terms.
        `gradient` has the function's derivatives by all nodes. The result is meaningless at inner nodes.
        """
        functional = Functional(Weights().shape, number)
        with torch.enable_grad():
            x = nodes.detach().requires_grad_()
            (slope,) = torch.autograd.grad(functional.value(x, aspect_of(x)).sum(), x, create_graph=True)
        factor = BlockCholesky(functional.hessian(nodes, aspect_of(nodes)))
        share = bordered(factor.solve(inner(gradient)))
        return gradient - torch.autograd.grad(slope, x, share)[0]


def newton(nodes: Tensor, smoothness: Tensor) -> Tensor:
    """Return the minima (batch, 2, ni, nj) of the variational functional near the unfolded grids `nodes`.

    `smoothness` (batch,) weights its smoothness term. Raises MemberError with grids that do not converge.
    """
    nodes = nodes.clone()
    moving = torch.arange(len(nodes), device=nodes.device)
    share = torch.zeros_like(moving)
    line = None
    for _ in range(STEPS):
        if line is None:
            line = _Quadratic(nodes[moving], Functional(Weights().shape, smoothness[moving]), share)
        nodes[moving], moved = line.stepped(nodes[moving])
        far = ~(moved <= STILL)  # true where it is not a number
        if not bool(far.any()):
            return nodes
        if not bool(far.all()) or not bool(((moved < KEPT) & (line.share == 0)).all()):
            moving, share, line = moving[far], (line.share[far] - 1).clamp_min(0), None
    raise MemberError.of(moving.tolist(), "the variational optimum did not converge", "use layer.winslow")


class _Quadratic:
    """The functional near `nodes`, by its Hessian, or by a convex matrix where that is not positive.

    `share` (batch,) is the index in `CONVEX` of the first share to try, then of the share that was taken.
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

    def stepped(self, nodes: Tensor) -> tuple[Tensor, Tensor]:
        """Return `nodes` after a damped Newton step, and the largest moves (batch,) over shortest edges."""
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
        return torch.where(good[:, None, None, None], trial, nodes), far


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
    """Return the compiled solver's grids (2, ni, nj) and their β. Raises MemberError: no valid grid."""
    optima, reasons = [], {}
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
        optima.append((np.moveaxis(start, -1, 0), weights.smoothness))
    if reasons:
        raise MemberError(reasons)
    return optima


class BlockCholesky:
    """The Cholesky factors of a batch of matrices that are given as stencils at inner nodes.

    `positive` (batch,) tells which matrices are positive definite, so that they have a factor. Golub and Van
    Loan, Matrix Computations (2013), section 4.5.
    """

    def __init__(self, stencil: Stencil) -> None:
        self._turned = stencil[0, 0].shape[3] < stencil[0, 0].shape[4]
        diagonal, beside = _blocks(_turned(stencil) if self._turned else stencil)
        self._factors: list[Tensor] = []
        self._beside: list[Tensor] = []
        self.positive = torch.ones(len(diagonal), dtype=torch.bool, device=diagonal.device)
        for k in range(diagonal.shape[1]):
            block = diagonal[:, k]
            if k:
                solved = torch.linalg.solve_triangular(self._factors[-1], beside[:, k - 1].mT, upper=False)
                self._beside.append(solved.mT)
                block = block - solved.mT @ solved
            factor, failed = torch.linalg.cholesky_ex(block)
            self._factors.append(factor)
            self.positive &= failed == 0

    def solve(self, right: Tensor) -> Tensor:
        """Return the solutions (batch, 2, mi, mj) for right-hand sides `right` of the same shape."""
        right = right.mT if self._turned else right
        rows = list(_by_blocks(right).unbind(1))
        for k, factor in enumerate(self._factors):
            if k:
                rows[k] = rows[k] - self._beside[k - 1] @ rows[k - 1]
            rows[k] = torch.linalg.solve_triangular(factor, rows[k], upper=False)
        for k in reversed(range(len(rows))):
            if k + 1 < len(rows):
                rows[k] = rows[k] - self._beside[k].mT @ rows[k + 1]
            rows[k] = torch.linalg.solve_triangular(self._factors[k].mT, rows[k], upper=True)
        mi, mj = right.shape[2:]
        lines = torch.stack(rows, 1).view(len(right), -1, mj, 2)
        solution = lines[:, :mi].movedim(-1, 1)
        return solution.mT if self._turned else solution


def storage(ni: int, nj: int) -> int:
    """Return the approximate size in bytes of the Cholesky factor for one grid with ni x nj nodes."""
    return 256 * max(ni, nj) * min(ni, nj) ** 2


def _turned(stencil: Stencil) -> Stencil:
    turned = {}
    for (di, dj), blocks in stencil.items():
        if dj < 0:  # held by the other node, from which it is an offset with positive dj
            turned[-dj, -di] = blocks.roll((di, dj), (3, 4)).transpose(1, 2).mT
        else:
            turned[dj, di] = blocks.mT
    return turned


def _by_blocks(right: Tensor) -> Tensor:
    """Return values (batch, 2, mi, mj) as (batch, blocks, 4 mj, 1); a line that is missing is 0."""
    lines = torch.nn.functional.pad(right, (0, 0, 0, right.shape[2] % 2)).movedim(1, -1)
    return lines.reshape(len(right), lines.shape[1] // 2, -1, 1)


def _blocks(stencil: Stencil) -> tuple[Tensor, Tensor]:
    """Return the lower parts of blocks on the diagonal (batch, blocks, 4 mj, 4 mj), and those below them."""
    some = stencil[0, 0]
    mi, mj = some.shape[3] - 2, some.shape[4] - 2
    count = (mi + 1) // 2
    diagonal, beside = (some.new_zeros(len(some), count, 2, mj, 2, 2, mj, 2) for _ in range(2))
    for (di, dj), blocks in stencil.items():
        # from column (i, j), component p, to row (i + di, j + dj), component q
        inner = blocks[..., 1 : mi + 1 - di, 1 + max(-dj, 0) : mj + 1 - max(dj, 0)]
        for line in (0, 1):
            part = inner[..., line::2, :].permute(0, 3, 2, 1, 4)
            step, row = divmod(line + di, 2)
            to = beside if step else diagonal
            places = to[:, : part.shape[1], row, :, :, line].diagonal(-dj, 2, 4)
            places.copy_(part)
    if mi % 2:
        last = diagonal[:, -1, 1, :, :, 1].diagonal(0, 1, 3)
        last.copy_(torch.eye(2, dtype=some.dtype, device=some.device)[:, :, None])
    shape = len(some), count, 4 * mj, 4 * mj
    return diagonal.view(shape), beside.view(shape)
