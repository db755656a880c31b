"""Differentiable grids by the quad network: `neural.quad` in torch, without polish or repair."""

from collections.abc import Callable
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
from meshonet.solvers.neural.differentiable.arguments import (
    as_complex,
    as_numpy,
    as_planes,
    batched,
    check_corners,
    check_sides,
)
from meshonet.solvers.neural.differentiable.recorded import recorded
from meshonet.solvers.neural.differentiable.resample import (
    arc_lengths,
    between,
    folded,
    interpolated,
    refined,
)
from meshonet.solvers.neural.fit.networks import QuadUNet
from meshonet.solvers.neural.operator import Operator
from meshonet.solvers.neural.quad.coarse_grids import answered, in_frame, nearer, share
from meshonet.solvers.neural.quad.encoding import LATENT, WINSLOW, features
from meshonet.solvers.neural.quad.inside_point import inside, slope
from meshonet.solvers.neural.quad.o_grids import NOT_ROUND, moved
from meshonet.solvers.neural.quad.operator import QuadOperator
from meshonet.solvers.neural.quad.picard import nodes_after
from meshonet.solvers.neural.quad.unrolled import AROUND, around_middles, even, factors, rolled
from meshonet.solvers.neural.registry import load

SHIPPED: dict[Topology, str] = {"quad": "quad-general", "o": "hole-o"}  # by topology


class NetworkGrids:
    """Base class of neural operators that make grids by a U-Net, as differentiable functions.

    `model` is an operator, the name of a shipped one, or the path of a model file. `device` is torch's name
    of the device. `dtype` is the floating-point type of the computation. Raises InputError if the model does
    not exist, cannot be read, or does not make grids of the topology of the subclass.
    """

    topology: ClassVar[Topology]
    remedy: ClassVar[str]

    def __init__(
        self, model: str | Operator = "", device: str = "cpu", dtype: torch.dtype = torch.float64
    ) -> None:
        operator = load(model or SHIPPED[self.topology]) if isinstance(model, str) else model
        if not isinstance(operator, QuadOperator) or operator.topology != self.topology:
            raise InputError(f"model {operator.name} makes {operator.topology} grids", self.remedy)
        self._dtype, self._device, self._head = dtype, device, operator.head
        self._network = QuadUNet(operator.widths, operator.blocks, around=self.topology == "o")
        state = {name: torch.from_numpy(array) for name, array in operator.weights.items()}
        self._network.load_state_dict(state)
        self._network.to(device=device, dtype=dtype).requires_grad_(False)

    def _batched(self, make: Callable[..., Tensor], *sides: Tensor, nj: int | None = None) -> Tensor:
        return batched(partial(recorded, make), sides, nj, self._dtype, self._device)

    def _answer(self, near: Tensor, step: Tensor) -> Tensor:
        return self._network(features(near, step, torch, self.topology == "o"))[:, self._head]


class QuadGrids(NetworkGrids):
    """Differentiable grids of four-sided domains by a neural operator, by default model ``quad-general``."""

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


class BodyGrids(NetworkGrids):
    """Differentiable O grids around bodies by a neural operator, by default the shipped model ``hole-o``."""

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
