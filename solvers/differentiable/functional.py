"""The variational functional of `meshonet.solvers.energy.functional` in torch, for batches of grids.

It is a sum over cells (four nodes each) and over pairs of consecutive edges (three nodes each), so that its
Hessian is a sum of small ones.
"""

from collections.abc import Callable

import torch
from torch import Tensor

from meshonet.solvers.energy.functional import Weights


def energy(nodes: Tensor, weights: Weights) -> Tensor:
    """Return E (batch,) of `nodes` (batch, 2, ni, nj), a number without unit; infinite where folded.
    """
    cell, along, across = _parts(nodes.movedim(1, 0))
    value = _cell(cell, aspect(nodes)[:, None, None], weights, nodes.shape[2:]).sum((1, 2))
    for three, count, rim in ((along, nodes.shape[2], 2), (across, nodes.shape[3], 1)):
        terms = _bend(three, count, weights) * _half_at_rim(three.shape[-2:], rim, nodes)
        value = value + terms.sum((1, 2))
    return value / ((nodes.shape[2] - 1) * (nodes.shape[3] - 1))


def slopes(nodes: Tensor, weights: Weights) -> tuple[Tensor, Tensor]:
    """Return gradient (batch, n) and Hessian (batch, n, n) of `energy` with respect to inner nodes.

    Inner nodes are in the order of `nodes[:, :, 1:-1, 1:-1].flatten(1)`; the aspect ratio in the functional
    depends on boundary nodes alone.
    """
    batch, (ni, nj) = len(nodes), nodes.shape[2:]
    size = 2 * ni * nj
    numbers = torch.arange(size, device=nodes.device).view(2, 1, ni, nj)
    slope, matrix = nodes.new_zeros(batch, size), nodes.new_zeros(batch, size * size)

    def add(function: Callable[..., Tensor], points: Tensor, places: Tensor, *more: Tensor) -> None:
        k = 2 * len(points)
        spots = places.flatten(2).permute(2, 0, 1).reshape(-1, k)
        first, second = _local_slopes(function, points, *more)
        slope.index_add_(1, spots.flatten(), first.reshape(batch, -1))
        matrix.index_add_(1, (spots[:, :, None] * size + spots[:, None, :]).flatten(), second.reshape(batch, -1))

    parts = zip(_parts(nodes.movedim(1, 0)), _parts(numbers), strict=True)
    (cell, cell_places), *lines = [(points, places.squeeze(2)) for points, places in parts]
    add(lambda p, a: _cell(p, a, weights, (ni, nj)), cell, cell_places, aspect(nodes)[:, None, None])
    for (points, places), count, rim in zip(lines, (ni, nj), (2, 1), strict=True):
        share = _half_at_rim(points.shape[-2:], rim, nodes)
        add(lambda p, w, count=count: w * _bend(p, count, weights), points, places, share)
    inner = numbers[:, 0, 1:-1, 1:-1].flatten()
    cells = (ni - 1) * (nj - 1)
    square = matrix.view(batch, size, size)[:, inner[:, None], inner]
    return slope[:, inner] / cells, square / cells


def _local_slopes(function: Callable[..., Tensor], points: Tensor, *more: Tensor) -> tuple[Tensor, Tensor]:
    """Return gradients (n, 2k) and Hessians (n, 2k, 2k) of n values of `function` of k `points` (k, 2, ...)."""
    with torch.enable_grad():
        x = points.detach().requires_grad_()
        first = torch.autograd.grad(function(x, *more).sum(), x, create_graph=True)[0].flatten(0, 1)
        rows = [torch.autograd.grad(part.sum(), x, retain_graph=True)[0].flatten(0, 1) for part in first]
    gradient, hessian = first.detach().flatten(1), torch.stack(rows).flatten(2)
    return gradient.mT, hessian.movedim(2, 0)


def aspect(nodes: Tensor) -> Tensor:
    """Return the ratio (batch,) of root mean square steps: of west and east over those of south and north."""
    along, across = (
        nodes[..., :: nodes.shape[3] - 1].diff(dim=2),
        nodes[:, :, :: nodes.shape[2] - 1].diff(dim=3),
    )
    return torch.sqrt((across**2).mean((1, 2, 3)) / (along**2).mean((1, 2, 3)))


def _parts(z: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return corners of cells (4, 2, ...) and three consecutive nodes (3, 2, ...) along xi, and along eta.

    `z`: (2, batch, ni, nj).
    """
    corners = z[..., :-1, :-1], z[..., 1:, :-1], z[..., :-1, 1:], z[..., 1:, 1:]
    along, across = (z[..., :-2, :], z[..., 1:-1, :], z[..., 2:, :]), (z[..., :-2], z[..., 1:-1], z[..., 2:])
    return torch.stack(corners), torch.stack(along), torch.stack(across)


def _half_at_rim(shape: torch.Size, axis: int, like: Tensor) -> Tensor:
    """Return weights (mi, mj) of pairs of edges: one half along the rim, at both ends of `axis` 1 or 2."""
    share = like.new_ones(shape)
    share[[0, -1]] *= 0.5 if axis == 1 else 1.0
    share[:, [0, -1]] *= 0.5 if axis == 2 else 1.0
    return share


def _cell(p: Tensor, a: Tensor, weights: Weights, counts: tuple[int, ...]) -> Tensor:
    """Return the terms (...) of cells with corners `p` (4, 2, ...): shape, and edges beside each other."""
    ni, nj = counts
    south, north, west, east = p[1] - p[0], p[3] - p[2], p[2] - p[0], p[3] - p[1]
    ends = [_density(u, v, a, weights) for u in (south, north) for v in (west, east)]
    centre = _density(0.5 * (south + north), 0.5 * (west + east), a, weights)
    shape = (0.25 * (ends[0] + ends[1] + ends[2] + ends[3]) + 2.0 * centre) / 3.0
    beside = ((nj - 1) * (_log(north) - _log(south))) ** 2 + ((ni - 1) * (_log(east) - _log(west))) ** 2
    return shape + weights.smoothness * beside


def _bend(p: Tensor, count: int, weights: Weights) -> Tensor:
    """Return the terms (...) of consecutive edges of nodes `p` (3, 2, ...), `count` nodes along a line."""
    return weights.smoothness * ((count - 1) * (_log(p[2] - p[1]) - _log(p[1] - p[0]))) ** 2


def _density(u: Tensor, v: Tensor, a: Tensor, weights: Weights) -> Tensor:
    """Return the harmonic and the angle term (...) where edges `u` and `v` (2, ...) meet."""
    jacobian, g, h = _cross(u, v), (u**2).sum(0), (v**2).sum(0)
    harmonic, angle = (a * g + h / a) / (2.0 * jacobian), (g * h / jacobian**2) ** 2
    terms = (1.0 - weights.shape) * harmonic + weights.shape * angle
    return torch.where(jacobian > 0, terms, torch.full_like(terms, torch.inf))


def _cross(u: Tensor, v: Tensor) -> Tensor:
    return u[0] * v[1] - u[1] * v[0]


def _log(edge: Tensor) -> Tensor:
    return 0.5 * torch.log((edge**2).sum(0))


def smallest_jacobian(nodes: Tensor) -> Tensor:
    """Return the smallest Jacobian (batch,) at a corner of a cell of `nodes` (batch, 2, ni, nj), an area."""
    z = nodes.movedim(1, 0)
    u, v = z.diff(dim=2), z.diff(dim=3)
    corners = [_cross(p, q) for p in (u[..., :-1], u[..., 1:]) for q in (v[..., :-1, :], v[..., 1:, :])]
    return torch.stack(corners).amin((0, 2, 3))
