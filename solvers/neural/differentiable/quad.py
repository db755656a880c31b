"""Differentiable quad grids: `coarse_grids` of `neural.quad` in torch, without polish or repair."""

from typing import ClassVar

import torch
from torch import Tensor

from meshonet.geometry.arrays import Topology
from meshonet.solvers.neural.differentiable.arguments import check_corners, check_sides
from meshonet.solvers.neural.differentiable.resample import between, folded, refined
from meshonet.solvers.neural.differentiable.sides import (
    NetworkGrids,
    as_complex,
    as_numpy,
    as_planes,
)
from meshonet.solvers.neural.differentiable.transfinite import arc_lengths, interpolated
from meshonet.solvers.neural.quad.coarse_grids import answered, in_frame, nearer, share
from meshonet.solvers.neural.quad.encoding import LATENT, WINSLOW
from meshonet.solvers.neural.quad.picard import nodes_after


class QuadGrids(NetworkGrids):
    """An operator for four-sided domains, ``quad-general`` by default, as a differentiable function."""

    topology: ClassVar[Topology] = "quad"
    remedy: ClassVar[str] = "use one of four-sided domains, or BodyGrids"

    def __call__(self, south: Tensor, north: Tensor, west: Tensor, east: Tensor) -> Tensor:
        """Return the nodes (..., ni, nj, 2) of grids inside four edges each.

        `south`, `north`: (..., ni, 2) nodes along xi, from west to east; `west`, `east`: (..., nj, 2) nodes
        along eta, from south to north; corners are shared. Raises InputError: tensors of other shapes, or of
        different dtypes.
        """
        check_sides(2, south=south, north=north, west=west, east=east)
        check_corners(south, north, west, east)
        return self._batched(self._nodes, south, north, west, east)

    def _nodes(self, south: Tensor, north: Tensor, west: Tensor, east: Tensor) -> Tensor:
        sides = tuple(edge.movedim(-1, 1) for edge in (south, north, west, east))
        thin = tuple(between(side, LATENT) for side in sides)
        base = as_complex(interpolated(thin, arc_lengths(thin)))
        shares = None if self._head == WINSLOW else _shares
        coarse = as_planes(answered(base, in_frame(base, torch), self._answer, shares, torch))
        if self._head == WINSLOW:
            few = tuple(between(side, nodes_after(side.shape[-1])) for side in sides)
            finer = as_complex(refined(coarse, few))
            coarse = as_planes(nearer(finer, in_frame(finer, torch), torch))
        return refined(coarse, sides).movedim(1, -1)


def _shares(near: Tensor, by: Tensor) -> Tensor:
    """Return fractions (batch, 1, 1) of displacements `by` to apply to grids `near`, without gradients."""
    start, answer = near.detach(), (near + by).detach()
    where = folded(as_planes(answer)).nonzero()[:, 0]
    parts = [share(*pair) for pair in zip(as_numpy(start[where]), as_numpy(answer[where]), strict=True)]
    few = torch.tensor(parts, dtype=start.real.dtype, device=start.device)
    return torch.ones_like(start[:, 0, 0].real).index_copy(0, where, few)[:, None, None]
