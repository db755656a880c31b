"""Winslow's system in plain numpy, against which the compiled kernels are tested.

A grid is harmonic when its inverse map is: ∇²ξ = ∇²η = 0 in the plane. With the roles of the variables
exchanged, both coordinates x = (x, y) satisfy

    α x_ξξ - 2β x_ξη + γ x_ηη = 0,    α = x_η·x_η,  β = x_ξ·x_η,  γ = x_ξ·x_ξ.

Winslow, J. Comput. Phys. 1 (1966) 149-172.
"""

import numpy as np

from meshonet.geometry.arrays import Floats


def metric_terms(nodes: Floats) -> tuple[Floats, Floats, Floats]:
    """Return α, β, γ at the interior nodes of `nodes` (ni, nj, 2), unit steps: (ni-2, nj-2) each, in length².

    Examples
    --------
    >>> x, y = np.meshgrid(np.arange(3.0), 2 * np.arange(3.0), indexing="ij")
    >>> [float(term[0, 0]) for term in metric_terms(np.stack([x, y], axis=-1))]
    [4.0, 0.0, 1.0]
    """
    along_xi = (nodes[2:, 1:-1] - nodes[:-2, 1:-1]) / 2
    along_eta = (nodes[1:-1, 2:] - nodes[1:-1, :-2]) / 2
    alpha = (along_eta**2).sum(axis=-1)
    beta = (along_xi * along_eta).sum(axis=-1)
    gamma = (along_xi**2).sum(axis=-1)
    return alpha, beta, gamma


def residual(nodes: Floats) -> Floats:
    """Return the left side of Winslow's equations at the interior nodes, central differences, unit steps.

    `nodes` is (ni, nj, 2) in any unit L; the result is (ni-2, nj-2, 2) in L³. Second order. For an O grid
    pass `nodes` with column 1 appended, so that the seam is an interior column.
    """
    alpha, beta, gamma = (term[..., None] for term in metric_terms(nodes))
    middle = nodes[1:-1, 1:-1]
    x_xixi = nodes[2:, 1:-1] - 2 * middle + nodes[:-2, 1:-1]
    x_etaeta = nodes[1:-1, 2:] - 2 * middle + nodes[1:-1, :-2]
    x_xieta = (nodes[2:, 2:] - nodes[2:, :-2] - nodes[:-2, 2:] + nodes[:-2, :-2]) / 4
    return alpha * x_xixi - 2 * beta * x_xieta + gamma * x_etaeta


def root_mean_square(field: Floats) -> float:
    """Return the root of the mean over nodes of the squared length of `field` (..., 2)."""
    return float(np.sqrt((field**2).sum(axis=-1).mean()))
