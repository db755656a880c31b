"""O grids around bodies in torch: gradients from every node to those of body and far field, on any device.

The arithmetic of `meshonet.solvers.neural.quads.around` and `meshonet.solvers.algebraic.resample.o_grid` once more, on tensors; without
polish and guard.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.errors import InputError
from meshonet.solvers.algebraic.resample import corner_damping as acute
from meshonet.solvers.algebraic.resample.o_grid import FLAT, SQUARINGS, STEEP
from meshonet.solvers.algebraic.resample.spline import bending, places, spline_matrix
from meshonet.solvers.neural.quads.encoding import LATENT, SCALE, WINSLOW
from meshonet.solvers.neural.quads.evaluated import between, matrix
from meshonet.solvers.neural.quads.features import features
from meshonet.solvers.neural.quads.in_torch import loaded
from meshonet.solvers.neural.quads.inside import inside, slope
from meshonet.solvers.neural.quads.model import ANSWERS_AROUND
from meshonet.solvers.neural.quads.picard import AFTER, approach
from meshonet.solvers.neural.quads.unrolled import AROUND, TURN
from meshonet.solvers.neural.tensors import check_sides


class BodyGrids:
    """A shipped model for bodies, or one of a file, as a differentiable function.

    Parameters
    ----------
    model : ``hole-o``, ``hole-winslow``, or the path of a file, whose variational answer is taken.
    device : torch's name of where to compute.
    dtype : torch's type of the arithmetic.

    Raises
    ------
    InputError
        no such model, or one that cannot be read.
    """

    def __init__(
        self, model: str = ANSWERS_AROUND[-1], device: str = "cpu", dtype: torch.dtype = torch.float64
    ) -> None:
        self._dtype = dtype
        self._network, self._head = loaded(model, "o", device, dtype, "use one for bodies")

    def __call__(self, south: Tensor, north: Tensor, nj: int) -> Tensor:
        """Return the nodes (batch, ni, nj, 2) of O grids around bodies.

        Parameters
        ----------
        south, north : (batch, ni, 2) nodes of the bodies and of the far fields, clockwise, the last one the
            first.
        nj : nodes from wall to far field.

        Raises
        ------
        InputError
            tensors of other shapes, or of another dtype than the network's; fewer than 2 nodes away; walls
            that do not go once round a middle of the body.
        """
        check_sides(self._dtype, 4, south=south, north=north)
        if nj < 2:
            raise InputError(f"nj is {nj} nodes", "use at least 2")
        sides = [edge.movedim(-1, 1) for edge in (south, north)]
        body, far = (_complex(side) for side in sides)
        walls = torch.stack([_complex(between(side, AROUND)) for side in sides], 2)
        coarse = torch.cat([walls[..., :1], self._coarse(body, walls), walls[..., 1:]], 2)
        inner = torch.view_as_real(_evaluated(coarse, body, far, nj))
        inner = torch.cat([inner[:, :-1], inner[:, :1]], 1)[:, :, 1:-1]
        return torch.cat([south[:, :, None], inner, north[:, :, None]], 2)

    def _coarse(self, wall: Tensor, walls: Tensor) -> Tensor:
        """Return the nodes (batch, 65, 31) between `walls` (batch, 65, 2) of bodies `wall` (batch, ni)."""
        centres = _middles(wall[:, :-1])
        strips, once = _unrolled(walls, centres)
        if not once.all():
            seen = zip(centres, once, walls[:, :-1, 0], strict=True)
            centres = torch.stack([centre if fits else _inside(z) for centre, fits, z in seen])
            strips, once = _unrolled(walls, centres)
        if not once.all():
            told = "the walls do not go once round a middle of a body"
            raise InputError(told, "use meshonet solve-pde for this shape")
        eta = torch.linspace(0.0, 1.0, LATENT, dtype=self._dtype, device=walls.device)
        base = strips[:, :, :1] * (1.0 - eta) + strips[:, :, 1:] * eta
        heights = (strips[:, :-1, 1] - strips[:, :-1, 0]).imag.mean(1)
        factor = (1.0 / torch.sqrt(0.5 * TURN * heights))[:, None, None]
        z = base * factor
        near, step = approach(z, torch, around=True)
        answer = self._network(features(near, step, torch, around=True))[:, self._head]
        found = near[:, :-1] + SCALE * answer
        if self._head == WINSLOW:
            closed = torch.cat([found, found[:, :1] + factor * TURN], 1)
            found = approach(closed, torch, True, AFTER, harmonic=False)[0][:, :-1]
        strip = (base[:, :-1] + (found - z[:, :-1]) / factor)[..., 1:-1]
        grid = torch.exp(-1j * strip) + centres[:, None, None]
        return torch.cat([grid, grid[:, :1]], 1)


def _middles(wall: Tensor) -> Tensor:
    """Return the centroids (batch,) of the areas inside closed curves, as `unrolled.middles`."""
    off = wall - wall[:, :1]
    ahead = torch.roll(off, -1, 1)
    cross = (off.conj() * ahead).imag
    return wall[:, 0] + (cross * (off + ahead)).sum(1) / (3.0 * cross.sum(1))


def _inside(wall: Tensor) -> Tensor:
    """Return the point that `inside.inside` finds, which follows `wall` (n,) as a step of Newton's does."""
    found = torch.tensor(
        inside(wall.detach().cpu().numpy().astype(np.complex128)), dtype=wall.dtype, device=wall.device
    )
    size = (wall.detach() - wall[0].detach()).abs().max()
    curve, p = (wall - wall[0]) / size, (found - wall[0].detach()) / size
    g, m, c = slope(p, curve, torch)
    m, c = m.detach(), c.detach()
    return wall[0] + size * (p + (c * g.conj() - m * g) / (m * m - c.abs() ** 2))


