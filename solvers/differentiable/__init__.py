"""Operators in torch: gradients from every node back to the nodes of the boundary, on any device."""

from meshonet.solvers.differentiable.airfoil import AirfoilGrids
from meshonet.solvers.differentiable.body import BodyGrids
from meshonet.solvers.differentiable.quad import QuadGrids

__all__ = ["AirfoilGrids", "BodyGrids", "QuadGrids"]
