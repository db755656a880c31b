"""The variational functional of `meshonet.solvers.energy.functional` and its Hessian in torch.

With g = |u|², h = |v|² and J = u × v of a corner's edges u, v, its term of angle and shape is F(g, h, J).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import torch
from torch import Tensor

# The cell's nodes, numbered (0, 0), (1, 0), (0, 1), (1, 1): u and v at its four corners and at its centre.
_U = ((-1, 1, 0, 0), (-1, 1, 0, 0), (0, 0, -1, 1), (0, 0, -1, 1), (-0.5, 0.5, -0.5, 0.5))
_V = ((-1, 0, 1, 0), (0, -1, 0, 1), (0, -1, 0, 1), (-1, 0, 1, 0), (-0.5, -0.5, 0.5, 0.5))
_SHARES = (1 / 12, 1 / 12, 1 / 12, 1 / 12, 2 / 3)  # of these places in the mean of a cell
_AT = ((0, 0), (1, 0), (0, 1), (1, 1))  # the nodes

Stencil = dict[tuple[int, int], Tensor]
"""Second derivatives (batch, 2, 2, ni, nj) by nodes (i, j) and (i + di, j + dj), by offset (di, dj).

Of two opposite offsets only one is stored: that with positive di, or, if di is 0, with positive dj.
"""


@dataclass(frozen=True)
class Functional:
    """The variational functional of `meshonet.solvers.energy.functional` in torch, for a batch of grids."""

    shape: float  # weight w of the angle term, 0 to 1
    smoothness: Tensor  # (batch,) weights β of the lengths' term

    def value(self, nodes: Tensor, aspect: Tensor) -> Tensor:
        """Return the functional (batch,) of grids `nodes` (batch, 2, ni, nj) without folded cells.

        `aspect` (batch,) is the result of `aspect_of`.
        """
        g, h, jacobian = _measures(*_corners(nodes))
        along, across = self._harmonic(aspect)
        ratio = g * h / (jacobian * jacobian)
        terms = (along * g + across * h) / jacobian + self.shape * ratio * ratio
        energy = (terms * _shares(nodes)).sum(1).mean((1, 2))
        for axis, family in enumerate(_edges(nodes)):
            for change, factor, _ in _changes(family, axis):
                energy = energy + self.smoothness * (factor * change * change).sum((1, 2))
        return energy

    def hessian(self, nodes: Tensor, aspect: Tensor, *, convex: bool = False) -> Stencil:
        """Return second derivatives of the functional by `nodes` (batch, 2, ni, nj); no cell may be folded.

        `aspect`, by `aspect_of`, counts as a constant. `convex` returns a positive definite approximation.
        """
        zero = nodes.new_zeros(len(nodes), 2, 2, *nodes.shape[2:])
        offsets = ((0, 0), (0, 1), (0, 2), (1, -1), (1, 0), (1, 1), (2, 0))
        stencil = {offset: zero.clone() for offset in offsets}
        cells = (nodes.shape[2] - 1) * (nodes.shape[3] - 1)
        by_nodes = self._by_nodes(nodes, aspect) / cells
        if convex:
            by_nodes = _positive_part(by_nodes)
        for k, first in enumerate(_AT):
            for m, second in enumerate(_AT):
                _add(stencil, by_nodes[:, 4 * k + m], first, second)
        for axis, family in enumerate(_edges(nodes)):
            self._add_lengths(stencil, family, axis, convex)
        return stencil

    def _harmonic(self, aspect: Tensor) -> tuple[Tensor, Tensor]:
        a = aspect[:, None, None, None]
        return 0.5 * (1.0 - self.shape) * a, 0.5 * (1.0 - self.shape) / a

    def _by_nodes(self, nodes: Tensor, aspect: Tensor) -> Tensor:
        """Return second derivatives (batch, 16, 2, 2, mi, mj) by each two of the cells' nodes."""
        u, v = _corners(nodes)
        g, h, jacobian = _measures(u, v)
        along, across = self._harmonic(aspect)
        one = 1.0 / jacobian
        two = one * one
        four = 2.0 * self.shape * two * two  # 2 w / J⁴
        harmonic, gh = (along * g + across * h) * two, g * h
        by_g, by_h = along * one + four * g * h * h, across * one + four * h * g * g
        by_j = -harmonic - 2.0 * four * gh * gh * one
        gg, hh, both = 4.0 * four * h * h, 4.0 * four * g * g, 8.0 * four * gh
        gj = -2.0 * along * two - 8.0 * four * gh * h * one
        hj = -2.0 * across * two - 8.0 * four * gh * g * one
        jj = 2.0 * harmonic * one + 10.0 * four * gh * gh * two
        ju, jv = torch.stack([v[:, :, 1], -v[:, :, 0]], 2), torch.stack([-u[:, :, 1], u[:, :, 0]], 2)
        gg, hh, both, gj, hj, jj = (part[:, :, None] for part in (gg, hh, both, gj, hj, jj))
        p, q = gj * u + jj * ju, hj * v + jj * jv
        uu = _outer(gg * u + gj * ju, u) + _outer(p, ju)
        vv = _outer(hh * v + hj * jv, v) + _outer(q, jv)
        uv = _outer(both * u + hj * ju, v) + _outer(p, jv)
        for k in (0, 1):
            uu[:, :, k, k] += 2.0 * by_g
            vv[:, :, k, k] += 2.0 * by_h
        uv[:, :, 0, 1] += by_j
        uv[:, :, 1, 0] -= by_j
        blocks = torch.cat([uu, uv, uv.transpose(2, 3), vv], 1)
        return torch.einsum("km,bmpqij->bkpqij", _assembly(nodes), blocks)

    def _add_lengths(self, stencil: Stencil, family: Tensor, axis: int, convex: bool) -> None:
        """Add the terms of one `family` of edges (batch, 2, rows, columns), along `axis`."""
        one = 1.0 / (family * family).sum(1, keepdim=True)
        slope = family * one  # of the logarithm of a length
        weight, force = torch.zeros_like(one[:, 0]), torch.zeros_like(one[:, 0])
        end = (1, 0) if axis == 0 else (0, 1)
        starts = ((0, 0), -1), (end, 1)  # nodes of an edge, and their signs in it
        for change, factor, way in _changes(family, axis):
            factor = 2.0 * self.smoothness[:, None, None] * factor
            pull = 0.0 * change if convex else factor * change
            count = family.shape[way + 2] - 1
            for first, sign in ((0, -1.0), (1, 1.0)):
                weight.narrow(way + 1, first, count).add_(factor)
                force.narrow(way + 1, first, count).add_(sign * pull)
            before, after = slope.narrow(way + 2, 0, count), slope.narrow(way + 2, 1, count)
            mixed = -factor[:, None, None] * _outer(before, after, 1)
            step = (1, 0) if way == 0 else (0, 1)
            for a, sign in starts:
                for b, other in starts:
                    to = b[0] + step[0], b[1] + step[1]
                    _add(stencil, sign * other * mixed, a, to)
                    _add(stencil, sign * other * mixed.transpose(1, 2), to, a)
        own = (weight - 2.0 * force)[:, None, None] * _outer(slope, slope, 1)
        for k in (0, 1):
            own[:, k, k] += force * one[:, 0]
        for a, sign in starts:
            for b, other in starts:
                _add(stencil, sign * other * own, a, b)


