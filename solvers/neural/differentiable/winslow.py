"""Converged Winslow grids in torch, and their gradients, by Newton's method on successively finer grids."""

import torch
from torch import Tensor

from meshonet.solvers.elliptic.winslow import left_side
from meshonet.solvers.neural.differentiable.gmres import gmres
from meshonet.solvers.neural.differentiable.implicit import bordered, inner
from meshonet.solvers.neural.differentiable.members import MemberError, check_finite
from meshonet.solvers.neural.differentiable.resample import arc_lengths, between, interpolated

TOL = 1e-12  # preconditioned residual at which a grid is converged, relative to its extent
ROUGH = 1e-3  # the same on coarse copies
COARSEST = 9  # nodes along a direction from which on it is not made coarser
STARTS = 10  # steps of damped fixed-point iteration on the coarsest copy
DAMPING = 0.7  # their length
STEPS = 25  # of Newton's method at the most
HALVINGS = 6  # of a step that does not lower the residual; then a step of the fixed-point iteration is taken
FORCING = 1e-2  # residual of the linear systems, relative
ADJOINT = 1e-11  # the same of the system for gradients
MOST = 2**17  # coordinates solved at once on a CPU
PRODUCTS = 40, 400  # with the matrix at the most: for a step, for gradients


class Winslow:
    """Winslow's equations and their adjoint, as `implicit.Equations`."""

    def most(self, nodes: Tensor) -> int:
        """Return how many grids to solve at once; on a CPU, their Krylov spaces then fit into the cache."""
        return len(nodes) if nodes.is_cuda else MOST // nodes[0].numel()

    def solve(self, nodes: Tensor) -> tuple[Tensor, Tensor]:
        """Return the solutions (batch, 2, ni, nj), and zeros (batch,) that `adjoint` takes without using."""
        check_finite(nodes)
        return nested(nodes), nodes.new_zeros(len(nodes))

    def adjoint(self, nodes: Tensor, number: Tensor, gradient: Tensor) -> Tensor:  # noqa: ARG002 - one interface
        """Return the derivative of a functional with respect to boundary nodes, as `Equations.adjoint`."""
        line = _Linearised(nodes)

        def times(flat: Tensor) -> Tensor:
            return inner(line.transposed(flat.view_as(line.first))).flatten(1)

        solution = gmres(times, inner(gradient).flatten(1), ADJOINT, PRODUCTS[1])
        return gradient - line.transposed(solution.view_as(line.first))


