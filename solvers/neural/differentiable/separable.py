"""A direct solver for operators near Winslow's, by which its linear systems are preconditioned."""

import torch
from torch import Tensor


class Separable:
    """The inverse of a separable operator near α u_ξξ + γ u_ηη; `alpha`, `gamma`: (batch, 1, mi, mj).

    γ/α is approximated by a product p(ξ) q(η); eigenvectors in both directions diagonalise u_ξξ / p + q u_ηη.
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
        """Return the solutions (batch, 2, mi, mj) for `right` of the same shape."""
        modes = (self._from_xi @ (right * self._scale) @ self._from_eta.mT) / self._values
        return self._xi @ modes @ self._eta.mT

    def solve_transposed(self, right: Tensor) -> Tensor:
        """Return the solutions (batch, 2, mi, mj) of the transposed system."""
        modes = (self._xi.mT @ right @ self._eta) / self._values
        return self._scale * (self._from_xi.mT @ modes @ self._from_eta)


def _eigenvectors(factor: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return eigenvectors, their inverse (batch, 1, m, m) and eigenvalues (batch, m) of diag(`factor`) D².

    D² is the second difference with zero values beyond both ends; `factor` (batch, m) is positive.
    """
    root = factor.sqrt()
    beside = root[:, 1:] * root[:, :-1]
    matrix = torch.diag_embed(-2.0 * factor) + torch.diag_embed(beside, 1) + torch.diag_embed(beside, -1)
    values, vectors = torch.linalg.eigh(matrix)
    return (root[:, :, None] * vectors)[:, None], (vectors / root[:, :, None]).mT[:, None], values
