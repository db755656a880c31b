"""Operators in torch: gradients from every node back to the nodes of the boundary, on any device."""

from meshonet.solvers.neural.differentiable.airfoil import AirfoilGrids
from meshonet.solvers.neural.differentiable.network_grids import BodyGrids, QuadGrids

__all__ = ["AirfoilGrids", "BodyGrids", "QuadGrids"]
