"""Direct solution of the linear systems of variational grids: a block tridiagonal Cholesky factorisation.

Two grid lines of inner nodes are one block, since the stencil reaches two lines. Lines run the shorter way.
The work for m x n nodes, n the smaller count, is about 300 m n³ operations, in products of matrices of order
4n, for all members of a batch at once.

Golub and Van Loan, Matrix Computations (2013), section 4.5.
"""

import torch
from torch import Tensor

from meshonet.solvers.neural.differentiable.functional import Stencil


class BlockCholesky:
    """The factor of a stencil's matrix at the inner nodes.

    `positive` (batch,) says whether the matrix of each member is positive definite; other factors are
    unusable.
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
        """Return the solutions (batch, 2, mi, mj) for `right` of the same shape, values at inner nodes."""
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
    """Return the approximate number of bytes of a factorisation for ni x nj nodes, per member of a batch."""
    return 256 * max(ni, nj) * min(ni, nj) ** 2


def _turned(stencil: Stencil) -> Stencil:
    """Return the stencil with xi and eta exchanged."""
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
