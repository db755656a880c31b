"""GMRES for a batch (Saad and Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856-869)."""

from collections.abc import Callable

import torch
from torch import Tensor

SPACE = 40  # dimension of the Krylov space
TINY = 1e-300  # keeps quotients finite where a residual is zero


def gmres(
    times: Callable[[Tensor], Tensor], right: Tensor, tol: float, most: int, space: int = SPACE
) -> Tensor:
    """Return approximate solutions x (batch, n) of A x = `right` (batch, n) by restarted GMRES.

    `times(x)` returns A x. The iteration ends if the norm of the residual is at most `tol` times the norm
    of `right`, or after `most` products with A. It restarts when the Krylov space has dimension `space`.
    """
    x, goal = torch.zeros_like(right), tol * right.norm(dim=1)
    rest, done = right, 0
    while done < most and bool((rest.norm(dim=1) > goal).any()):
        step, spent = _cycle(times, rest, goal, min(space, most - done))
        x, done = x + step, done + spent
        if done < most:
            rest = right - times(x)
    return x


def _cycle(times: Callable[[Tensor], Tensor], right: Tensor, goal: Tensor, most: int) -> tuple[Tensor, int]:
    """Return the minimiser (batch, n) in the Krylov space of `right`, and the number of products with A."""
    batch, n = right.shape
    size = right.norm(dim=1)
    basis = right.new_zeros(batch, most + 1, n)
    basis[:, 0] = right / size.clamp_min(TINY)[:, None]
    triangle = right.new_zeros(batch, most, most)
    rest = right.new_zeros(batch, most + 1)
    rest[:, 0] = size
    turns: list[tuple[Tensor, Tensor]] = []
    for k in range(most):
        image, column = times(basis[:, k]), right.new_zeros(batch, k + 2)
        parts = torch.bmm(basis[:, : k + 1], image[:, :, None])
        image = image - torch.bmm(basis[:, : k + 1].mT, parts)[:, :, 0]
        column[:, : k + 1] = parts[:, :, 0]
        column[:, k + 1] = image.norm(dim=1)
        basis[:, k + 1] = image / column[:, k + 1, None].clamp_min(TINY)
        for i, turn in enumerate(turns):
            column[:, i], column[:, i + 1] = _turned(turn, column[:, i], column[:, i + 1])
        radius = torch.hypot(column[:, k], column[:, k + 1]).clamp_min(TINY)
        turns.append((column[:, k] / radius, column[:, k + 1] / radius))
        column[:, k] = radius
        triangle[:, : k + 1, k] = column[:, : k + 1]
        rest[:, k], rest[:, k + 1] = _turned(turns[-1], rest[:, k], rest[:, k + 1])
        if bool((rest[:, k + 1].abs() <= goal).all()):
            break
    share = torch.linalg.solve_triangular(triangle[:, : k + 1, : k + 1], rest[:, : k + 1, None], upper=True)
    return torch.bmm(basis[:, : k + 1].mT, share)[:, :, 0], k + 1


def _turned(turn: tuple[Tensor, Tensor], first: Tensor, second: Tensor) -> tuple[Tensor, Tensor]:
    """Return a pair of rows of the Hessenberg matrix after a Givens rotation (cosine, sine)."""
    cosine, sine = turn
    return cosine * first + sine * second, cosine * second - sine * first
