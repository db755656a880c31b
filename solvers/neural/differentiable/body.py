"""Differentiable O grids around bodies: `neural.quad.o_grids` in torch, without polish or repair."""

from functools import partial
from typing import ClassVar

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Topology, array_like
from meshonet.geometry.errors import InputError
from meshonet.solvers.algebraic.resample import corner_damping
from meshonet.solvers.algebraic.resample.o_grid import SQUARINGS, along_lines
from meshonet.solvers.algebraic.resample.spline import spline_matrix
from meshonet.solvers.neural.differentiable.arguments import check_sides
from meshonet.solvers.neural.differentiable.resample import between
from meshonet.solvers.neural.differentiable.sides import NetworkGrids, as_complex, as_numpy
from meshonet.solvers.neural.quad.encoding import LATENT
from meshonet.solvers.neural.quad.inside_point import inside, slope
from meshonet.solvers.neural.quad.o_grids import NOT_ROUND, moved
from meshonet.solvers.neural.quad.unrolled import AROUND, around_middles, even, factors, rolled


class BodyGrids(NetworkGrids):
    """An operator for bodies, ``hole-o`` by default, as a differentiable function."""

    topology: ClassVar[Topology] = "o"
    remedy: ClassVar[str] = "use one for bodies"

    def __call__(self, south: Tensor, north: Tensor, nj: int) -> Tensor:
        """Return the nodes (..., ni, nj, 2) of O grids around bodies.

        `south`, `north`: (..., ni, 2) nodes of the bodies and of the far fields, clockwise, the first
        repeated at the end; `nj`: node count from wall to far field. Raises InputError: tensors of other
        shapes, or of different dtypes; `nj` below 2; walls that do not wind once around a centre of the body,
        with the index of the member.
        """
        check_sides(4, nj, south=south, north=north)
        return self._batched(partial(self._nodes, nj=nj), south, north, nj=nj)

    def _nodes(self, south: Tensor, north: Tensor, nj: int) -> Tensor:
        sides = [edge.movedim(-1, 1) for edge in (south, north)]
        body, far = (as_complex(side) for side in sides)
        walls = torch.stack([as_complex(between(side, AROUND)) for side in sides], 2)
        strips, centres, once = around_middles(body, walls, _inside, torch)
        if not once.all():
            problem, remedy = NOT_ROUND
            raise InputError(f"member {int(np.argmin(as_numpy(once)))} of the batch: {problem}", remedy)
        base, factor = even(strips, LATENT, torch), factors(strips, torch)[:, None, None]
        strip = moved(base, factor, self._head, self._answer, torch)
        grid = rolled(strip, centres[:, None, None], torch)
        coarse = torch.cat([walls[..., :1], grid[..., 1:-1], walls[..., 1:]], 2)
        inner = torch.view_as_real(_evaluated(coarse, body, far, nj))
        inner = torch.cat([inner[:, :-1], inner[:, :1]], 1)[:, :, 1:-1]
        return torch.cat([south[:, :, None], inner, north[:, :, None]], 2)


def _inside(wall: Tensor) -> Tensor:
    """Return the point of `inside.inside`, with the gradient of one step of Newton's method at it."""
    point = complex(inside(as_numpy(wall).astype(np.complex128)))
    size = (wall.detach() - wall[0].detach()).abs().max()
    curve = (wall - wall[0]) / size
    p = (torch.tensor(point, dtype=wall.dtype, device=wall.device) - wall[0].detach()) / size
    g, m, c = slope(p, curve, torch)
    m, c = m.detach(), c.detach()
    return wall[0] + size * (p + (c * g.conj() - m * g) / (m * m - c.abs() ** 2))


def _evaluated(coarse: Tensor, south: Tensor, north: Tensor, nj: int) -> Tensor:
    """Return the nodes (batch, ni, nj) that `o_grid.refine_around` returns, except on the boundary."""
    m, ni = coarse.shape[1], south.shape[1]
    lines, share = along_lines(coarse, nj, torch)
    shares = array_like(corner_damping.linear(m, ni), share, torch) @ share
    near_south, near_north = 1.0 - shares, shares
    for _ in range(SQUARINGS):
        near_south, near_north = near_south**2, near_north**2
    nodes: Tensor = array_like(spline_matrix(m, ni, True) + 0j, lines, torch) @ lines
    walls = south[..., None] - nodes[..., :1], north[..., None] - nodes[..., -1:]
    return nodes + walls[0] * near_south + walls[1] * near_north