def _unrolled(walls: Tensor, centres: Tensor) -> tuple[Tensor, Any]:
    """Return the strips (batch, 65, 2) of `walls`, and which go round once, as `unrolled.unrolled`."""
    off = walls - centres[:, None, None]
    cut = torch.angle(off[:, :1, 1:] / off[:, :1, :-1])
    first = torch.cumsum(torch.cat([torch.angle(off[:, :1, :1]), cut], 2), 2)
    angle = torch.cumsum(torch.cat([first, torch.angle(off[:, 1:] / off[:, :-1])], 1), 1)
    strip = torch.complex(-angle, torch.log(off.abs()))
    gone = ((angle[:, -1] - angle[:, 0] + TURN).abs() < 1e-6).all(1)
    once = gone & torch.isfinite(torch.view_as_real(strip)).flatten(1).all(1)
    return torch.cat([strip[:, :-1], strip[:, :1] + TURN], 1), once.cpu().numpy()


def _evaluated(coarse: Tensor, south: Tensor, north: Tensor, nj: int) -> Tensor:
    """Return the nodes (batch, ni, nj), as `meshonet.solvers.algebraic.resample.o_grid.evaluate_around`; the rim is not theirs."""
    m, ni = coarse.shape[1], south.shape[1]
    lines, share = _along_lines(coarse, nj)
    shares = matrix(acute.linear, m, ni, share) @ share
    near_south, near_north = 1.0 - shares, shares
    for _ in range(SQUARINGS):
        near_south, near_north = near_south**2, near_north**2
    around = matrix(_spline_around, m, ni, share).to(coarse.dtype)
    nodes: Tensor = around @ lines
    walls = south[..., None] - nodes[..., :1], north[..., None] - nodes[..., -1:]
    return nodes + walls[0] * near_south + walls[1] * near_north


def _along_lines(z: Tensor, nj: int) -> tuple[Tensor, Tensor]:
    """Return nj nodes on each line of `z` (batch, m, n) and their shares of its length."""
    n = z.shape[-1]
    moves = z.diff(dim=-1)
    steps = moves.abs()
    length = torch.nn.functional.pad(torch.cumsum(steps, -1), (1, 0))
    first = places(n, nj)[0]
    t = torch.as_tensor(np.append((np.arange(nj) * ((n - 1) / (nj - 1)) - first)[:-1], 1.0)).to(steps)
    at = _hermite(length, _slopes(length, steps), first, t, 1.0)
    span = steps[..., first]
    new = _hermite(z, _tangents(moves / steps, steps), first, (at - length[..., first]) / span, span)
    return new, at / at[..., -1:]


def _hermite(values: Tensor, slopes: Tensor, first: Any, t: Tensor, span: Tensor | float) -> Tensor:
    rest = 1.0 - t
    ends = (1.0 + 2.0 * t) * rest**2 * values[..., first] + (3.0 - 2.0 * t) * t**2 * values[..., first + 1]
    return ends + span * t * rest * (rest * slopes[..., first] - t * slopes[..., first + 1])


def _slopes(length: Tensor, steps: Tensor) -> Tensor:
    n = length.shape[-1]
    bends = length @ torch.as_tensor(bending(n, False)).to(length).mT
    before, after = steps[..., :-1], steps[..., 1:]
    slopes = torch.cat(
        [
            steps - (2.0 * bends[..., :-1] + bends[..., 1:]) / 6.0,
            after[..., -1:] + (bends[..., -2:-1] + 2.0 * bends[..., -1:]) / 6.0,
        ],
        -1,
    )
    mean = torch.cat([steps[..., :1], 2.0 / (1.0 / before + 1.0 / after), steps[..., -1:]], -1)
    return torch.minimum(torch.maximum(slopes, FLAT * mean), STEEP * mean)


def _tangents(directions: Tensor, steps: Tensor) -> Tensor:
    before, after = steps[..., :-1], steps[..., 1:]
    inner = (directions[..., :-1] * after + directions[..., 1:] * before) / (before + after)
    start = 2.0 * directions[..., :1] - inner[..., :1]
    return torch.cat([start, inner, 2.0 * directions[..., -1:] - inner[..., -1:]], -1)


def _spline_around(m: int, n: int) -> Any:
    return spline_matrix(m, n, True)


def _complex(planes: Tensor) -> Tensor:
    return torch.complex(planes[:, 0], planes[:, 1])
