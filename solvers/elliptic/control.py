"""Control functions φ and ψ of Winslow's equations, which set the growth of steps along ξ and η."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import log, product

STEEPEST = 2.0  # limit of the logarithm of step ratios on a boundary: a ratio of 7.4


@dataclass(frozen=True, eq=False)
class Factors:
    """A function of the nodes (i, j) that is a sum of products: Σ_t along[t, i] across[t, j]."""

    along: Floats  # (terms, ni)
    across: Floats  # (terms, nj)

    @classmethod
    def none(cls, ni: int, nj: int) -> Factors:
        """Return the function of the nodes that is zero at all ni x nj nodes."""
        return cls(np.zeros((0, ni)), np.zeros((0, nj)))

    def values(self) -> Floats:
        """Return the function's values (ni, nj): Σ_t along[t, i] across[t, j] at node (i, j)."""
        return np.asarray(product(self.along.T, self.across))

    def kept(self, i: Indices, j: Indices) -> Factors:
        """Return this function of the nodes for the first node indices `i` and the second ones `j` only."""
        return Factors(np.ascontiguousarray(self.along[:, i]), np.ascontiguousarray(self.across[:, j]))

    def scaled(self, part: float) -> Factors:
        """Return this function of the nodes, multiplied by `part`."""
        return replace(self, along=part * self.along)

    def __add__(self, other: Factors) -> Factors:
        along, across = (self.along, other.along), (self.across, other.across)
        return Factors(np.concatenate(along), np.concatenate(across))


@dataclass(frozen=True, eq=False)
class Controls:
    """Control functions φ and ψ of Winslow's equations, as logarithms of ratios of neighbouring edge lengths.

    The equations are α (x_ξξ + φ x_ξ) - 2β x_ξη + γ (x_ηη + ψ x_η) = 0, with the metric coefficients α, β, γ.
    Let l be the logarithm along ξ on the finest multigrid level, where steps in ξ are 1. On a level with
    steps h, φ = -(2/h) tanh(h l/2). The same holds for ψ and η.
    """

    phi: Factors  # logarithm of the ratio of neighbouring edge lengths along ξ and along η
    psi: Factors

    def scaled(self, part: float) -> Controls:
        """Return both control functions multiplied by `part`."""
        return Controls(self.phi.scaled(part), self.psi.scaled(part))

    def __add__(self, other: Controls) -> Controls:
        return Controls(self.phi + other.phi, self.psi + other.psi)


def thomas_middlecoff(boundary: Boundary) -> Controls:
    """Return the control functions that propagate the spacing of the edges into the domain.

    On an edge with arc length s, φ = -(x_ξ·x_ξξ)/(x_ξ·x_ξ) = -(ln s_ξ)_ξ. This assumes that grid lines leave
    the edge straight and orthogonally. Inside, φ and ψ are interpolated linearly between opposite edges. For
    an O boundary, ψ is computed on the cut. Thomas and Middlecoff, AIAA J. 18 (1980) 652-656.
    """
    periodic = boundary.periodic
    up = np.linspace(0.0, 1.0, boundary.nj)
    right = np.linspace(0.0, 1.0, boundary.ni)
    south, north = (step_ratios(edge, periodic=periodic) for edge in (boundary.south, boundary.north))
    west, east = (step_ratios(edge, periodic=False) for edge in (boundary.west, boundary.east))
    return Controls(
        Factors(np.stack([south, north]), np.stack([1.0 - up, up])),
        Factors(np.stack([1.0 - right, right]), np.stack([west, east])),
    )


def step_ratios(edge: Floats, *, periodic: bool) -> Floats:
    """Return log(step after / step before) (n,) at each node of an edge (n, 2), limited to ±`STEEPEST`.

    The ends of an open edge get the values of their neighbours.

    >>> edge = np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [7.0, 0.0]])
    >>> np.exp(step_ratios(edge, periodic=False)).tolist()
    [2.0, 2.0, 2.0, 2.0]
    """
    steps = log(np.hypot(*np.diff(edge, axis=0).T))
    ratios = np.zeros(len(edge))
    if len(edge) > 2:
        ratios[1:-1] = np.diff(steps)
        ratios[0], ratios[-1] = (2 * [steps[0] - steps[-1]]) if periodic else (ratios[1], ratios[-2])
    return np.clip(ratios, -STEEPEST, STEEPEST)
