"""Picard's step for Winslow's equations in the strip, and the limit of accelerated steps."""

from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from meshonet.solvers.conformal import strip
from meshonet.solvers.conformal.strip import across, wavenumbers
from meshonet.solvers.elliptic.winslow import left_side
from meshonet.solvers.neural.differentiable import anderson
from meshonet.solvers.neural.differentiable.gmres import gmres
from meshonet.solvers.neural.differentiable.members import MemberError, in_parts

SETTLED = 1e-13  # change (radians) in a step at which a member has converged
ADJOINT = 1e-10  # the same of the system for gradients, relative to the largest one
MOST = 600  # accelerated steps at the most; random airfoils take up to 200
PLAIN = 8_000, 16_000, 32_000, 64_000  # plain steps first, where phi on the wall turns back between nodes
KRYLOV = 300  # dimension of the space, and products, for gradients that accelerated steps do not reach
TOGETHER = 8  # members solved at once on a CPU, so that they fit in its cache


def picard(c: Tensor) -> Tensor:
    """Return Fourier modes `c` (batch, modes, LEVELS) of grids after a Picard step of Winslow's equations."""
    return _stepped(c.mT).mT


class Settled(torch.autograd.Function):
    """Torch function from initial to converged solutions of Winslow's equations around bodies.

    Regions around bodies are mapped to strips of period 2 pi in theta. Solutions are Fourier modes along
    theta (batch, modes, LEVELS), at LEVELS points across the strip. The highest modes keep their values.
    """

    @staticmethod
    def forward(ctx: Any, start: Tensor) -> Tensor:
        """Return the limit of Picard's iteration. Raises MemberError if it does not converge."""
        (levels,) = in_parts(_limit, _together(start), start.mT.contiguous())
        ctx.save_for_backward(start, levels)
        return levels.mT

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, gradient: Tensor) -> Tensor:
        """Return the derivative with respect to the initial Fourier modes."""
        start, levels = ctx.saved_tensors
        (result,) = in_parts(_pulled, _together(start), start.mT.contiguous(), levels, gradient.mT)
        return result.mT


def _together(start: Tensor) -> int:
    return len(start) if start.is_cuda else TOGETHER


def _limit(start: Tensor) -> tuple[Tensor]:
    levels, near, left = start.clone(), start, torch.arange(len(start), device=start.device)
    for count in (0, *PLAIN):
        near = _plain(near, start[left], count) if count else near
        levels[left, 1:-1], reached = _accelerated(near, start[left])
        near, left = near[~reached], left[~reached]
        if not len(left):
            return (levels,)
    problem, remedy = "Winslow's equations did not converge", "use layer.AirfoilGrids, or another method"
    raise MemberError.of(left.tolist(), problem, remedy)


def _accelerated(near: Tensor, start: Tensor) -> tuple[Tensor, Tensor]:
    """Return the limit (batch, LEVELS - 2, modes) of steps from `near`, and whether it has been reached."""

    def step(inner: Tensor, members: Tensor) -> Tensor:
        return _flat(_once(_levels(inner), start[members]))

    flat = _flat(near[:, 1:-1])
    inner, reached = anderson.limit(step, flat, torch.full_like(flat[:, 0], SETTLED), MOST)
    return _levels(inner), reached


def _plain(levels: Tensor, start: Tensor, count: int) -> Tensor:
    """Return levels (batch, LEVELS, modes) after plain steps of the compiled code, as `_once`."""
    back, stepped = 1.0 - across().smooth[:, None], []
    for c, first in zip(*(part.mT.cpu().numpy() for part in (levels, start)), strict=True):
        now = np.ascontiguousarray(c)
        for _ in range(count):
            now = strip.picard(now, 1)[0] + back * (first - now)
        stepped.append(now.T)
    return torch.from_numpy(np.stack(stepped)).to(start)


def _pulled(start: Tensor, levels: Tensor, gradient: Tensor) -> tuple[Tensor]:
    """Return the derivative with respect to `start`, from that with respect to the limit, `levels`."""
    first, slope = _flat(gradient[:, 1:-1]), _Slope(levels)

    def step(flat: Tensor, members: Tensor) -> Tensor:
        return first[members] + _flat(slope.transposed(_levels(flat), members))

    share, reached = anderson.limit(step, first, ADJOINT * first.abs().amax(1), MOST)
    left = (~reached).nonzero().flatten()
    if len(left):
        share[left] = gmres(
            lambda flat: first[left] + flat - step(flat, left),
            first[left], 1e-3 * ADJOINT, KRYLOV, KRYLOV,
        )  # fmt: skip
    with torch.enable_grad():
        walls = start.detach().requires_grad_()
        after = _once(levels[:, 1:-1], walls)
    (result,) = torch.autograd.grad(after, walls, _levels(share))
    result[:, [0, -1]] += gradient[:, [0, -1]]
    return (result,)


