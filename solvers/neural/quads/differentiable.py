"""Quad grids in torch: gradients from every node back to the nodes of the boundary, on any device.

The arithmetic of `meshonet.solvers.neural.quads.operator` once more, on tensors; without polish and guard.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from meshonet.solvers.neural.quads.damping import share
from meshonet.solvers.neural.quads.encoding import LATENT, SCALE, WINSLOW
from meshonet.solvers.neural.quads.evaluated import arrays, between, evaluated, folded
from meshonet.solvers.neural.quads.features import features
from meshonet.solvers.neural.quads.frame import frame
from meshonet.solvers.neural.quads.in_torch import loaded
from meshonet.solvers.neural.quads.model import ANSWERS
from meshonet.solvers.neural.quads.picard import AFTER, approach, nodes_after
from meshonet.solvers.neural.tensors import check_sides

Sides = tuple[Tensor, Tensor, Tensor, Tensor]
"""South, north (batch, 2, ni), west and east (batch, 2, nj)."""


class QuadGrids:
    """A shipped quad model, or one of a file, as a differentiable function.

    Parameters
    ----------
    model : ``quad-general``, ``quad-winslow``, or the path of a file, whose variational answer is taken.
    device : torch's name of where to compute.
    dtype : torch's type of the arithmetic.

    Raises
    ------
    InputError
        no such model, or one that cannot be read.
    """

    def __init__(
        self, model: str = ANSWERS[-1], device: str = "cpu", dtype: torch.dtype = torch.float64
    ) -> None:
        self._dtype = dtype
        remedy = "use one of four-sided domains, or BodyGrids"
        self._network, self._head = loaded(model, "quad", device, dtype, remedy)

    def __call__(self, south: Tensor, north: Tensor, west: Tensor, east: Tensor) -> Tensor:
        """Return the nodes (batch, ni, nj, 2) of grids inside four edges each.

        Parameters
        ----------
        south, north : (batch, ni, 2) nodes along xi, from west to east.
        west, east : (batch, nj, 2) nodes along eta, from south to north; corners are shared.

        Raises
        ------
        InputError
            tensors of other shapes, or of another dtype than the network's.
        """
        check_sides(self._dtype, 2, south=south, north=north, west=west, east=east)
        sides = _planes(south, north, west, east)
        coarse = self._coarse(sides)
        if self._head == WINSLOW:
            coarse = _nearer(coarse, sides)
        return evaluated(coarse, sides).movedim(1, -1)

    def _coarse(self, sides: Sides) -> Tensor:
        thin = tuple(between(side, LATENT) for side in sides)
        base = interpolated(thin, _laws(thin))
        z = torch.complex(base[:, 0], base[:, 1])
        middle, factor = (value[:, None, None] for value in frame(z, torch))
        z = (z - middle) * factor
        near, step = approach(z, torch)
        by = SCALE * self._network(features(near, step, torch))[:, self._head]
        found = near + (by if self._head == WINSLOW else _shares(near, by) * by)
        return _moved(base, (found - z) / factor)


def _shares(near: Tensor, by: Tensor) -> Tensor:
    """Return how much (batch, 1, 1) of moves `by` to take from grids `near`; no gradients go through it."""
    start, answer = (torch.stack([z.real, z.imag], 1).detach() for z in (near, near + by))
    where = folded(answer).nonzero()[:, 0]
    parts = [share(*one) for one in zip(arrays(start[where]), arrays(answer[where]), strict=True)]
    few = torch.tensor(parts, dtype=start.dtype, device=start.device)
    return torch.ones_like(start[:, 0, 0, 0]).index_copy(0, where, few)[:, None, None]


def _nearer(coarse: Tensor, sides: Sides) -> Tensor:
    """Return grids `coarse` on more nodes, nearer to Winslow's."""
    planes = evaluated(coarse, tuple(between(side, nodes_after(side.shape[-1])) for side in sides))
    z = torch.complex(planes[:, 0], planes[:, 1])
    middle, factor = (value[:, None, None] for value in frame(z, torch))
    z = (z - middle) * factor
    near, _ = approach(z, torch, steps=AFTER, harmonic=False)
    return _moved(planes, (near - z) / factor)


def _moved(planes: Tensor, by: Tensor) -> Tensor:
    return planes + torch.stack([by.real, by.imag], 1)


def interpolated(sides: Any, laws: Any) -> Tensor:
    """Return planes (batch, 2, ni, nj) by transfinite interpolation, as `meshonet.solvers.algebraic.tfi`.

    Parameters
    ----------
    sides : south, north (batch, 2, ni), west, east (batch, 2, nj).
    laws : parameters along them, 0 to 1, (batch, n) each.
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
    found = []
    for side in sides:
        steps = side[..., 1:] - side[..., :-1]
        along = torch.cumsum(torch.hypot(steps[:, 0], steps[:, 1]), -1)
        found.append(torch.cat([torch.zeros_like(along[:, :1]), along / along[:, -1:]], -1))
    return tuple(found)


def _planes(*edges: Tensor) -> Sides:
    south, north, west, east = (edge.movedim(-1, 1) for edge in edges)
    return south, north, west, east
