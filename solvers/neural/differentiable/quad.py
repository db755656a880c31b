"""Four-sided grids in torch: `neural.quad.coarse_grids` on tensors, without polish and guard."""

from typing import Any, ClassVar

import torch
from torch import Tensor

from meshonet.geometry.arrays import Topology
from meshonet.solvers.neural.differentiable.resample import arrays, between, folded, refined
from meshonet.solvers.neural.differentiable.sides import NetworkGrids, as_complex, check_sides
from meshonet.solvers.neural.quad.coarse_grids import share
from meshonet.solvers.neural.quad.encoding import LATENT, SCALE, WINSLOW, features, frame
from meshonet.solvers.neural.quad.picard import AFTER, approach, nodes_after

Sides = tuple[Tensor, ...]  # south, north (batch, 2, ni), west and east (batch, 2, nj)


class QuadGrids(NetworkGrids):
    """An operator for four-sided domains, ``quad-general`` by default, as a differentiable function."""

    topology: ClassVar[Topology] = "quad"
    remedy: ClassVar[str] = "use one of four-sided domains, or BodyGrids"

    def __call__(self, south: Tensor, north: Tensor, west: Tensor, east: Tensor) -> Tensor:
        """Return the nodes (batch, ni, nj, 2) of grids inside four edges each.

        `south`, `north`: (batch, ni, 2) nodes along xi, from west to east; `west`, `east`: (batch, nj, 2)
        nodes along eta, from south to north; corners are shared. Raises InputError: tensors of other shapes,
        or of another dtype than the network's.
        """
        check_sides(self._dtype, 2, south=south, north=north, west=west, east=east)
        sides = tuple(edge.movedim(-1, 1) for edge in (south, north, west, east))
        coarse = self._coarse(sides)
        if self._head == WINSLOW:
            coarse = _nearer(coarse, sides)
        return refined(coarse, sides).movedim(1, -1)

    def _coarse(self, sides: Sides) -> Tensor:
        thin = tuple(between(side, LATENT) for side in sides)
        base = interpolated(thin, _laws(thin))
        z, factor = _framed(base)
        near, step = approach(z, torch)
        move = SCALE * self._answer(features(near, step, torch))
        answer = near + (move if self._head == WINSLOW else _shares(near, move) * move)
        return _moved(base, (answer - z) / factor)


def _framed(planes: Tensor) -> tuple[Tensor, Tensor]:
    """Return grids of planes (batch, 2, m, n) in the network's frame, and the factors (batch, 1, 1) to it."""
    z = as_complex(planes)
    middle, factor = (value[:, None, None] for value in frame(z, torch))
    return (z - middle) * factor, factor


def _shares(near: Tensor, by: Tensor) -> Tensor:
    """Return the share (batch, 1, 1) of the moves `by` to take from grids `near`, without gradients."""
    start, answer = (torch.stack([z.real, z.imag], 1).detach() for z in (near, near + by))
    where = folded(answer).nonzero()[:, 0]
    parts = [share(*pair) for pair in zip(arrays(start[where]), arrays(answer[where]), strict=True)]
    few = torch.tensor(parts, dtype=start.dtype, device=start.device)
    return torch.ones_like(start[:, 0, 0, 0]).index_copy(0, where, few)[:, None, None]


def _nearer(coarse: Tensor, sides: Sides) -> Tensor:
    """Return grids `coarse` on more nodes, nearer to Winslow's."""
    planes = refined(coarse, tuple(between(side, nodes_after(side.shape[-1])) for side in sides))
    z, factor = _framed(planes)
    near, _ = approach(z, torch, steps=AFTER, harmonic=False)
    return _moved(planes, (near - z) / factor)


def _moved(planes: Tensor, by: Tensor) -> Tensor:
    return planes + torch.stack([by.real, by.imag], 1)


def interpolated(sides: Any, laws: Any) -> Tensor:
    """Return planes (batch, 2, ni, nj) by transfinite interpolation, as `meshonet.solvers.algebraic.tfi`.

    `sides`: south, north (batch, 2, ni), west, east (batch, 2, nj); `laws`: parameters along them, 0 to 1,
    (batch, n) each.
    """
    south, north, west, east = sides
    s, n = (law[:, 1:-1, None] for law in laws[:2])
    w, e = (law[:, None, 1:-1] for law in laws[2:])
    u = (s + (n - s) * w) / (1.0 - (n - s) * (e - w))
    v = (w + (e - w) * u)[:, None]
    u = u[:, None]
    a, b, c, d = (side[:, :, k, None, None] for side, k in ((south, 0), (south, -1), (north, -1), (north, 0)))
    left = west[:, :, None, 1:-1] - a - v * (d - a)
    right = east[:, :, None, 1:-1] - b - v * (c - b)
    low, high = south[:, :, 1:-1, None], north[:, :, 1:-1, None]
    inner = low + v * (high - low) + left + u * (right - left)
    rows = torch.cat([low, inner, high], 3)
    return torch.cat([west[:, :, None], rows, east[:, :, None]], 2)


def _laws(sides: Any) -> tuple[Tensor, ...]:
    fractions = []
    for side in sides:
        steps = side[..., 1:] - side[..., :-1]
        along = torch.cumsum(torch.hypot(steps[:, 0], steps[:, 1]), -1)
        fractions.append(torch.cat([torch.zeros_like(along[:, :1]), along / along[:, -1:]], -1))
    return tuple(fractions)
