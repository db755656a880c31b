"""Anderson acceleration of a batch (Walker and Ni, SIAM J. Numer. Anal. 49 (2011) 1715-1735)."""

from collections.abc import Callable

import torch
from torch import Tensor

SPACE = 20  # earlier steps of which the next one is combined
EQUAL = 1e-13  # relative, squared: steps nearer to a combination of others count little
TINY = 1e-300  # keeps quotients finite where a step repeats the one before


def limit(
    step: Callable[[Tensor, Tensor], Tensor], start: Tensor, tol: Tensor, most: int
) -> tuple[Tensor, Tensor]:
    """Iterate x -> step(x) with Anderson acceleration; return the limits (batch, n) and a convergence mask.

    Parameters
    ----------
    step : ``step(x, members)`` returns the iterates after `x`; `members` are the batch indices of its rows.
    start : (batch, n) initial values.
    tol : (batch,) a member has converged if no value changes by more than this in a step.
    most : greatest number of steps.
    """
    limits, far = start.clone(), torch.ones(len(start), dtype=torch.bool, device=start.device)
    moving, x = torch.arange(len(start), device=start.device), start
    past = _Past(start)
    for _ in range(most):
        change = step(x, moving) - x
        on = ~(change.abs().amax(1) <= tol[moving])  # true where it is not a number
        limits[moving] = x + change
        far[moving] = on
        if not bool(on.any()):
            break
        if not bool(on.all()):
            moving, x, change, past = moving[on], x[on], change[on], past.of(on)
        x = past.after(x, change)
    return limits, ~far


class _Past:
    """The differences between the last steps of members, and their scalar products."""

    def __init__(self, like: Tensor) -> None:
        batch, n = like.shape
        self._count = 0
        self._x, self._change = like, like
        self._moves, self._bends = (like.new_zeros(batch, SPACE, n) for _ in range(2))
        self._products = like.new_zeros(batch, SPACE, SPACE)

    def of(self, some: Tensor) -> "_Past":
        few = _Past.__new__(_Past)
        few._count = self._count
        for name in ("_x", "_change", "_moves", "_bends", "_products"):
            setattr(few, name, getattr(self, name)[some])
        return few

    def after(self, x: Tensor, change: Tensor) -> Tensor:
        """Return the accelerated values after `x`; `change` is the step from `x` without acceleration."""
        if self._count:
            self._add(x, change)
        self._count, self._x, self._change = self._count + 1, x, change
        kept = min(self._count - 1, SPACE)
        if not kept:
            return x + change
        products = self._products[:, :kept, :kept]
        size = products.diagonal(dim1=1, dim2=2).clamp_min(TINY).rsqrt()
        matrix = products * size[:, :, None] * size[:, None]
        matrix = matrix + EQUAL * torch.eye(kept, dtype=x.dtype, device=x.device)
        right = torch.bmm(self._bends[:, :kept], change[:, :, None])
        share = size[:, :, None] * torch.linalg.solve(matrix, right * size[:, :, None])
        return x + change - torch.bmm(self._moves[:, :kept].mT, share)[:, :, 0]

    def _add(self, x: Tensor, change: Tensor) -> None:
        at, kept = (self._count - 1) % SPACE, min(self._count, SPACE)
        bend = change - self._change
        self._bends[:, at], self._moves[:, at] = bend, x - self._x + bend
        row = torch.bmm(self._bends[:, :kept], bend[:, :, None])[:, :, 0]
        self._products[:, at, :kept] = row
        self._products[:, :kept, at] = row