def _positive_part(blocks: Tensor) -> Tensor:
    """Return the positive semidefinite part of symmetric matrices (batch, 16, 2, 2, mi, mj) of cells."""
    cells = blocks.unflatten(1, (4, 4)).permute(0, 5, 6, 1, 3, 2, 4)  # row: node and component; column: same
    values, vectors = torch.linalg.eigh(cells.flatten(3, 4).flatten(4, 5))
    part = (vectors * values.clamp_min(0.0)[..., None, :]) @ vectors.mT
    return part.unflatten(4, (4, 2)).unflatten(3, (4, 2)).permute(0, 3, 5, 4, 6, 1, 2).flatten(1, 2)


def aspect_of(nodes: Tensor) -> Tensor:
    """Return for each grid the mean spacing of boundary nodes along eta, over the mean spacing along xi."""
    walls, sides = nodes[..., :: nodes.shape[3] - 1], nodes[:, :, :: nodes.shape[2] - 1]
    along, across = walls.diff(dim=2).square().mean((1, 2, 3)), sides.diff(dim=3).square().mean((1, 2, 3))
    return torch.sqrt(across / along)


def smallest_jacobian(nodes: Tensor) -> Tensor:
    """Return the smallest corner Jacobian (batch,) of cells in each grid of `nodes` (batch, 2, ni, nj)."""
    return _measures(*(part[:, :4] for part in _corners(nodes)))[2].amin((1, 2, 3))