class _Slope:
    """The derivative of a step by the levels inside, at `levels` (batch, LEVELS, modes)."""

    def __init__(self, levels: Tensor) -> None:
        self._fields = fields = _Fields(levels)
        half = 0.5 * fields.scale**2 * fields.missed
        self._alpha = fields.scale * fields.Wtt - half / fields.height**2
        self._beta = -2.0 * fields.scale * fields.Wte
        self._gamma = fields.scale * fields.Wee - half
        self._second = [fields.scale * part for part in (fields.alpha, -2.0 * fields.beta, fields.gamma)]

    def transposed(self, share: Tensor, members: Tensor) -> Tensor:
        """Return a step's transposed derivative times `share` (m, LEVELS - 2, modes), of `members` (m,)."""
        grid, fields = across(), self._fields
        filtered = _product(grid.vectors.T, share) * fields.smooth[members]
        r = strip.to_columns(_product(grid.inverse.T, filtered), torch)
        Wt, We = fields.Wt[members], fields.We[members]
        by_alpha, by_beta, by_gamma = (
            _dot(r, part[members]) for part in (self._alpha, self._beta, self._gamma)
        )
        t, e = 2.0 * by_gamma * Wt + by_beta * We, 2.0 * by_alpha * We + by_beta * Wt
        tt, te, ee = (part[members] * r for part in self._second)
        t, tt, e, te, ee = (strip.from_columns(part, torch) for part in (t, tt, e, te, ee))
        k = wavenumbers(share, torch)
        inside = slice(1, -1)
        back = _product(grid.d1[inside, inside].T, e - 1j * k * te) + _product(grid.d2[inside, inside].T, ee)
        return _filter(share) * share - (back - 1j * k * t - k**2 * tt)


def _once(inner: Tensor, start: Tensor) -> Tensor:
    """Return the levels inside after a step from `inner`, with the walls and the high modes of `start`."""
    levels = torch.cat([start[:, :1], inner, start[:, -1:]], 1)
    return _stepped(levels)[:, 1:-1] + (1.0 - _filter(start)) * (start[:, 1:-1] - inner)


def _stepped(levels: Tensor) -> Tensor:
    grid, fields = across(), _Fields(levels)
    residual = strip.from_columns(fields.missed * fields.scale, torch)
    update = _product(grid.vectors, _product(grid.inverse, residual) * fields.smooth)
    return levels - torch.nn.functional.pad(update, (0, 0, 1, 1))


class _Fields:
    """Derivatives of W, and terms of Winslow's equations, at the columns of the levels inside."""

    def __init__(self, levels: Tensor) -> None:
        grid, k = across(), wavenumbers(levels, torch)
        self.height = T = (levels[:, -1, 0] - levels[:, 0, 0]).real[:, None, None]
        self.smooth = _filter(levels) / (_like(grid.eigenvalues, levels)[:, None] - (k.real * T) ** 2)
        inner, ce = levels[:, 1:-1], _product(grid.d1[1:-1], levels)
        parts = (1j * k * inner, -(k**2) * inner, ce, 1j * k * ce, _product(grid.d2[1:-1], levels))
        Wt, self.Wtt, self.We, self.Wte, self.Wee = (strip.to_columns(part, torch) for part in parts)
        self.Wt = Wt + 1j
        derivatives = self.Wt, self.We, self.Wtt, self.Wte, self.Wee
        self.missed, self.alpha, self.gamma = left_side(derivatives, _dot)
        self.scale = 2.0 / (self.alpha / (T * T) + self.gamma)

    @property
    def beta(self) -> Tensor:
        return _dot(self.Wt, self.We)


def _filter(like: Tensor) -> Tensor:
    return _like(across().smooth, like)


def _like(values: Any, like: Tensor) -> Tensor:
    return torch.tensor(values, device=like.device)


def _dot(a: Tensor, b: Tensor) -> Tensor:
    return a.real * b.real + a.imag * b.imag


def _product(matrix: Any, levels: Tensor) -> Tensor:
    pairs = torch.view_as_real(levels.contiguous()).flatten(2)
    return torch.view_as_complex((_like(matrix, levels) @ pairs).unflatten(2, (-1, 2)))


def _flat(levels: Tensor) -> Tensor:
    """Return complex levels (batch, m, modes) as real values (batch, n)."""
    return torch.view_as_real(levels.contiguous()).flatten(1)


def _levels(flat: Tensor) -> Tensor:
    return torch.view_as_complex(flat.view(len(flat), -1, 2 * strip.MODES + 1, 2))