def residual(nodes: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return the left side α x_ξξ - 2 β x_ξη + γ x_ηη of Winslow's equations at inner nodes, and α and γ."""
    return left_side(_derivatives(nodes), _dot)


def _derivatives(nodes: Tensor) -> tuple[Tensor, ...]:
    """Return x_ξ, x_η, x_ξξ, x_ξη and x_ηη at inner nodes, by central differences."""
    middle = nodes[:, :, 1:-1, 1:-1]
    west, east = nodes[:, :, :-2, 1:-1], nodes[:, :, 2:, 1:-1]
    south, north = nodes[:, :, 1:-1, :-2], nodes[:, :, 1:-1, 2:]
    mixed = nodes[:, :, 2:, 2:] - nodes[:, :, 2:, :-2] - nodes[:, :, :-2, 2:] + nodes[:, :, :-2, :-2]
    first = 0.5 * (east - west), 0.5 * (north - south)
    return (*first, east - 2.0 * middle + west, 0.25 * mixed, north - 2.0 * middle + south)


def _dot(a: Tensor, b: Tensor) -> Tensor:
    return (a * b).sum(1, keepdim=True)


def nested(nodes: Tensor) -> Tensor:
    """Solve Winslow's equations inside the boundary of `nodes` (batch, 2, ni, nj), on coarse grids first."""
    sides = nodes[..., 0], nodes[..., -1], nodes[:, :, 0], nodes[:, :, -1]
    laws = arc_lengths(sides)
    sizes = [(nodes.shape[2], nodes.shape[3])]
    while max(sizes[-1]) > COARSEST:
        sizes.append(tuple((n + 1) // 2 if n > COARSEST else n for n in sizes[-1]))  # type: ignore[arg-type]
    x = before = nodes
    for ni, nj in reversed(sizes):
        counts = ni, ni, nj, nj
        few = tuple(between(side, n) for side, n in zip(sides, counts, strict=True))
        start = interpolated(few, tuple(between(law, n) for law, n in zip(laws, counts, strict=True)))
        if (ni, nj) == sizes[-1]:
            x = start
            for _ in range(STARTS):
                left, alpha, gamma = residual(x)
                x = x - bordered(DAMPING * Separable(alpha, gamma).solve(left))
        else:
            change = torch.nn.functional.interpolate(x - before, (ni, nj), mode="bicubic", align_corners=True)
            x = start + bordered(inner(change))
        last = (ni, nj) == sizes[0]
        x, before = newton(x, TOL if last else ROUGH, strict=last), start
    return x


def newton(nodes: Tensor, tol: float, *, strict: bool = True) -> Tensor:
    """Solve Winslow's equations by Newton's method from the grids `nodes` (batch, 2, ni, nj).

    A grid has converged if its preconditioned residual is at most `tol` times its extent. If `strict`, raises
    MemberError with the grids that do not converge.
    """
    nodes = nodes.clone()
    extent = (nodes.amax((2, 3)) - nodes.amin((2, 3))).amax(1)
    moving = torch.arange(len(nodes), device=nodes.device)
    for _ in range(STEPS):
        line = _Linearised(nodes[moving])
        far = ~(line.first.abs().amax((1, 2, 3)) <= tol * extent[moving])  # true where it is not a number
        if not bool(far.any()):
            return nodes
        if not bool(far.all()):
            moving = moving[far]
            line = _Linearised(nodes[moving])
        nodes[moving] = line.stepped()
    if strict:
        problem, remedy = "Winslow's equations did not converge", "use the variational method"
        raise MemberError.of(moving.tolist(), problem, remedy)
    return nodes


class _Linearised:
    """Winslow's equations near `nodes` (batch, 2, ni, nj), preconditioned; `first` is their residual."""

    def __init__(self, nodes: Tensor) -> None:
        self._nodes, self._here = nodes, _derivatives(nodes)
        left, self._alpha, self._gamma = left_side(self._here, _dot)
        self._inverse = Separable(self._alpha, self._gamma)
        self.first = self._inverse.solve(left)

    def stepped(self) -> Tensor:
        """Return the nodes after a step of Newton's method, shortened if it does not lower the residual."""
        nodes, first = self._nodes, self.first
        step = gmres(self._times, first.flatten(1), FORCING, PRODUCTS[0]).view_as(first)
        size, now = torch.ones_like(first[:, :1, :1, :1]), first.flatten(1).norm(dim=1)
        for _ in range(HALVINGS):
            trial = nodes - bordered(size * step)
            after = self._inverse.solve(residual(trial)[0]).flatten(1).norm(dim=1)
            worse = ~(after < (1.0 - 0.1 * size.flatten()) * now)
            if not bool(worse.any()):
                return trial
            size = torch.where(worse[:, None, None, None], 0.5 * size, size)
        return torch.where(worse[:, None, None, None], nodes - bordered(0.5 * first), trial)

    def _times(self, flat: Tensor) -> Tensor:
        """Return the preconditioned derivative of the left side along moves (batch, n) of the inner nodes."""
        xi, eta, bend, twist, rise = self._here
        d_xi, d_eta, *second = _derivatives(bordered(flat.view_as(self.first)))
        change = self._alpha * second[0] - 2.0 * _dot(xi, eta) * second[1] + self._gamma * second[2]
        change = change + 2.0 * (_dot(eta, d_eta) * bend + _dot(xi, d_xi) * rise)
        change = change - 2.0 * (_dot(d_xi, eta) + _dot(xi, d_eta)) * twist
        return self._inverse.solve(change).flatten(1)

    def transposed(self, rows: Tensor) -> Tensor:
        """Return the transposed derivative of the residual by all nodes, times `rows` (batch, 2, mi, mj)."""
        xi, eta, bend, twist, rise = self._here
        rows = self._inverse.solve_transposed(rows)
        by_alpha, by_beta, by_gamma = 2.0 * _dot(rows, bend), -2.0 * _dot(rows, twist), 2.0 * _dot(rows, rise)
        by_xi, by_eta = 0.5 * (by_gamma * xi + by_beta * eta), 0.5 * (by_alpha * eta + by_beta * xi)
        by_bend, by_rise, by_twist = self._alpha * rows, self._gamma * rows, -0.5 * _dot(xi, eta) * rows
        product = bordered(-2.0 * (by_bend + by_rise))
        product[:, :, 2:, 1:-1] += by_bend + by_xi
        product[:, :, :-2, 1:-1] += by_bend - by_xi
        product[:, :, 1:-1, 2:] += by_rise + by_eta
        product[:, :, 1:-1, :-2] += by_rise - by_eta
        for into in (product[:, :, 2:, 2:], product[:, :, :-2, :-2]):
            into += by_twist
        for into in (product[:, :, 2:, :-2], product[:, :, :-2, 2:]):
            into -= by_twist
        return product


class Separable:
    """Fast solver for a separable approximation of the operator α u_ξξ + γ u_ηη.

    `alpha` and `gamma` (batch, 1, mi, mj) are α and γ. The ratio γ/α is approximated by a product p(ξ) q(η).
    Lynch, Rice and Thomas, Numer. Math. 6 (1964) 185-199.
    """

    def __init__(self, alpha: Tensor, gamma: Tensor) -> None:
        ratio = torch.log(gamma / alpha)
        mean = 0.5 * ratio.mean((2, 3), keepdim=True)
        p = torch.exp(ratio.mean(3, keepdim=True) - mean)
        q = torch.exp(ratio.mean(2, keepdim=True) - mean)
        self._scale = 1.0 / (alpha * p)
        self._xi, self._from_xi, along = _eigenvectors(1.0 / p[:, 0, :, 0])
        self._eta, self._from_eta, across = _eigenvectors(q[:, 0, 0])
        self._values = (along[:, :, None] + across[:, None, :])[:, None]

    def solve(self, right: Tensor) -> Tensor:
        """Return approximate solutions u (batch, 2, mi, mj) of α u_ξξ + γ u_ηη = `right`; see the class."""
        modes = (self._from_xi @ (right * self._scale) @ self._from_eta.mT) / self._values
        return self._xi @ modes @ self._eta.mT

    def solve_transposed(self, right: Tensor) -> Tensor:
        """Return the solutions (batch, 2, mi, mj) of the transposed system."""
        modes = (self._xi.mT @ right @ self._eta) / self._values
        return self._scale * (self._from_xi.mT @ modes @ self._from_eta)


def _eigenvectors(factor: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return eigenvectors, inverse (batch, 1, m, m), eigenvalues (batch, m) of diag(`factor`) times u_ξξ."""
    root = factor.sqrt()
    beside = root[:, 1:] * root[:, :-1]
    matrix = torch.diag_embed(-2.0 * factor) + torch.diag_embed(beside, 1) + torch.diag_embed(beside, -1)
    values, vectors = torch.linalg.eigh(matrix)
    return (root[:, :, None] * vectors)[:, None], (vectors / root[:, :, None]).mT[:, None], values