def _edges(nodes: Tensor) -> tuple[Tensor, Tensor]:
    return nodes.diff(dim=2), nodes.diff(dim=3)


def _corners(nodes: Tensor) -> tuple[Tensor, Tensor]:
    """Return u and v (batch, 5, 2, mi, mj) at the corners of cells and at their centres."""
    along, across = _edges(nodes)
    s, n, w, e = along[..., :-1], along[..., 1:], across[:, :, :-1], across[:, :, 1:]
    return torch.stack([s, s, n, n, 0.5 * (s + n)], 1), torch.stack([w, e, e, w, 0.5 * (w + e)], 1)


def _measures(u: Tensor, v: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    return (u * u).sum(2), (v * v).sum(2), u[:, :, 0] * v[:, :, 1] - u[:, :, 1] * v[:, :, 0]


def _shares(like: Tensor) -> Tensor:
    return torch.tensor(_SHARES, dtype=like.dtype, device=like.device)[:, None, None]


def _assembly(like: Tensor) -> Tensor:
    """Return the matrix (16, 20) from blocks uu, uv, vu and vv of the five places to those of two nodes."""
    u, v = (torch.tensor(rows, dtype=like.dtype, device=like.device) for rows in (_U, _V))
    share = _shares(like)[:, :, 0]
    pairs = [share * torch.einsum("mk,ml->mkl", a, b).flatten(1) for a in (u, v) for b in (u, v)]
    return torch.cat(pairs).T


def _changes(family: Tensor, axis: int) -> Iterator[tuple[Tensor, Tensor, int]]:
    """Yield differences of log lengths along `axis` to next edges, their factors, and 0 (xi) or 1 (eta)."""
    length = 0.5 * torch.log((family * family).sum(1))
    counts = [n if k == axis else n - 1 for k, n in enumerate(length.shape[1:])]
    for way, count in enumerate(counts):
        change = length.diff(dim=way + 1)
        factor = torch.full_like(change[0], count / counts[1 - way])
        if way == axis:
            for rim in (0, -1):
                factor.select(1 - way, rim).mul_(0.5)
        yield change, factor, way


def _outer(a: Tensor, b: Tensor, axis: int = 2) -> Tensor:
    return a.unsqueeze(axis + 1) * b.unsqueeze(axis)


def _add(stencil: Stencil, blocks: Tensor, first: tuple[int, int], second: tuple[int, int]) -> None:
    """Add `blocks` (batch, 2, 2, mi, mj) by nodes at places `first` and `second` relative to (i, j)."""
    offset = second[0] - first[0], second[1] - first[1]
    if offset in stencil:
        mi, mj = blocks.shape[3:]
        stencil[offset][..., first[0] : first[0] + mi, first[1] : first[1] + mj] += blocks
